"""When a plan does what, by the mission's rules and its true ways, one task after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.mission.checks.costs import cost_of, parts_of_ends
from teamformer.mission.checks.windows import latest_end
from teamformer.mission.parts.shifts import rotas_of
from teamformer.planning.continuous.posing.batteries import ChargedClock
from teamformer.planning.continuous.posing.remaining import Remaining
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.routes import MissionPlan, Route, Stop
from teamformer.world.rules.charging.times import ChargedTimes
from teamformer.world.rules.starts import FIRST, LoadTimes, StartRules, Timed, time_tasks


@dataclass(frozen=True)
class TaskClock:
    """When tasks start by a plan, and what it has robots do; times are counted from the start.

    Robots and tasks have the numbers of the problem. Places are tasks and where robots are.
    """

    rest: Remaining
    charging: ChargedClock | None = None  # if robots queue

    def time(self, plan: CoalitionPlan) -> MissionPlan:
        """Return a plan with its times; one in which robots wait for one another has no end."""
        rest, order = self.rest, [task for task in plan.order.tolist() if plan.size[task] > 0]
        done = set(order)
        robots_of = {task: plan.coalition[task, : plan.size[task]].tolist() for task in order}
        rules = StartRules(
            way=self._way,
            site=lambda robot, before: int(rest.site[self._place(robot, before)]),
            takes=self._time_taken,
            free=rest.free,
            release=dict(enumerate(rest.release)),
            before={task: [k for k in others if k in done] for task, others in rest.before.items()},
            gaps=[gap for gap in rest.gaps if gap.task in done and gap.other in done],
            forming=rest.mission.forming,
            rotas=rotas_of(rest.own_robots),
            rooms=rest.rooms,
            loads=self._load_times(),
        )
        if self.charging is not None:
            charged = self.charging.time(rules, order, robots_of)
            return self._tell(order, charged.timed, rules, charged)
        return self._tell(order, time_tasks(rules, order, robots_of), rules)

    def _load_times(self) -> LoadTimes:
        loads = {
            number: task for number, task in enumerate(self.rest.own_tasks) if task.to is not None
        }
        return LoadTimes(
            {number: task.duration for number, task in loads.items()},
            {number: task.unload for number, task in loads.items()},
            self._carried,
        )

    def _place(self, robot: int, before: int) -> int:
        return int(self.rest.origin[robot]) if before == FIRST else before

    def _way(self, robot: int, before: int, task: int) -> float:
        return float(self.rest.ways[self.rest.pace[robot], self._place(robot, before), task])

    def _time_taken(self, task: int, robots: Sequence[int]) -> float:
        """Return how long a task takes: its service, and the way with its load."""
        wanted = self.rest.own_tasks[task]
        return wanted.duration + self._carried(task, robots) + wanted.unload

    def _carried(self, task: int, robots: Sequence[int]) -> float:
        """Return how long a load is carried: by the slowest."""
        carry, pace = self.rest.carry[:, task], self.rest.pace
        return max((float(carry[pace[robot]]) for robot in robots), default=0.0)

    def _tell(
        self,
        order: Sequence[int],
        timed: Timed,
        rules: StartRules,
        charged: ChargedTimes | None = None,
    ) -> MissionPlan:
        """Return the plan that starts tasks at these times, `charged` where robots charge."""
        rest, travel = self.rest, 0.0
        stops: list[list[Stop]] = [[] for _ in rest.free]
        late, ends = {}, {}
        for task in order:
            end = ends[task] = timed.end(task)
            for robot, before, arrive in timed.visits[task]:
                stops[robot].append(Stop(task, arrive, timed.start[task], end))
                travel += self._way(robot, before, task)
            by = end - latest_end(rest.own_tasks[task].between)
            if by > 0:
                late[task] = by
        rows = zip(stops, rest.origin, rest.free, strict=True)
        last = [(made[-1].task, made[-1].end) if made else (at, free) for made, at, free in rows]
        home = rest.home[np.arange(len(last)), [place for place, _ in last]]
        travel += float(home.sum())
        if charged is not None:
            back, travel = charged.back, sum(charged.walked)
        else:
            back = [
                rules.arrival(robot, left, float(way))
                for robot, ((_, left), way) in enumerate(zip(last, home, strict=True))
            ]
        parts = {
            "makespan": max(back),
            "travel": travel,
            **parts_of_ends(rest.own_tasks, ends),
        }
        return MissionPlan(
            makespan=max(back),
            bound=0.0,
            is_proven=False,
            routes=tuple(
                Route(robot, tuple(stops[robot]), back[robot]) for robot in range(len(back))
            ),
            late=dict(sorted(late.items())),
            missed=tuple(task for task in range(len(rest.tasks)) if task not in ends),
            cost=None if rest.mission.cost is None else cost_of(rest.mission.cost, parts),
        )
