"""A small network as operations and constants, so that NumPy alone can run it on the testbed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from teamformer.base.array_types import Array


@dataclass(frozen=True)
class Node:
    """An operation: what it is called, what it reads and writes, by name, and its settings."""

    operation: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    settings: dict[str, Any]


@dataclass(frozen=True)
class NetworkGraph:
    """A network: operations in the order to run them, its constants, and what is known of it."""

    nodes: tuple[Node, ...]
    constants: dict[str, Array]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    widths: dict[str, int]  # last axes of inputs, where they are fixed
    about: dict[str, str]  # what its file says besides
