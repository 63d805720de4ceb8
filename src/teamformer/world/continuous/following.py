"""Who goes where by the plan in force: each robot heads for its first task that is open.

A task is next for a robot if the plan has it in the coalition and it comes first in the order. A
robot that has none goes home if the mission ends there, else it stops.
"""

from __future__ import annotations

import copy

from teamformer.mission.coordination import Plan
from teamformer.mission.keys.mission_keys import HOME
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.precedence import keep_precedence, tasks_before
from teamformer.world.continuous.world import PhysicalWorld
from teamformer.world.rules.constants import NOBODY


class PlanFollower:
    """The plan in force, as each robot's list of tasks."""

    def __init__(self, mission: Mission) -> None:
        self.plan: Plan | None = None
        self.event = NOBODY  # with which the plan came into force
        self.order: list[int] = []
        self.robots_of: dict[int, tuple[int, ...]] = {}
        self._mission, self._before = mission, tasks_before(mission.tasks)
        self._routes: list[list[int]] = [[] for _ in mission.robots]
        self._scouts: dict[int, int] = {}

    def fork(self, mission: Mission | None = None) -> PlanFollower:
        """Return another one that goes its own way, perhaps in a mission that has changed."""
        twin = copy.copy(self)
        if mission is not None:
            twin._mission, twin._before = mission, tasks_before(mission.tasks)
        twin._routes = [list(route) for route in self._routes]
        twin._scouts = dict(self._scouts)
        return twin

    def take(self, plan: Plan, event: int) -> None:
        """Go by another plan from now on; tasks are behind those that they come after."""
        self.plan, self.event = plan, event
        self.robots_of = dict(zip(plan.order, plan.coalitions, strict=True))
        planned = [task for task in plan.order if self.robots_of[task]]
        waiting = [task for task in plan.order if not self.robots_of[task]]
        kept = keep_precedence([*planned, *waiting], self._before)
        self.order = [task for task in kept if self.robots_of[task]]
        self._scouts = dict(plan.scouts)
        self._routes = [[] for _ in self._mission.robots]
        for task in self.order:
            for robot in self.robots_of[task]:
                self._routes[robot].append(task)

    def rest(self, world: PhysicalWorld) -> Plan:
        """Return what is left of the plan: tasks that are neither over nor being served."""
        assert self.plan is not None, "a plan is in force"
        ends = dict(zip(self.plan.order, self.plan.ends, strict=True)) if self.plan.ends else {}
        left = [task for task in self.plan.order if _is_open(world, task)]
        return Plan(
            order=tuple(left),
            coalitions=tuple(self.robots_of[task] for task in left),
            ends=tuple(ends[task] for task in left) if ends else (),
            scouts=tuple(self._scouts.items()),
            why=self.plan.why,
            made_from=self.plan.made_from,
        )

    def next_task(self, world: PhysicalWorld, robot: int) -> int:
        """Return the task that a robot heads for, NOBODY if there is none."""
        scouted = self._scouts.get(robot, NOBODY)
        is_hidden = scouted in world.unseen or scouted in world.maybe
        if is_hidden and _is_open(world, scouted):
            return scouted
        route = self._routes[robot]
        while route and route[0] in world.over:
            route.pop(0)
        return next((task for task in route if _is_open(world, task)), NOBODY)

    def goal(self, world: PhysicalWorld, robot: int, task: int) -> Place | None:
        """Return where a robot goes for a task, or without one; None: where it can stop."""
        if task != NOBODY:
            return world.place_of(task)
        ends = self._mission.ends
        home = self._mission.robots[robot].at if ends == HOME else ends
        assert not isinstance(home, str)
        return home

    def is_home(self, world: PhysicalWorld, robot: int) -> bool:
        """Say whether a robot is where it has to be when the mission is over."""
        home = self.goal(world, robot, NOBODY)
        return home is None or world.bodies[robot].is_lost or world.is_at(robot, home)


def _is_open(world: PhysicalWorld, task: int) -> bool:
    """Say whether a task is known, not over, and nobody serves it."""
    if task not in world.appeared or task in world.over:
        return False
    return task not in world.works or not world.works[task].is_service
