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

    @property
    def about(self) -> dict[str, str]:
        """Return what the network's file says besides."""
        return self._graph.about

    def width(self, name: str) -> int:
        """Return the last axis of an input: how many features a token has."""
        return self._graph.widths[name]

    def __call__(self, *values: Array) -> list[Array]:
        """Return the network's outputs."""
        known = {**self._graph.constants, **dict(zip(self._graph.inputs, values, strict=True))}
        for node in self._graph.nodes:
            given = [known[name] if name else None for name in node.inputs]
            made = OPERATIONS[node.operation](*given, **node.settings)
            outputs = made if isinstance(made, list) else [made]
            known.update(zip(node.outputs, outputs, strict=True))
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


def _min(x: Array, axes: Any = None, keepdims: int = 1, **_: Any) -> Array:
    return np.asarray(x.min(axis=_axes(axes), keepdims=bool(keepdims)))


def _split(x: Array, sizes: Any = None, axis: int = 0, num_outputs: int = 1) -> list[Array]:
    """Return parts of given sizes, or of equal ones of which the last may be smaller."""
    if sizes is None:
        size = -(-x.shape[axis] // num_outputs)
        return np.split(x, [size * part for part in range(1, num_outputs)], axis=axis)
    return np.split(x, np.cumsum(sizes)[:-1], axis=axis)


def _slice(x: Array, begins: Array, ends: Array, axes: Any = None, steps: Any = None) -> Array:
    places = range(len(begins)) if axes is None else axes.tolist()
    strides = [1] * len(begins) if steps is None else steps.tolist()
    parts = [slice(None)] * x.ndim
    for axis, begin, end, step in zip(places, begins.tolist(), ends.tolist(), strides, strict=True):
        parts[axis] = slice(begin, end, step)  # ONNX cuts what is beyond the end, too
    return x[tuple(parts)]


def _range(begin: Array, end: Array, step: Array) -> Array:
    return np.arange(begin.item(), end.item(), step.item()).astype(begin.dtype)


def _where(condition: Array, yes: Array, no: Array) -> Array:
    return np.asarray(np.where(condition, yes, no))


OPERATIONS: dict[str, Callable[..., Array | list[Array]]] = {
    "Add": lambda a, b: a + b,
    "And": lambda a, b: a & b,
    "Cast": lambda x, to, **_: x.astype(DTYPES[to]),
    "Clip": _clip,
    "Concat": lambda *parts, axis: np.concatenate(parts, axis=axis),
    "Constant": lambda value: value,
    "Div": lambda a, b: a / b if a.dtype.kind == "f" else a // b,
    "Einsum": lambda *parts, equation: np.einsum(equation, *parts),
    "Equal": lambda a, b: a == b,
    "Expand": lambda x, shape: x * np.ones(shape.astype(int), dtype=x.dtype),
    "Gather": lambda x, index, axis=0: np.take(x, index, axis=axis),
    "Gemm": _gemm,
    "Greater": lambda a, b: a > b,
    "Identity": lambda x: x,
    "LayerNormalization": _normalise,
    "LeakyRelu": lambda x, alpha=0.01: np.where(x < 0, np.float32(alpha) * x, x),
    "Less": lambda a, b: a < b,
    "LessOrEqual": lambda a, b: a <= b,
    "MatMul": lambda a, b: a @ b,
    "Mul": lambda a, b: a * b,
    "Neg": lambda x: -x,
    "Not": lambda x: ~x,
    "Or": lambda a, b: a | b,
    "Range": _range,
    "ReduceMax": _max,
    "ReduceMean": _mean,
    "ReduceMin": _min,
    "ReduceSum": _sum,
    "Relu": lambda x: np.maximum(x, 0),
    "Reshape": _reshape,
    "Shape": lambda x, start=0, end=None: np.array(x.shape[start:end], np.int64),
    "Sigmoid": lambda x: 1 / (1 + np.exp(-x)),
    "Slice": _slice,
    "Softmax": _softmax,
    "Split": _split,
    "Sqrt": np.sqrt,
    "Squeeze": _squeeze,
    "Sub": lambda a, b: a - b,
    "Tanh": np.tanh,
    "Transpose": lambda x, perm: np.transpose(x, perm),
    "Unsqueeze": _unsqueeze,
    "Where": _where,
}
