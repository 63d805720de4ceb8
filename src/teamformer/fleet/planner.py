"""The seam to planning: from where the live robots are to who does which task with whom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple, Protocol

from teamformer.errors import ScenarioError
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.mission import Mission
from teamformer.grid import Grid, Place
from teamformer.model import Robot, Scenario, Task

if TYPE_CHECKING:
    from teamformer.planning.teams.annealing import TeamSearch

Stop = tuple[int, tuple[int, ...]]
"""A task and its coalition."""

ANNEALINGS = ((0.3, 0.8), (0.7, 0.3))
"""Shares of the rounds, and how hot each annealing begins, in steps of makespan."""

COOLINGS = 10
"""Temperatures in each annealing."""


class Situation(NamedTuple):
    """What a plan is made from: the live robots' places, what is to do, who is at work."""

    places: Mapping[int, tuple[float, float]]
    tasks: tuple[TaskFact, ...]
    serving: Mapping[int, tuple[int, ...]] = {}


class Planner(Protocol):
    """Turns a situation in which every task can be done into stops, in order."""

    def plan(self, mission: Mission, situation: Situation) -> Sequence[Stop]:
        """Return every task with a coalition that can do it, in an order to be kept to."""


class TeamPlanner:
    """Plans with forming counted by annealing, `rounds` of them and always the same ones."""

    def __init__(self, rounds: int = 10_000, seed: int = 0) -> None:
        self.rounds = rounds
        self.seed = seed

    def plan(self, mission: Mission, situation: Situation) -> Sequence[Stop]:
        """Return the best plan found; tasks that are being served come first, as they are."""
        from teamformer.planning.relaxation.problem import relax
        from teamformer.planning.teams.solve import first_search

        robots = sorted(situation.places)
        try:
            scenario = _scenario_of(mission, situation, robots)
        except ScenarioError:  # robots say that they are where they cannot be
            return _one_after_another(mission, situation, robots)
        search = first_search(relax(scenario), scenario, self.seed)
        if search is None:
            return _one_after_another(mission, situation, robots)
        self._anneal(search, len(situation.tasks))
        plan = search.best
        stops = [
            (
                situation.tasks[task].key,
                tuple(sorted(robots[r] for r in plan.crew[task, : plan.size[task]].tolist())),
            )
            for task in plan.order.tolist()
        ]
        return _serving_first(mission, situation, stops)

    def warm_up(self) -> None:
        """Load what planning needs, so that the first plan has not to wait for it."""
        import_module("teamformer.planning.teams.solve")

    def _anneal(self, search: TeamSearch, tasks: int) -> None:
        if tasks < 2:
            return
        for share, hot in ANNEALINGS:
            search.restart(search.best)
            for cooling in range(COOLINGS):
                search.anneal(int(self.rounds * share) // COOLINGS, cooling / COOLINGS, hot)


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
