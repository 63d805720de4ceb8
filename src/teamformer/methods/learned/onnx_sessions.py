"""Networks in ONNX files, run by onnxruntime: no torch, one thread."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError


class OnnxNetwork:
    """A network that is run with its inputs by position and returns its outputs.

    Raises `TeamformerError` if the file holds no network, or one with other inputs than `inputs`.
    """

    def __init__(self, content: bytes, name: str, inputs: tuple[str, ...]) -> None:
        self._content, self._name = content, name
        self._session = _start(content, name)
        self._inputs = inputs
        found = tuple(given.name for given in self._session.get_inputs())
        if found != inputs:
            hint = "it is another network or of another version; train or export it again"
            raise TeamformerError(f"{name} takes {found}, not {inputs}", hint)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the file: a session of onnxruntime cannot be."""
        return type(self), (self._content, self._name, self._inputs)

    @property
    def about(self) -> dict[str, str]:
        """Return what was written into the file besides the network."""
        found: dict[str, str] = self._session.get_modelmeta().custom_metadata_map
        return found

    def width(self, name: str) -> int:
        """Return the last axis of an input: how many features a token has."""
        width: int = next(i.shape[-1] for i in self._session.get_inputs() if i.name == name)
        return width

    def __call__(self, *values: Array) -> list[Array]:
        """Return the network's outputs."""
        fed = dict(zip(self._inputs, values, strict=True))
        outputs: list[Array] = self._session.run(None, fed)
        return outputs


AT_ONCE = 2048
"""Teams in one pass, so that memory stays bounded however many worlds are played side by side."""


class GreedyChoice:
    """Takes the action that a network with one output, (teams, actions), scores highest."""

    def __init__(self, network: OnnxNetwork) -> None:
        self.network = network

    def __call__(self, tokens: tuple[Array, ...]) -> Array:
        """Return actions (teams,) from tokens (teams, ...)."""
        parts = range(0, len(tokens[0]), AT_ONCE)
        return np.concatenate([self._best([t[i : i + AT_ONCE] for t in tokens]) for i in parts])

    def _best(self, tokens: list[Array]) -> Array:
        [scores] = self.network(*tokens)
        best: Array = scores.argmax(axis=1)
        return best


def shipped(name: str) -> bytes:
    """Return a file of `weights/`, as it comes with the package."""
    return files("teamformer").joinpath("weights", name).read_bytes()


def read_network(file: Path) -> bytes:
    """Return a network file's content; raises `TeamformerError` if it cannot be read."""
    try:
        return file.read_bytes()
    except OSError as error:
        raise TeamformerError(f"{file} cannot be read: {error.strerror}") from None


def _start(content: bytes, name: str) -> Any:
    import onnxruntime  # type: ignore[import-untyped]  # heavy, and only needed here

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.log_severity_level = 3
    try:
        return onnxruntime.InferenceSession(content, options, ["CPUExecutionProvider"])
    except Exception as error:  # onnxruntime's errors have no public common class
        raise TeamformerError(f"{name} holds no network that runs: {error}") from None
