"""Which tasks are near to each other."""

from __future__ import annotations

import numpy as np

from teamformer.planning.continuous.problem import Ticks, Whole


def near_tasks(ways: Ticks, count: int) -> Whole:
    """Return the `count` tasks nearest to each, nearest first; ways are (places, tasks)."""
    tasks = ways.shape[1]
    count = min(count, tasks - 1)
    near = np.zeros((tasks, count), np.int32)
    for task in range(tasks):
        there = ways[task] + ways[:tasks, task]  # there and back: ways may differ by direction
        there[task] = np.iinfo(np.int64).max
        near[task] = np.argsort(there, kind="stable")[:count]
    return near
