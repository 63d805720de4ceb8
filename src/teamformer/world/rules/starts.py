"""When tasks in continuous time start by an order and coalitions, one task after the other.

The plain rule: plans are timed by it, and whoever carries one out foresees by it how it goes on.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from teamformer.mission.parts.shifts import Rota, fits_all

SAME = 1e-5
"""By such a share of all time starts may go on to change, as times are rounded."""

FIRST = -1
"""What stands for the task before a robot's first one: it comes from where it is."""


class Gap(NamedTuple):
    """A task starts at least and at most so long after another one starts."""

    task: int
    other: int
    least: float
    most: float


class RoomLeft(NamedTuple):
    """Of some tasks so many go on at once, and they begin in their order.

    Others are `taken` until so and so: by what is under way there and none of these tasks. `loads`
    are unloaded there: who comes first is first.
    """

    tasks: frozenset[int]
    room: int
    taken: tuple[float, ...] = ()
    loads: frozenset[int] = frozenset()


class LoadTimes(NamedTuple):
    """How long loads are taken up and unloaded, by task, and carried by some robots.

    A load takes room in zones only while it is taken up or unloaded.
    """

    lifting: Mapping[int, float]
    unloading: Mapping[int, float]
    carried: Callable[[int, Sequence[int]], float]


@dataclass(frozen=True)
class StartRules:
    """What decides when tasks start. `way`, `site` and `takes` are asked about these tasks only.

    `way(robot, before, task)` is how long a robot takes to a task from the one before, or FIRST;
    `site(robot, before)` the same for all that come from one place; `takes(task, robots)` how long
    these do the task.
    """

    way: Callable[[int, int, int], float]
    site: Callable[[int, int], Hashable]
    takes: Callable[[int, Sequence[int]], float]
    free: Sequence[float]  # by robot: when it can leave from where it is
    release: Mapping[int, float]  # by task: it does not start before
    before: Mapping[int, Sequence[int]]  # by task, if there are any: those that must have ended
    gaps: Sequence[Gap] = ()
    forming: float = 0.0  # what a coalition takes whose robots do not come from one site
    rotas: Sequence[Rota] = ()  # by robot: when it works; empty where all always do
    rooms: Sequence[RoomLeft] = ()
    loads: LoadTimes | None = None  # of all tasks with loads

    def arrival(self, robot: int, left: float, way: float) -> float:
        """Return when a robot is there that sets out at a time and walks so long."""
        return self.rotas[robot].walked(left, way) if self.rotas else left + way

    def worked(self, robot: int, begin: float, end: float) -> float:
        """Return how long a robot works between two moments."""
        return self.rotas[robot].worked(begin, end) if self.rotas else end - begin

    def fitted(self, robots: Iterable[int], earliest: float, takes: float) -> float:
        """Return the first moment from which something fits into a shift of each of some robots."""
        if not self.rotas or math.isinf(earliest):
            return earliest
        return fits_all([self.rotas[robot] for robot in robots], earliest, takes)


class Visit(NamedTuple):
    """A robot comes to a task from the one before, or FIRST, and is there at a time."""

    robot: int
    before: int
    arrive: float


@dataclass(frozen=True)
class Timed:
    """When tasks start and how long they take, by number, and who comes to each; inf for never."""

    start: dict[int, float]
    takes: dict[int, float]
    visits: dict[int, list[Visit]] = field(default_factory=dict)

    def end(self, task: int) -> float:
        """Return when a task ends."""
        return self.start[task] + self.takes[task]


def time_tasks(
    rules: StartRules, order: Sequence[int], robots_of: Mapping[int, Sequence[int]]
) -> Timed:
    """Return when tasks start that are done in an order, each by its robots.

    Where starts are linked all are timed again and again until nothing changes, as a task may wait
    for one that comes later. In an order in which robots wait for one another for ever none starts.
    """
    came: dict[int, list[tuple[int, int]]] = {}
    last: dict[int, int] = {}
    for task in order:
        came[task] = [(robot, last.get(robot, FIRST)) for robot in robots_of[task]]
        last |= dict.fromkeys(robots_of[task], task)
    timed = Timed(dict.fromkeys(order, 0.0), {k: rules.takes(k, robots_of[k]) for k in order})
    gaps: dict[int, list[Gap]] = {}
    for gap in rules.gaps:
        gaps.setdefault(gap.task, []).append(gap)
    ahead = ahead_in_rooms(rules.rooms, order)
    for _ in range(len(order) + 1 if gaps else 1):
        was = dict(timed.start)
        for task in order:
            enters = enters_rooms(timed, ahead.get(task, ()))
            ready = _ready(rules, timed, task, came[task], enters)
            timed.start[task] = max(timed.start[task], ready)
            for _, other, least, most in gaps.get(task, ()):
                timed.start[task] = max(timed.start[task], timed.start[other] + least)
                timed.start[other] = max(timed.start[other], timed.start[task] - most)
        if timed.start == was:
            break
    else:
        if gaps and _differs(was, timed.start):
            timed.start.update(dict.fromkeys(order, math.inf))
    for task in order:  # a link may have moved the start of a task before
        timed.visits[task] = [_visit(rules, timed, task, *one) for one in came[task]]
    return timed


def ahead_in_rooms(
    rooms: Sequence[RoomLeft], order: Sequence[int]
) -> dict[int, list[tuple[RoomLeft, list[int]]]]:
    """Return the rooms that each task takes, with the tasks that begin there before it."""
    ahead: dict[int, list[tuple[RoomLeft, list[int]]]] = {}
    for room in rooms:
        inside = [task for task in order if task in room.tasks]
        for place, task in enumerate(inside):
            ahead.setdefault(task, []).append((room, inside[:place]))
    return ahead


def enters_rooms(timed: Timed, rooms: Sequence[tuple[RoomLeft, Sequence[int]]]) -> float:
    """Return when a task can start by rooms, each with the tasks that enter it before.

    Infinite if nobody knows when one of these starts.
    """
    return max((_enters(timed, *one) for one in rooms), default=0.0)


def _enters(timed: Timed, room: RoomLeft, ahead: Sequence[int]) -> float:
    ends = sorted([*room.taken, *map(timed.end, ahead)], reverse=True)
    begun = max((timed.start[other] for other in ahead), default=0.0)
    return max(begun, ends[room.room - 1]) if len(ends) >= room.room else begun


def _ready(
    rules: StartRules,
    timed: Timed,
    task: int,
    came: Sequence[tuple[int, int]],
    enters: float,
) -> float:
    """Return when a task can start, but for its links; not before it `enters` its zones."""
    arrive = [_visit(rules, timed, task, *one).arrive for one in came]
    ready, robots = max(rules.release[task], *arrive), [robot for robot, _ in came]
    if rules.forming and len({rules.site(*one) for one in came}) > 1:
        ready = max(ready, rules.fitted(robots, max(arrive), rules.forming) + rules.forming)
    ready = max([ready, enters, *(timed.end(other) for other in rules.before.get(task, ()))])
    return rules.fitted(robots, ready, timed.takes[task])


def _visit(rules: StartRules, timed: Timed, task: int, robot: int, before: int) -> Visit:
    left = rules.free[robot] if before == FIRST else timed.end(before)
    return Visit(robot, before, rules.arrival(robot, left, rules.way(robot, before, task)))


def _differs(was: Mapping[int, float], now: Mapping[int, float]) -> bool:
    latest = max(now.values(), default=0.0)
    return any(start - was[task] > SAME * latest for task, start in now.items())
