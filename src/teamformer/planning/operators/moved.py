"""The tasks that a change has moved, and how they are put back."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Ints
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.graph import Graph

MOST_MOVED = 8
"""How many tasks one change moves at most."""


class Moved(NamedTuple):
    """The tasks that a change has moved, and what they were before."""

    number: Ints  # (1,) how many they are
    task: Ints  # (MOST_MOVED,)
    key: Ints  # (MOST_MOVED,)
    size: Ints  # (MOST_MOVED,)
    kinds: Ints  # (MOST_MOVED, seats) the kinds of their seats


def empty_moved(seats: int) -> Moved:
    """Return room for tasks of so many seats."""
    one = np.zeros(1, np.int64)
    task, key, size = (np.zeros(MOST_MOVED, np.int64) for _ in range(3))
    return Moved(one, task, key, size, np.zeros((MOST_MOVED, seats), np.int64))


@kernel
def remember(graph: Graph, moved: Moved, task: int) -> None:
    """Note the key of a task and the kinds of its robots before they change."""
    node, place = graph.nodes[task], moved.number[0]
    moved.task[place], moved.key[place], moved.size[place] = task, node.key, node.taken
    for index in range(node.taken):
        moved.kinds[place, index] = graph.seats[node.first + index].kind
    moved.number[0] = place + 1


@kernel
def take_back(graph: Graph, moved: Moved) -> None:
    """Give tasks that were moved their keys and kinds again; arcs are undone elsewhere."""
    for place in range(moved.number[0]):
        node = graph.nodes[moved.task[place]]
        node.key, node.taken = moved.key[place], moved.size[place]
        for index in range(node.taken):
            graph.seats[node.first + index].kind = moved.kinds[place, index]
