"""The critical path of a plan in continuous time, by its own times."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Generator, Iterator
from itertools import islice
from typing import NamedTuple

from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission, Task
from teamformer.mission.parts.shifts import fits_all
from teamformer.planning.problem.routes import MissionPlan, Stop
from teamformer.record.critical_path.stretches import (
    CLOSED,
    LINKED,
    UNKNOWN,
    Stretch,
    in_order,
    in_shifts,
)
from teamformer.record.phases import (
    CARRYING,
    FORMING,
    LOADING,
    OFF,
    SERVING,
    UNLOADING,
    WAITING,
    WALKING,
)
from teamformer.world.rules.constants import NOBODY

NEAR = 1e-9
"""Times nearer than this share of the makespan count as one: sums of fractions are rounded."""


class _Visit(NamedTuple):
    """A robot's stop at a task, and its place among the robot's stops."""

    robot: int
    place: int
    stop: Stop


def path_of_plan(mission: Mission, plan: MissionPlan) -> tuple[Stretch, ...]:
    """Return the stretches that a plan's makespan is the sum of, the first one first.

    A task starts when its last robot is there and the coalition has formed, or later: when it
    becomes known, its window opens, a task that it is `after` has ended, or a task that its start
    is linked with has started. The path goes on with the latest of these.
    """
    if not plan.makespan:
        return ()
    path = in_order(_PlanTracing(mission, plan).stretches())
    return tuple(in_shifts(mission, path))


class _PlanTracing:
    """Goes back through a plan from the end of its last way; `_now` is where the path has come."""

    def __init__(self, mission: Mission, plan: MissionPlan) -> None:
        self._mission, self._plan = mission, plan
        self._now = plan.makespan
        self._near = NEAR * max(1.0, plan.makespan)
        self._visits: defaultdict[int, list[_Visit]] = defaultdict(list)  # by task
        for route in plan.routes:
            for place, stop in enumerate(route.stops):
                self._visits[stop.task].append(_Visit(route.robot, place, stop))
        self._linked: set[int] = set()  # tasks that the path has come to by links of their starts

    def stretches(self) -> Iterator[Stretch]:
        """Yield the stretches, the last one first."""
        last = max(self._plan.routes, key=lambda route: (route.back, -route.robot))
        if not last.stops:
            yield self._back_to(0, WALKING, last.robot)
            return
        place = len(last.stops) - 1
        visit: _Visit | None = _Visit(last.robot, place, last.stops[place])
        yield self._back_to(last.stops[place].end, WALKING, last.robot)
        while visit is not None:
            task = visit.stop.task
            yield from self._done(visit)
            visit = yield from self._started(task, visit.robot)

    def _back_to(self, when: float, doing: str, robot: int = NOBODY, task: int = NOBODY) -> Stretch:
        """Return the stretch from an earlier moment to now, and go back to that moment."""
        stretch = Stretch(when, self._now, doing, robot, task)
        self._now = when
        return stretch

    def _done(self, visit: _Visit) -> Iterator[Stretch]:
        """Go back from the end of a task to its start."""
        wanted, robot, stop = self._mission.tasks[visit.stop.task], visit.robot, visit.stop
        if wanted.to is None:
            yield self._back_to(stop.start, SERVING, robot, stop.task)
            return
        taken_up = stop.start + wanted.duration
        arrived = max(taken_up, stop.end - wanted.unload)  # earlier only by what was rounded
        yield self._back_to(arrived, UNLOADING, robot, stop.task)
        yield self._back_to(taken_up, CARRYING, robot, stop.task)
        yield self._back_to(stop.start, LOADING, robot, stop.task)

    def _started(self, task: int, robot: int) -> Generator[Stretch, None, _Visit | None]:
        """Go back from when a task starts; return the visit at whose end the path goes on."""
        last = max(self._visits[task], key=lambda visit: (visit.stop.arrive, visit.robot == robot))
        if last.stop.arrive < self._now - self._near:
            wanted = self._mission.tasks[task]
            for visit in self._visits_before(wanted):
                if self._is_now(visit.stop.end):
                    return visit
            if self._is_now(release_of(wanted)):
                is_known = self._is_now(wanted.between[0]) if wanted.between else False
                yield self._back_to(0, CLOSED if is_known else UNKNOWN, task=task)
                return None
            for other in self._linked_with(task):
                self._linked.add(other.stop.task)
                yield self._back_to(other.stop.start, LINKED, task=other.stop.task)
                return (yield from self._started(other.stop.task, other.robot))
            yield from self._waited_for_shift(task)
            if last.stop.arrive < self._now - self._near:
                doing = FORMING if self._mission.forming else WAITING
                yield self._back_to(last.stop.arrive, doing, last.robot, task)
        return (yield from self._came(last))

    def _waited_for_shift(self, task: int) -> Iterator[Stretch]:
        """Go back from when a shift of a robot begins to when all were there, and had formed."""
        robots = self._mission.robots
        for robot, _, stop in self._visits[task]:
            if any(
                self._is_now(opens) for opens, _ in islice(robots[robot].rota.since(self._now), 2)
            ):
                yield self._back_to(self._all_there(task), OFF, robot, stop.task)
                return

    def _all_there(self, task: int) -> float:
        """Return when all robots of a task are there and have formed."""
        visits = self._visits[task]
        arrive = max(visit.stop.arrive for visit in visits)
        came_from = {
            self._plan.routes[visit.robot].stops[visit.place - 1].task
            if visit.place
            else self._mission.robots[visit.robot].at
            for visit in visits
        }
        if not self._mission.forming or len(came_from) == 1:
            return arrive
        rotas = [self._mission.robots[visit.robot].rota for visit in visits]
        return min(
            self._now, fits_all(rotas, arrive, self._mission.forming) + self._mission.forming
        )

    def _came(self, visit: _Visit) -> Generator[Stretch, None, _Visit | None]:
        """Go back from a robot's arrival to the end of its stop before; None at its start."""
        stops = self._plan.routes[visit.robot].stops
        before = visit.place - 1
        left = stops[before].end if before >= 0 else 0
        yield self._back_to(left, WALKING, visit.robot, visit.stop.task)
        return _Visit(visit.robot, before, stops[before]) if before >= 0 else None

    def _is_now(self, when: float) -> bool:
        return abs(when - self._now) <= self._near

    def _visits_before(self, task: Task) -> Iterator[_Visit]:
        """Yield a visit of each task that a task is `after`."""
        for number, other in enumerate(self._mission.tasks):
            if other.name in task.after and self._visits[number]:
                yield self._visits[number][0]

    def _linked_with(self, task: int) -> Iterator[_Visit]:
        """Yield a visit of each task whose start decides, by a link, when this one starts."""
        tasks = self._mission.tasks
        for number, other in enumerate(tasks):
            if number in self._linked or not self._visits[number]:
                continue
            visit = self._visits[number][0]
            least, _ = tasks[task].starts.get(other.name, (math.inf, 0))
            _, most = other.starts.get(tasks[task].name, (0, math.inf))
            if any(self._is_now(visit.stop.start + gap) for gap in (least, -most)):
                yield visit
