"""Which tasks come before others, and orders in which they stand behind those."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teamformer.mission.model import Task


def tasks_before(tasks: Sequence[Task]) -> dict[int, list[int]]:
    """Return which of some tasks come before each, where any do; all by their place among them."""
    number = {task.name: index for index, task in enumerate(tasks)}
    before = (
        [number[name] for name in task.after if name in number] if task.after else []
        for task in tasks
    )
    return {index: numbers for index, numbers in enumerate(before) if numbers}


def keep_precedence(order: Sequence[int], before: Mapping[int, Collection[int]]) -> list[int]:
    """Return an order in which each task is behind those before it that are in the order.

    Tasks are moved back as little as that needs. `before` has the tasks that come before each, if
    there are any; they must not go in a circle.
    """
    place = {task: index for index, task in enumerate(order)}
    awaits = {task: len(place.keys() & set(before.get(task, ()))) for task in order}
    after: dict[int, list[int]] = {}
    for task in order:
        for other in before.get(task, ()):
            after.setdefault(other, []).append(task)
    ready = [index for index, task in enumerate(order) if awaits[task] == 0]  # a heap: it ascends
    kept: list[int] = []
    while ready:
        kept.append(order[heapq.heappop(ready)])
        for other in after.get(kept[-1], ()):
            awaits[other] -= 1
            if awaits[other] == 0:
                heapq.heappush(ready, place[other])
    return kept
