"""Runs small networks with NumPy alone, operation by operation, for the testbed.

Operations mean what the ONNX specification says (onnx.ai/onnx/operators, opset 20).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.robotarium.deployment.graphs import NetworkGraph

DTYPES = {1: np.float32, 6: np.int32, 7: np.int64, 9: np.bool_, 11: np.float64}


class NumpyNetwork:
    """A network that is run with its inputs by position and returns its outputs.

    Raises `TeamformerError` for a network with an operation that is not known here.
    """

    def __init__(self, graph: NetworkGraph) -> None:
        unknown = {node.operation for node in graph.nodes} - set(OPERATIONS)
        if unknown:
            names = ", ".join(sorted(unknown))
            raise TeamformerError(f"this network has operations not known on the testbed: {names}")
        self._graph = graph

    def __call__(self, *values: Array) -> list[Array]:
        """Return the network's outputs."""
        known = {**self._graph.constants, **dict(zip(self._graph.inputs, values, strict=True))}
        for node in self._graph.nodes:
            given = [known[name] if name else None for name in node.inputs]
            known[node.outputs[0]] = OPERATIONS[node.operation](*given, **node.settings)
        return [known[name] for name in self._graph.outputs]


def _gemm(a: Array, b: Array, c: Any = None, **s: Any) -> Array:
    left = a.T if s.get("transA") else a
    right = b.T if s.get("transB") else b
    product: Array = s.get("alpha", 1.0) * (left @ right)
    return product if c is None else product + s.get("beta", 1.0) * c


def _sum(x: Array, axes: Any = None, keepdims: int = 1, **_: Any) -> Array:
    return np.asarray(x.sum(axis=_axes(axes), keepdims=bool(keepdims)))


def _max(x: Array, axes: Any = None, keepdims: int = 1, **_: Any) -> Array:
    return np.asarray(x.max(axis=_axes(axes), keepdims=bool(keepdims)))


def _mean(x: Array, axes: Any = None, keepdims: int = 1, **_: Any) -> Array:
    return np.asarray(x.mean(axis=_axes(axes), keepdims=bool(keepdims)))


def _axes(axes: Any) -> tuple[int, ...] | None:
    return None if axes is None else tuple(int(axis) for axis in axes)


def _squeeze(x: Array, axes: Any = None) -> Array:
    return np.squeeze(x, axis=_axes(axes))


def _unsqueeze(x: Array, axes: Any) -> Array:
    return np.expand_dims(x, axis=_axes(axes) or ())


def _clip(x: Array, low: Any = None, high: Any = None) -> Array:
    return np.asarray(np.clip(x, low, high))


def _reshape(x: Array, shape: Any, **_: Any) -> Array:
    sizes = [x.shape[i] if n == 0 else int(n) for i, n in enumerate(shape)]
    return x.reshape(sizes)


def _softmax(x: Array, axis: int = -1) -> Array:
    raised = np.exp(x - x.max(axis=axis, keepdims=True))
    return np.asarray(raised / raised.sum(axis=axis, keepdims=True))


def _normalise(x: Array, scale: Array, bias: Any = None, **s: Any) -> Array:
    axes = tuple(range(s.get("axis", -1) % x.ndim, x.ndim))
    centred = x - x.mean(axis=axes, keepdims=True)
    spread = np.sqrt((centred**2).mean(axis=axes, keepdims=True) + s.get("epsilon", 1e-5))
    return np.asarray(centred / spread * scale + (0 if bias is None else bias))


def _where(condition: Array, yes: Array, no: Array) -> Array:
    return np.asarray(np.where(condition, yes, no))


OPERATIONS: dict[str, Callable[..., Array]] = {
    "Add": lambda a, b: a + b,
    "And": lambda a, b: a & b,
    "Cast": lambda x, to, **_: x.astype(DTYPES[to]),
    "Clip": _clip,
    "Concat": lambda *parts, axis: np.concatenate(parts, axis=axis),
    "Constant": lambda value: value,
    "Div": lambda a, b: a / b if a.dtype.kind == "f" else a // b,
    "Equal": lambda a, b: a == b,
    "Expand": lambda x, shape: x * np.ones(shape.astype(int), dtype=x.dtype),
    "Gather": lambda x, index, axis=0: np.take(x, index, axis=axis),
    "Gemm": _gemm,
    "Greater": lambda a, b: a > b,
    "Identity": lambda x: x,
    "LayerNormalization": _normalise,
    "MatMul": lambda a, b: a @ b,
    "Mul": lambda a, b: a * b,
    "Neg": lambda x: -x,
    "Not": lambda x: ~x,
    "Or": lambda a, b: a | b,
    "ReduceMax": _max,
    "ReduceMean": _mean,
    "ReduceSum": _sum,
    "Relu": lambda x: np.maximum(x, 0),
    "Reshape": _reshape,
    "Sigmoid": lambda x: 1 / (1 + np.exp(-x)),
    "Softmax": _softmax,
    "Sqrt": np.sqrt,
    "Squeeze": _squeeze,
    "Sub": lambda a, b: a - b,
    "Tanh": np.tanh,
    "Transpose": lambda x, perm: np.transpose(x, perm),
    "Unsqueeze": _unsqueeze,
    "Where": _where,
}
