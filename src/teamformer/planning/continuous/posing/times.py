"""When a plan does what, by the mission's rules and its true ways, one task after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Floats, Int32s, Ints
from teamformer.mission.checks.costs import cost_of, parts_of_ends
from teamformer.mission.checks.windows import latest_end
from teamformer.mission.model import Task
from teamformer.mission.parts.shifts import Rota, rotas_of
from teamformer.planning.continuous.posing.batteries import ChargedClock
from teamformer.planning.continuous.posing.remaining import Remaining
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.routes import MissionPlan, Route, Stop
from teamformer.world.rules.charging.times import ChargedTimes
from teamformer.world.rules.starts import (
    FIRST,
    Gap,
    LoadTimes,
    RoomLeft,
    StartRules,
    Timed,
    time_tasks,
)


@dataclass(frozen=True)
class TaskClock:
    """When tasks start by a plan, and what it has robots do; times are counted from the start.

    Robots and tasks have the numbers of the problem. Places are tasks and where robots are.
    """

    tasks: Sequence[Task]
    ways: Floats  # (paces, places, tasks)
    home: Floats  # (robots, places)
    pace: Ints  # (robots,)
    origin: Ints  # (robots,) the place where each is
    site: Int32s  # (places,) the same for places at one position
    carry: Floats  # (paces, tasks) how long loads are carried
    free: Sequence[float]  # (robots,) when each can leave its place
    release: Sequence[float]  # (tasks,)
    before: Mapping[int, Sequence[int]]
    gaps: Sequence[Gap]
    forming: float
    rotas: Sequence[Rota]  # (robots,) when each works; empty where all always do
    cost: Mapping[str, float] | None
    charging: ChargedClock | None = None  # if robots queue
    rooms: Sequence[RoomLeft] = ()

    def time(self, plan: CoalitionPlan) -> MissionPlan:
        """Return a plan with its times; one in which robots wait for one another has no end."""
        order = [task for task in plan.order.tolist() if plan.size[task] > 0]
        done = set(order)
        robots_of = {task: plan.coalition[task, : plan.size[task]].tolist() for task in order}
        rules = StartRules(
            way=self._way,
            site=lambda robot, before: int(self.site[self._place(robot, before)]),
            takes=self._time_taken,
            free=self.free,
            release=dict(enumerate(self.release)),
            before={task: [k for k in others if k in done] for task, others in self.before.items()},
            gaps=[gap for gap in self.gaps if gap.task in done and gap.other in done],
            forming=self.forming,
            rotas=self.rotas,
            rooms=self.rooms,
            loads=self._load_times(),
        )
        if self.charging is not None:
            charged = self.charging.time(rules, order, robots_of)
            return self._tell(order, charged.timed, rules, charged)
        return self._tell(order, time_tasks(rules, order, robots_of), rules)

    def _load_times(self) -> LoadTimes:
        loads = {number: task for number, task in enumerate(self.tasks) if task.to is not None}
        return LoadTimes(
            {number: task.duration for number, task in loads.items()},
            {number: task.unload for number, task in loads.items()},
            self._carried,
        )

    def _place(self, robot: int, before: int) -> int:
        return int(self.origin[robot]) if before == FIRST else before

    def _way(self, robot: int, before: int, task: int) -> float:
        return float(self.ways[self.pace[robot], self._place(robot, before), task])

    def _time_taken(self, task: int, robots: Sequence[int]) -> float:
        """Return how long a task takes: its service, and the way with its load."""
        wanted = self.tasks[task]
        return wanted.duration + self._carried(task, robots) + wanted.unload

    def _carried(self, task: int, robots: Sequence[int]) -> float:
        """Return how long a load is carried: by the slowest."""
        return max((float(self.carry[self.pace[robot], task]) for robot in robots), default=0.0)

    def _tell(
        self,
        order: Sequence[int],
        timed: Timed,
        rules: StartRules,
        charged: ChargedTimes | None = None,
    ) -> MissionPlan:
        """Return the plan that starts tasks at these times, `charged` where robots charge."""
        travel = 0.0
        stops: list[list[Stop]] = [[] for _ in self.free]
        late, ends = {}, {}
        for task in order:
            end = ends[task] = timed.end(task)
            for robot, before, arrive in timed.visits[task]:
                stops[robot].append(Stop(task, arrive, timed.start[task], end))
                travel += self._way(robot, before, task)
            by = end - latest_end(self.tasks[task].between)
            if by > 0:
                late[task] = by
        rows = zip(stops, self.origin.tolist(), self.free, strict=True)
        last = [(made[-1].task, made[-1].end) if made else (at, free) for made, at, free in rows]
        home = self.home[np.arange(len(last)), [place for place, _ in last]]
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
            **parts_of_ends(self.tasks, ends),
        }
        return MissionPlan(
            makespan=max(back),
            bound=0.0,
            is_proven=False,
            routes=tuple(
                Route(robot, tuple(stops[robot]), back[robot]) for robot in range(len(back))
            ),
            late=dict(sorted(late.items())),
            missed=tuple(task for task in range(len(self.tasks)) if task not in ends),
            cost=None if self.cost is None else cost_of(self.cost, parts),
        )


def clock_of(rest: Remaining, charging: ChargedClock | None) -> TaskClock:
    """Return the clock of some robots and tasks."""
    return TaskClock(
        tasks=rest.own_tasks,
        ways=rest.ways,
        home=rest.home,
        pace=rest.pace,
        origin=np.asarray(rest.origin, np.int64),
        site=rest.site,
        carry=rest.carry,
        free=[rest.known.free_at[robot] for robot in rest.robots],
        release=rest.release,
        before=rest.before,
        gaps=rest.gaps,
        forming=rest.mission.forming,
        rotas=rotas_of(rest.own_robots),
        cost=rest.mission.cost,
        charging=charging,
        rooms=rest.rooms,
    )
