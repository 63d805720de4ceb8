"""When a plan does what, by the mission's rules and its true ways, one task after the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby

import numpy as np
import numpy.typing as npt

from teamformer.mission.costs import cost_of, parts_of_ends
from teamformer.mission.links import groups_of
from teamformer.mission.rules import latest_end
from teamformer.model import Scenario
from teamformer.planning.continuous.routes import MissionPlan, Route, Stop
from teamformer.planning.continuous.schedule import CoalitionPlan

Times = npt.NDArray[np.float64]


class Clock:
    """Robots on their ways from task to task.

    `ways` is (paces, places, tasks); `site` (places,) is the same for places at one position.
    """

    def __init__(
        self,
        scenario: Scenario,
        ways: Times,
        pace: npt.NDArray[np.int64],
        origin: npt.NDArray[np.int64],
        site: npt.NDArray[np.int32],
    ) -> None:
        self._scenario, self._ways, self._pace, self._site = scenario, ways, pace, site
        self._number_of = {task.name: number for number, task in enumerate(scenario.tasks)}
        self.at, self.free = origin.copy(), np.zeros(len(origin))
        self.start: dict[int, float] = {}
        self.end: dict[int, float] = {}
        self.stops: list[list[Stop]] = [[] for _ in scenario.robots]
        self.travel = 0.0

    def do(self, tasks: Sequence[int], plan: CoalitionPlan) -> None:
        """Let the coalitions of tasks, which are linked if they are several, do them next."""
        arrivals = [self._go(task, plan.coalition[task, : plan.size[task]]) for task in tasks]
        self._keep_gaps(tasks)
        for task, arrive in zip(tasks, arrivals, strict=True):
            coalition = plan.coalition[task, : plan.size[task]]
            self.end[task] = self.start[task] + self._scenario.tasks[task].duration
            for robot, when in zip(coalition.tolist(), arrive.tolist(), strict=True):
                self.stops[robot].append(Stop(task, when, self.start[task], self.end[task]))
            self.at[coalition], self.free[coalition] = task, self.end[task]

    def _go(self, task: int, coalition: npt.NDArray[np.int32]) -> Times:
        """Send a coalition to a task; return when its robots are there."""
        wanted, at = self._scenario.tasks[task], self.at[coalition]
        ways = self._ways[self._pace[coalition], at, task]
        arrive: Times = self.free[coalition] + ways
        start = max(release_of(self._scenario, task), *arrive.tolist())
        if len(set(self._site[at].tolist())) > 1:
            start = max(start, float(arrive.max()) + self._scenario.forming)
        ends = (self.end[self._number_of[name]] for name in wanted.after)
        self.start[task] = max([start, *ends])
        self.travel += float(ways.sum())
        return arrive

    def _keep_gaps(self, tasks: Sequence[int]) -> None:
        """Start linked tasks later until all gaps are kept."""
        for _ in tasks if len(tasks) > 1 else ():
            for task in tasks:
                for name, (least, most) in self._scenario.tasks[task].starts.items():
                    other = self._number_of[name]
                    self.start[task] = max(self.start[task], self.start[other] + least)
                    self.start[other] = max(self.start[other], self.start[task] - most)


def time_mission(scenario: Scenario, clock: Clock, home: Times, plan: CoalitionPlan) -> MissionPlan:
    """Return a plan with its times; `home` is (robots, places), and nobody has begun yet."""
    for tasks in _in_groups(scenario, plan.order.tolist()):
        clock.do(tasks, plan)
    way_home = home[np.arange(len(clock.at)), clock.at]
    back = clock.free + way_home
    late = {
        task: clock.end[task] - latest_end(scenario.tasks[task].between)
        for task in sorted(clock.end)
    }
    late = {task: by for task, by in late.items() if by > 0}
    makespan = float(back.max())
    parts = {
        "makespan": makespan,
        "travel": clock.travel + float(way_home.sum()),
        **parts_of_ends(scenario.tasks, clock.end),
    }
    return MissionPlan(
        makespan=makespan,
        bound=0.0,
        is_proven=False,
        routes=tuple(
            Route(robot, tuple(stops), float(back[robot]))
            for robot, stops in enumerate(clock.stops)
        ),
        late=late,
        cost=None if scenario.cost is None else cost_of(scenario.cost, parts),
    )


def release_of(scenario: Scenario, task: int) -> float:
    """Return when a task may begin, whoever is there."""
    wanted = scenario.tasks[task]
    return max(float(wanted.appears), wanted.between[0] if wanted.between else 0.0)


def _in_groups(scenario: Scenario, order: Sequence[int]) -> Iterator[list[int]]:
    """Return an order's tasks, those together that are linked, which stand beside one another."""
    group_of = {task: at for at, group in enumerate(groups_of(scenario.tasks)) for task in group}
    for _, tasks in groupby(order, key=group_of.__getitem__):
        yield list(tasks)
