"""The seam to planning: from where the live robots are to who does which task with whom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import NamedTuple, Protocol

from teamformer.errors import ScenarioError
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.mission import Mission
from teamformer.grid import Grid, Place
from teamformer.model import Robot, Scenario, Task
from teamformer.planning.teams.facts import Facts, SharedPlan

Stop = tuple[int, tuple[int, ...]]
"""A task and its coalition."""


class Situation(NamedTuple):
    """What a plan is made from: the live robots' places, what is to do, who is at work."""

    places: Mapping[int, tuple[float, float]]
    tasks: tuple[TaskFact, ...]
    serving: Mapping[int, tuple[int, ...]] = {}
    old: tuple[Stop, ...] = ()  # the plan before


class Planner(Protocol):
    """Turns a situation in which every task can be done into stops, in order."""

    def plan(self, mission: Mission, situation: Situation) -> Sequence[Stop]:
        """Return every task with a coalition that can do it, in an order to be kept to."""


class SharedPlanner:
    """Plans as the simulator's `allocation: plan` does, from what is true now.

    The plan before is one of the plans that the search begins with, and stays where what would be
    gained is small. Where there is one, the search is brief: faults come often, and fast.
    """

    def plan(self, mission: Mission, situation: Situation) -> Sequence[Stop]:
        """Return the shared plan; tasks that are being served come first, as they are."""
        from teamformer.planning.teams.shared_plan import plan_mission

        robots = sorted(situation.places)
        try:
            scenario = _scenario_of(mission, situation, robots)
        except ScenarioError:  # robots say that they are where they cannot be
            return _one_after_another(mission, situation, robots)
        facts = Facts(
            step=0,
            open_tasks=tuple(range(len(situation.tasks))),
            places=tuple(robot.at for robot in scenario.robots),
            teams=tuple((number,) for number in range(len(robots))),
            free_at=(0,) * len(robots),
        )
        old = _old_plan(situation, robots)
        plan = plan_mission(scenario, facts, old, is_brief=bool(situation.old))
        stops = [
            (situation.tasks[task].key, tuple(robots[number] for number in coalition))
            for task, coalition in zip(plan.order, plan.coalitions, strict=True)
        ]
        return _serving_first(mission, situation, stops)

    def warm_up(self) -> None:
        """Load what planning needs, so that the first plan has not to wait for it."""
        import_module("teamformer.planning.teams.shared_plan")


def _old_plan(situation: Situation, robots: Sequence[int]) -> SharedPlan | None:
    """Return what is left of the plan before, in the numbers of the situation."""
    number = {robot: place for place, robot in enumerate(robots)}
    place_of = {task.key: place for place, task in enumerate(situation.tasks)}
    kept = [
        (place_of[key], tuple(number[robot] for robot in coalition if robot in number))
        for key, coalition in situation.old
        if key in place_of
    ]
    if not kept:
        return None
    order, coalitions = zip(*kept, strict=True)
    return SharedPlan(order, coalitions, (), "")


def _scenario_of(mission: Mission, situation: Situation, robots: Sequence[int]) -> Scenario:
    """Return the situation as a scenario that begins now; tasks and robots by their position."""
    whole = mission.scenario
    caps, is_grid = whole.capabilities, isinstance(whole.world, Grid)
    return Scenario(
        name=whole.name,
        world=whole.world,
        capabilities=caps,
        robots=tuple(
            Robot(
                str(robot),
                _place(situation.places[robot], is_grid),
                whole.robots[robot].can,
                whole.robots[robot].speed,
            )
            for robot in robots
        ),
        tasks=tuple(
            Task(
                str(task.key),
                _place((task.x, task.y), is_grid),
                {cap: need for cap, need in zip(caps, task.needs, strict=True) if need},
                round(task.duration / mission.step),
            )
            for task in situation.tasks
        ),
        forming_steps=whole.forming_steps,
        step_limit=1,
    )


def _place(place: tuple[float, float], is_grid: bool) -> Place:
    return (int(place[0]), int(place[1])) if is_grid else place


def _serving_first(mission: Mission, situation: Situation, stops: list[Stop]) -> list[Stop]:
    """Let who is at work go on; everything else keeps its order."""
    going = {
        task.key: situation.serving[task.key]
        for task in situation.tasks
        if task.key in situation.serving and mission.covers(situation.serving[task.key], task.needs)
    }
    first = list(going.items())
    return first + [stop for stop in stops if stop[0] not in going]


def _one_after_another(mission: Mission, situation: Situation, robots: Sequence[int]) -> list[Stop]:
    """Return the plainest plan there is: whoever can reach a task goes, task by task."""
    return [
        (task.key, tuple(robot for robot in robots if mission.reach(robot, task)))
        for task in situation.tasks
    ]
