"""The deadlock guard: who has seen no progress for too long does what cannot block.

Every robot remembers for itself since when the open tasks that its team sees are the same.
"""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry, kernel
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import NEXT_TASKS, View

BASE_PATIENCE = 30  # steps
WAYS_ACROSS = 3
"""A team waits for 30 steps, and for as many as three walks across what it sees take it."""


class DeadlockGuard:
    """Counts, robot by robot, the steps since the shared list of open tasks last changed."""

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """Forget everything."""
        self._tasks = np.zeros((0, 0), dtype=np.int64)  # (worlds, robots) what was seen, hashed
        self._waited = np.zeros((0, 0), dtype=np.int64)  # (worlds, robots) steps

    def is_overdue(self, view: View) -> Array:
        """Look at a new step's views; return which teams have waited for too long, as (teams,).

        A team waits for as long as its first robot has.
        """
        self._make_room(view)
        is_overdue = np.zeros(len(view.slot), dtype=np.bool_)
        _watch(view, self._tasks, self._waited, is_overdue)
        return is_overdue

    def _make_room(self, view: View) -> None:
        worlds = int(view.world.max(initial=-1)) + 1
        robots = int(view.member.max(initial=-1)) + 1
        have_worlds, have_robots = self._waited.shape
        more = (
            (0, max(0, worlds - have_worlds)),
            (0, max(0, robots - have_robots)),
        )
        if more != ((0, 0), (0, 0)):
            self._tasks = np.pad(self._tasks, more)
            self._waited = np.pad(self._waited, more)


@entry
def _watch(view: View, tasks: Array, waited: Array, is_overdue: Array) -> None:
    for row in range(len(is_overdue)):
        w = view.world[row]
        seen = _hash_open_tasks(view, row)
        for place in range(view.first_member[row], view.first_member[row + 1]):
            robot = view.member[place]
            is_same = tasks[w, robot] == seen
            tasks[w, robot] = seen
            waited[w, robot] = waited[w, robot] + 1 if is_same else 0
        is_overdue[row] = waited[w, view.slot[row]] > _patience(view, row)


@entry
def _hash_open_tasks(view: View, row: int) -> np.int64:
    """Return a number for the set of open tasks in sight, whatever their order.

    Only the first ones in the shared order count, which every team sees whatever its assignment.
    """
    seen = np.uint64(0)
    for column in range(view.task_number.shape[1]):
        task = view.task_number[row, column]
        if task != NOBODY and view.task_rank[row, column] < NEXT_TASKS - 1:
            seen += _mix(np.uint64(task + 1))
    return np.int64(seen)


@kernel
def _mix(number: np.uint64) -> np.uint64:
    """Return a number as if by chance (splitmix64; Steele, Lea and Flood, OOPSLA 2014)."""
    number *= np.uint64(0x9E3779B97F4A7C15)
    number = (number ^ (number >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    number = (number ^ (number >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return number ^ (number >> np.uint64(31))


@allocating_kernel
def _patience(view: View, row: int) -> float:
    """Return how many steps a team waits, from the places that it sees."""
    left = right = view.place[row, 0]
    low = high = view.place[row, 1]
    for column in range(view.task_number.shape[1]):
        if view.task_number[row, column] != NOBODY:
            x, y = view.task_place[row, column]
            left, right = min(left, x), max(right, x)
            low, high = min(low, y), max(high, y)
    across = (right - left + high - low) / min(view.pace[row], view.unit[row])
    return BASE_PATIENCE + WAYS_ACROSS * across
