"""Refuting a makespan: showing that tasks cannot all start in time.

A makespan gives each task a window in which it starts: after its head, before its tail. Tours of
the robots with each capability narrow the windows, and a task that needs several capabilities
carries what one of them says over to the others. Where that ends, a window is halved and both
halves are looked at. A makespan for which no windows are left is refuted; all else says nothing.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from teamformer.arrays import Ints
from teamformer.planning.continuous.bounds.relaxations import Relaxation
from teamformer.planning.continuous.bounds.tours import empty_tables, narrow_starts
from teamformer.planning.continuous.problem import NOBODY, CoalitionProblem

MOST_TASKS_A_TOUR = 17
"""Sets of more tasks are too many; the tours of those that need most time are looked at instead."""

HALVED = 6
"""So many of the widest windows are halved for a try; what narrows most is taken."""


GRAIN = 2000
"""Windows that narrow by less than this share of the makespan wake nobody: tours that pass ever
smaller gains to one another would go on for thousands of rounds."""


class Starts(NamedTuple):
    """Between which ticks each task starts, (tasks,)."""

    first: Ints
    last: Ints

    @property
    def room(self) -> float:
        """Return the width of all windows together."""
        return float((self.last - self.first).sum())


class Tours(NamedTuple):
    """The tours of the robots with a capability: through which tasks they have to go."""

    tasks: Ints  # (visited,) task numbers
    between: Ints  # (visited, visited)
    duration: Ints  # (visited,)
    robots: int


class Refuter:
    """Looks for reasons why a problem's tasks cannot all be done by a time."""

    def __init__(self, problem: CoalitionProblem, relaxation: Relaxation) -> None:
        self._problem, self._relaxation = problem, relaxation
        caps = range(problem.needs.shape[1])
        found = [_tours(problem, relaxation, cap) for cap in caps]
        self._tours = sorted((t for t in found if t is not None), key=lambda t: len(t.tasks))
        self._grain = 0
        self._tables = empty_tables(max((len(t.tasks) for t in self._tours), default=0))
        self._visits = [  # by task, the tours that it is in
            [n for n, tours in enumerate(self._tours) if task in tours.tasks]
            for task in range(len(problem.needs))
        ]

    def refutes(self, makespan: int, nodes: int) -> bool:
        """Say whether no plan takes a makespan or less, after halving windows so many times."""
        head, tail = self._relaxation.head, self._relaxation.tail
        self._grain = makespan // GRAIN
        starts = Starts(head.copy(), makespan - tail - self._problem.duration)
        if not self._narrow(starts, range(len(self._tours))):
            return True
        waiting = [starts]
        while waiting and nodes > 0:
            nodes -= 1
            waiting += self._branch(waiting.pop())
        return not waiting

    def _narrow(self, starts: Starts, changed: Iterable[int]) -> bool:
        """Narrow windows until nothing changes; False if nothing is left for some task."""
        waiting = set(changed)
        while waiting:
            number = min(waiting)  # the smallest tours, which take least time
            waiting.remove(number)
            tours = self._tours[number]
            first, last = starts.first[tours.tasks], starts.last[tours.tasks]
            if not narrow_starts(
                tours.between, tours.duration, first, last, tours.robots, self._tables
            ):
                return False
            gain = first - starts.first[tours.tasks] + starts.last[tours.tasks] - last
            starts.first[tours.tasks], starts.last[tours.tasks] = first, last
            narrowed = set(tours.tasks[gain > self._grain].tolist()) | self._chain(starts)
            waiting |= {n for task in narrowed for n in self._visits[task] if n != number}
            if (starts.first > starts.last).any():
                return False
        return bool((starts.first <= starts.last).all())

    def _chain(self, starts: Starts) -> set[int]:
        """Have tasks wait for those that they come after; return the tasks that this narrows."""
        problem, narrowed = self._problem, set()
        for task in np.flatnonzero(problem.before[:, 0] != NOBODY).tolist():
            for other in problem.before[task][problem.before[task] != NOBODY].tolist():
                begin = starts.first[other] + problem.duration[other]
                finish = starts.last[task] - problem.duration[other]
                if begin > starts.first[task]:
                    starts.first[task] = begin
                    narrowed.add(task)
                if finish < starts.last[other]:
                    starts.last[other] = finish
                    narrowed.add(other)
        return narrowed

    def _branch(self, starts: Starts) -> list[Starts]:
        """Return the halves that are left of the window whose halving narrows most."""
        width = starts.last - starts.first
        best, score = [starts], -1.0
        for task in np.argsort(-width, kind="stable")[:HALVED].tolist():
            if width[task] < 1:
                break
            halves = self._halve(starts, task)
            if len(halves) < 2:
                return halves
            gain = (starts.room - halves[0].room) * (starts.room - halves[1].room)
            if gain > score:
                best, score = halves, gain
        return best

    def _halve(self, starts: Starts, task: int) -> list[Starts]:
        """Return what is left when a task starts in the first half of its window, or the second."""
        middle = (starts.first[task] + starts.last[task]) // 2
        earlier = Starts(starts.first.copy(), starts.last.copy())
        later = Starts(starts.first.copy(), starts.last.copy())
        earlier.last[task], later.first[task] = middle, middle + 1
        return [half for half in (earlier, later) if self._narrow(half, self._visits[task])]


def _tours(problem: CoalitionProblem, relaxation: Relaxation, cap: int) -> Tours | None:
    """Return the tours of the robots with a capability; None if there is nothing to go through."""
    able = np.flatnonzero(problem.counts[:, cap])
    tasks = np.flatnonzero(problem.needs[:, cap])
    if len(tasks) < 2:
        return None
    urgent = problem.duration + relaxation.head + relaxation.tail
    tasks = tasks[np.argsort(-urgent[tasks], kind="stable")][:MOST_TASKS_A_TOUR]
    paces = np.unique(problem.pace[able])
    between = relaxation.ways[paces][:, tasks][:, :, tasks].min(axis=0)
    for by in range(len(tasks)):  # the fastest of several paces may be none that is fastest
        np.minimum(between, between[:, by, None] + between[None, by, :], out=between)
    return Tours(tasks, np.ascontiguousarray(between), problem.duration[tasks], len(able))
