"""Orders in which tasks stand behind those that they come after."""

from __future__ import annotations

import heapq
from collections.abc import Collection, Mapping, Sequence


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
