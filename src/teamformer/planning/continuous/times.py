"""When a plan does what, by the mission's rules and its true ways, one task after the other."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from teamformer.base.array_types import Floats, Int32s, Ints
from teamformer.mission.checks.costs import cost_of, parts_of_ends
from teamformer.mission.checks.windows import latest_end, release_of
from teamformer.mission.model import Mission
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.routes import MissionPlan, Route, Stop

SAME = 1e-5
"""By such a share of all time starts may go on to change, as times are rounded."""


class TaskClock:
    """When tasks start by a plan, and what it has robots do.

    `ways` is (paces, places, tasks), `home` (robots, places); `site` (places,) is the same for
    places at one position; `carry` (paces, tasks) is how long loads are carried. Nobody has begun
    yet.
    """

    def __init__(
        self,
        mission: Mission,
        ways: Floats,
        home: Floats,
        pace: Ints,
        origin: Ints,
        site: Int32s,
        carry: Floats,
    ) -> None:
        self._mission, self._ways, self._home = mission, ways, home
        self._pace, self._origin, self._site = pace, origin, site
        self._carry = carry
        self._takes = np.zeros(len(mission.tasks))  # by the coalitions of the plan at hand
        self._number_of = {task.name: number for number, task in enumerate(mission.tasks)}

    def time(self, plan: CoalitionPlan) -> MissionPlan:
        """Return a plan with its times.

        Tasks are timed in the plan's order; where starts are linked again and again until nothing
        changes, as a task may wait for one that comes later. A plan in which robots wait for one
        another for ever has no end.
        """
        before = self._places_before(plan)
        self._takes = np.array([self._time_taken(task, doers) for task, doers in enumerate(before)])
        start = np.zeros(len(plan.order))
        is_linked = any(task.starts for task in self._mission.tasks)
        for _ in range(len(start) + 1 if is_linked else 1):
            was = start.copy()
            for task in plan.order.tolist():
                start[task] = max(start[task], self._ready(task, before[task], start))
                self._keep_gaps(task, start)
            if (start == was).all():
                break
        else:
            if is_linked and (start - was > SAME * start.max()).any():
                start[:] = math.inf
        return self._tell(plan, before, start)

    def _places_before(self, plan: CoalitionPlan) -> list[dict[int, int]]:
        """Return, by task, the place that each of its robots comes from."""
        at = self._origin.copy()
        before: list[dict[int, int]] = [{} for _ in plan.order]
        for task in plan.order.tolist():
            for robot in plan.coalition[task, : plan.size[task]].tolist():
                before[task][robot], at[robot] = int(at[robot]), task
        return before

    def _free(self, place: int, start: Floats) -> float:
        """Return when a robot can leave a place."""
        return float(start[place] + self._takes[place]) if place < len(start) else 0.0

    def _time_taken(self, task: int, robots: Iterable[int]) -> float:
        """Return how long a task takes: its service, and the way with its load by the slowest."""
        wanted = self._mission.tasks[task]
        carried = max(
            (float(self._carry[self._pace[robot], task]) for robot in robots), default=0.0
        )
        return wanted.duration + carried + wanted.unload

    def _way(self, robot: int, place: int, task: int) -> float:
        return float(self._ways[self._pace[robot], place, task])

    def _ready(self, task: int, before: dict[int, int], start: Floats) -> float:
        """Return when a task can start, but for its links."""
        arrive = [self._free(p, start) + self._way(robot, p, task) for robot, p in before.items()]
        ready = max(release_of(self._mission.tasks[task]), *arrive)
        if len({int(self._site[place]) for place in before.values()}) > 1:
            ready = max(ready, max(arrive) + self._mission.forming)
        numbers = (self._number_of[name] for name in self._mission.tasks[task].after)
        return max([ready, *(self._free(number, start) for number in numbers)])

    def _keep_gaps(self, task: int, start: Floats) -> None:
        """Let a task, and those that it is linked with, start later where a gap says so."""
        for name, (least, most) in self._mission.tasks[task].starts.items():
            other = self._number_of[name]
            start[task] = max(start[task], start[other] + least)
            start[other] = max(start[other], start[task] - most)

    def _tell(
        self, plan: CoalitionPlan, before: Sequence[dict[int, int]], start: Floats
    ) -> MissionPlan:
        """Return the plan that starts tasks at these times."""
        mission, at, travel = self._mission, self._origin.copy(), 0.0
        stops: list[list[Stop]] = [[] for _ in mission.robots]
        late, ends = {}, {}
        for task in plan.order.tolist():
            end = ends[task] = self._free(task, start)
            for robot, place in before[task].items():
                way = self._way(robot, place, task)
                arrive = self._free(place, start) + way
                stops[robot].append(Stop(task, arrive, float(start[task]), end))
                at[robot], travel = task, travel + way
            by = end - latest_end(mission.tasks[task].between)
            if by > 0:
                late[task] = by
        home = self._home[np.arange(len(at)), at]
        back = [
            self._free(int(place), start) + float(way) for place, way in zip(at, home, strict=True)
        ]
        parts = {
            "makespan": max(back),
            "travel": travel + float(home.sum()),
            **parts_of_ends(mission.tasks, ends),
        }
        return MissionPlan(
            makespan=max(back),
            bound=0.0,
            is_proven=False,
            routes=tuple(
                Route(robot, tuple(stops[robot]), back[robot]) for robot in range(len(back))
            ),
            late=dict(sorted(late.items())),
            cost=None if mission.cost is None else cost_of(mission.cost, parts),
        )
