"""Refuting a makespan: showing that tasks cannot all start in time.

A makespan gives each task a window in which it starts: after its head, before its tail. Tours of
the robots with each capability narrow the windows, and a task that needs several capabilities
carries what one of them says over to the others. Where that ends, a window is halved and both
halves are looked at. A makespan for which no windows are left is refuted; all else says nothing.
Times are in any unit: ticks where time is continuous, else steps.

Who does one task and then another is in one team at both only if all that either of them needs is
at both. If a capability that only the second needs cannot be at the first before it, a team joins
on the way; if one that only the first needs cannot be at the second after it, the team splits. Each
takes time in which nobody of the team moves. The only robot with a capability cannot be at a task
that does not fit into its tour.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Int32s, Ints
from teamformer.planning.bounds.tours import empty_tables, fit_in, narrow_starts
from teamformer.world.rules.constants import NOBODY

MOST_TASKS_A_TOUR = 17
"""Sets of more tasks are too many; the tours of those that need most time are looked at instead."""

HALVED = 6
"""So many of the widest windows are halved for a try; what narrows most is taken."""

GRAIN = 2000
"""Windows that narrow by less than this share of the makespan wake nobody: tours that pass ever
smaller gains to one another would go on for thousands of rounds."""


class Chains(NamedTuple):
    """What takes time before and after each task starts."""

    head: Ints  # (tasks,) it starts no earlier
    duration: Ints  # (tasks,)
    tail: Ints  # (tasks,) what is left at least when it has ended
    before: Int32s  # (tasks, most) the tasks that must have ended before each, then NOBODY


class Starts(NamedTuple):
    """Between which times each task starts, (tasks,)."""

    first: Ints
    last: Ints

    @property
    def room(self) -> float:
        """Return the width of all windows together."""
        return float((self.last - self.first).sum())


class Detours(NamedTuple):
    """Tasks that do not need the capability of a tour, and how far off they are."""

    tasks: Ints  # (others,) task numbers
    ways: Ints  # (visited, others)
    begin: Ints  # (others,) when the robot can be there first


class Tours(NamedTuple):
    """The tours of the robots with a capability: through which tasks they have to go.

    Ways between tasks are no longer than a detour by others of them.
    """

    tasks: Ints  # (visited,) task numbers
    between: Ints  # (visited, visited)
    duration: Ints  # (visited,)
    robots: int
    detours: Detours | None = None  # where one robot alone has the capability


class Refuter:
    """Looks for reasons why tasks cannot all be done by a time.

    A join or a split takes the time `forming`. It gives up, and refutes nothing, as soon as
    `is_over` says that nobody waits any more.
    """

    def __init__(
        self,
        chains: Chains,
        tours: Sequence[Tours],
        is_over: Callable[[], bool] = lambda: False,
        forming: int = 0,
    ) -> None:
        self._chains, self._is_over, self._forming = chains, is_over, forming
        self._tours = list(tours)
        self._between = [one.between for one in tours]  # (visited, visited) each, with forming
        self._grain = 0
        self._tables = empty_tables(max((len(one.tasks) for one in self._tours), default=0))
        self._visits: list[list[int]] = [[] for _ in chains.head]  # by task, the tours it is in
        for number, one in enumerate(self._tours):
            for task in one.tasks.tolist():
                self._visits[task].append(number)

    def refutes(self, makespan: int, nodes: int) -> bool:
        """Say whether no plan takes a makespan or less, after halving windows so many times."""
        self._grain = makespan // GRAIN
        latest = makespan - self._chains.tail - self._chains.duration
        starts = Starts(self._chains.head.copy(), latest)
        self._between = [one.between for one in self._tours]
        if not self._narrow(starts, range(len(self._tours))):
            return True
        while self._forming and self._lengthen(starts):
            if not self._narrow(starts, range(len(self._tours))):
                return True
        waiting = [starts]
        while waiting and nodes > 0 and not self._is_over():
            nodes -= 1
            waiting += self._branch(waiting.pop())
        return not waiting

    def raised(self, bound: int, nodes: int = 0) -> int:
        """Return a bound raised for as long as makespans are refuted.

        Leaps are doubled until one is too far, then halved.
        """
        if not self._tours:
            return bound
        leap = 1
        while self.refutes(bound + leap - 1, nodes):
            bound += leap
            leap *= 2
        while leap > 1:
            leap //= 2
            if self.refutes(bound + leap - 1, nodes):
                bound += leap
        return bound

    def _narrow(self, starts: Starts, changed: Iterable[int]) -> bool:
        """Narrow windows until nothing changes; False if nothing is left for some task."""
        waiting = set(changed)
        while waiting and not self._is_over():
            number = min(waiting, key=lambda one: len(self._tours[one].tasks))  # the quickest
            waiting.remove(number)
            tours = self._tours[number]
            first, last = starts.first[tours.tasks], starts.last[tours.tasks]
            if not narrow_starts(
                self._between[number], tours.duration, first, last, tours.robots, self._tables
            ):
                return False
            gain = first - starts.first[tours.tasks] + starts.last[tours.tasks] - last
            starts.first[tours.tasks], starts.last[tours.tasks] = first, last
            narrowed = set(tours.tasks[gain > self._grain].tolist()) | self._chain(starts)
            waiting |= {n for task in narrowed for n in self._visits[task] if n != number}
            if (starts.first > starts.last).any():
                return False
        return bool((starts.first <= starts.last).all())

    def _lengthen(self, starts: Starts) -> bool:
        """Have teams form where not all can be along; say whether this makes some tour longer."""
        tasks, before = len(starts.first), self._between
        joins, splits = np.zeros((2, tasks, tasks), np.bool_)  # from task to task
        for (own, _, duration, _, detours), between in zip(self._tours, before, strict=True):
            if detours is not None:
                first, last = starts.first[own], starts.last[own]
                narrow_starts(between, duration, first, last, 1, self._tables)
                others, ways, begin = detours
                windows = (starts.first[others], starts.last[others])
                told = np.array([begin, *windows, self._chains.duration[others]])
                fits = np.zeros((2, len(others), len(own)), np.bool_)
                fit_in(duration, ways, told, self._tables, *fits)
                joins[np.ix_(others, own)] |= ~fits[0]
                splits[np.ix_(own, others)] |= ~fits[1].T
        forms = self._forming * (joins.astype(np.int64) + splits)
        self._between = [closed(t.between + forms[np.ix_(t.tasks, t.tasks)]) for t in self._tours]
        return any((new > old).any() for new, old in zip(self._between, before, strict=True))

    def _chain(self, starts: Starts) -> set[int]:
        """Have tasks wait for those that they come after; return those that this narrows much."""
        before, duration, narrowed = self._chains.before, self._chains.duration, set()
        for task in np.flatnonzero((before != NOBODY).any(axis=1)).tolist():
            for other in before[task][before[task] != NOBODY].tolist():
                begin = starts.first[other] + duration[other]
                finish = starts.last[task] - duration[other]
                if begin > starts.first[task] + self._grain:
                    narrowed.add(task)
                if finish < starts.last[other] - self._grain:
                    narrowed.add(other)
                starts.first[task] = max(starts.first[task], begin)
                starts.last[other] = min(starts.last[other], finish)
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


def tours_through(
    urgent: Ints, tasks: Ints, between: Ints, duration: Ints, robots: int, most: int
) -> Tours:
    """Return tours through the tasks that are most urgent, so many at most.

    `urgent` (all tasks,) says how urgent each is; `between` (tasks, tasks) are ways between tasks.
    """
    by_urgency = np.argsort(-urgent[tasks], kind="stable")[:most]
    ways = closed(between[np.ix_(by_urgency, by_urgency)])
    tasks = tasks[by_urgency]
    return Tours(tasks, ways, duration[tasks], robots)


def closed(ways: Ints) -> Ints:
    """Return ways (places, places) that are no longer than a detour.

    The fastest of several paces may be none that is fastest everywhere.
    """
    for by in range(len(ways)):
        ways = np.minimum(ways, ways[:, by, None] + ways[None, by, :])
    return ways
