"""The shared tour: a travelling-salesman order that every robot computes alike.

Whole numbers and fixed scanning orders only, so the same distances give the same tour anywhere.
"""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry, kernel

LARGEST_EXACT = 10
"""Up to this many tasks the tour is optimal (Held and Karp 1962); beyond, a local optimum."""

UNLINKED = 2**60


@entry
def plan_tour(between: Array, from_start: Array) -> Array:
    """Return the order of an open tour from the start through all tasks, as (tasks,).

    `between` is (tasks, tasks) and symmetric, `from_start` is (tasks,). Few tasks get the best.
    """
    if len(from_start) <= LARGEST_EXACT:
        return _exact_tour(between, from_start)
    tour = _nearest_first_tour(between, from_start)
    while _improve_by_reversal(tour, between, from_start) or _improve_by_moving(
        tour, between, from_start
    ):
        pass
    return tour


@allocating_kernel
def _exact_tour(between: Array, from_start: Array) -> Array:
    """Dynamic programme over subsets: cost[visited, last] is the shortest way there."""
    count = len(from_start)
    tour = np.empty(count, dtype=np.int64)
    if count == 0:
        return tour
    cost = np.full((1 << count, count), UNLINKED, dtype=np.int64)
    before = np.full((1 << count, count), -1, dtype=np.int64)
    for last in range(count):
        cost[1 << last, last] = from_start[last]
    for visited in range(1, 1 << count):
        for last in range(count):
            if cost[visited, last] == UNLINKED:
                continue
            for task in range(count):
                grown = visited | (1 << task)
                length = cost[visited, last] + between[last, task]
                if grown != visited and length < cost[grown, task]:
                    cost[grown, task] = length
                    before[grown, task] = last
    visited = (1 << count) - 1
    last = 0
    for task in range(count):
        if cost[visited, task] < cost[visited, last]:
            last = task
    for position in range(count - 1, -1, -1):
        tour[position] = last
        visited, last = visited & ~(1 << last), before[visited, last]
    return tour


@entry
def _nearest_first_tour(between: Array, from_start: Array) -> Array:
    """Go to the nearest unvisited task each time; the lowest number among equals."""
    count = len(from_start)
    tour = np.empty(count, dtype=np.int64)
    is_visited = np.zeros(count, dtype=np.bool_)
    away = from_start
    for position in range(count):
        nearest = -1
        for task in range(count):
            if not is_visited[task] and (nearest < 0 or away[task] < away[nearest]):
                nearest = task
        tour[position] = nearest
        is_visited[nearest] = True
        away = between[nearest]
    return tour


@kernel
def _leg(tour: Array, between: Array, from_start: Array, left: int, right: int) -> np.int64:
    """Return the distance between two positions; -1 is the start, the open end costs nothing."""
    if right >= len(tour):
        return np.int64(0)
    return from_start[tour[right]] if left < 0 else between[tour[left], tour[right]]


@kernel
def _improve_by_reversal(tour: Array, between: Array, from_start: Array) -> bool:
    """Reverse stretches while that shortens the tour (2-opt); say whether anything changed."""
    count = len(tour)
    changed = False
    for first in range(count - 1):
        entry = _leg(tour, between, from_start, first - 1, first)
        for last in range(first + 1, count):
            old = entry + _leg(tour, between, from_start, last, last + 1)
            head = tour[last]
            new = from_start[head] if first == 0 else between[tour[first - 1], head]
            if new >= old:
                continue
            if last + 1 < count:
                new += between[tour[first], tour[last + 1]]
            if new < old:
                _reverse(tour, first, last)
                entry = _leg(tour, between, from_start, first - 1, first)
                changed = True
    return changed


@kernel
def _improve_by_moving(tour: Array, between: Array, from_start: Array) -> bool:
    """Move stretches of up to three tasks elsewhere while that helps (Or-opt)."""
    count = len(tour)
    changed = False
    for length in range(1, 4):
        for first in range(count - length + 1):
            last = first + length - 1
            saved = (
                _leg(tour, between, from_start, first - 1, first)
                + _leg(tour, between, from_start, last, last + 1)
                - (
                    _leg(tour, between, from_start, first - 1, last + 1)
                    if last + 1 < count
                    else np.int64(0)
                )
            )
            if saved <= 0:
                continue
            for gap in range(count + 1):  # the stretch goes between positions gap - 1 and gap
                if first <= gap <= last + 1:
                    continue
                added = (
                    _leg(tour, between, from_start, gap - 1, first)
                    + (between[tour[last], tour[gap]] if gap < count else np.int64(0))
                    - _leg(tour, between, from_start, gap - 1, gap)
                )
                if added < saved:
                    _move_stretch(tour, first, length, gap)
                    changed = True
                    break
    return changed


@kernel
def _move_stretch(tour: Array, first: int, length: int, gap: int) -> None:
    """Take `length` tasks from position `first` and put them before position `gap`."""
    if gap < first:
        _swap_neighbours(tour, gap, first, first + length)
    else:
        _swap_neighbours(tour, first, first + length, gap)


@kernel
def _swap_neighbours(tour: Array, first: int, second: int, end: int) -> None:
    """Exchange the stretches [first, second) and [second, end), each kept in its direction."""
    _reverse(tour, first, second - 1)
    _reverse(tour, second, end - 1)
    _reverse(tour, first, end - 1)


@kernel
def _reverse(tour: Array, first: int, last: int) -> None:
    while first < last:
        tour[first], tour[last] = tour[last], tour[first]
        first += 1
        last -= 1
