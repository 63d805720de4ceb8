"""A small network as operations and constants, so that NumPy alone can run it on the testbed."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from teamformer.sim.arrays import Array

OUTLINE = "outline"
"""The array of a file that holds operations, inputs and outputs as JSON; others are constants."""


@dataclass(frozen=True)
class Node:
    """An operation: what it is called, what it reads and writes, by name, and its settings."""

    operation: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    settings: dict[str, Any]


@dataclass(frozen=True)
class Graph:
    """A network: operations in the order to run them, and its constants."""

    nodes: tuple[Node, ...]
    constants: dict[str, Array]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]


def read_graph(content: bytes) -> Graph:
    """Return the network of a file that `teamformer.train.export.numpy_graph` has written."""
    with np.load(io.BytesIO(content), allow_pickle=False) as arrays:
        constants = {name: arrays[name] for name in arrays.files}
    outline = json.loads(str(constants.pop(OUTLINE)))
    nodes = (
        Node(operation, tuple(inputs), tuple(outputs), settings)
        for operation, inputs, outputs, settings in outline["nodes"]
    )
    return Graph(tuple(nodes), constants, tuple(outline["inputs"]), tuple(outline["outputs"]))
