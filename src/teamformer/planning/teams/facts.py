"""What everybody knows of a mission at a moment, and the plan that follows from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from teamformer.capabilities import covers
from teamformer.grid import Grid, Place
from teamformer.mission.checks import totals_by_region
from teamformer.model import Scenario
from teamformer.planning.distances import UNREACHABLE, straight_ways, travel_matrix
from teamformer.planning.relaxation.plan import Array
from teamformer.planning.relaxation.problem import (
    Relaxed,
    able_robots,
    count_table,
    future_of,
    steps_of_cells,
)
from teamformer.planning.teams.crossings import Crossings, find_crossings
from teamformer.rules.constants import FAR

MOST_CELLS = 20_000
"""Of a plane: how many cells the longest way is counted in."""


@dataclass(frozen=True)
class Facts:
    """The present of a mission, as everybody knows it; robots and tasks are numbers."""

    step: int  # steps made
    open_tasks: tuple[int, ...]  # known, not done and not being served
    places: tuple[Place, ...]  # of every robot; of lost ones any
    teams: tuple[tuple[int, ...], ...]  # who is with whom; a robot in no team is lost
    free_at: tuple[int, ...]  # the step from which each robot is free: `step` or its service's end


@dataclass(frozen=True)
class SharedPlan:
    """Who does what: each robot's next task is the first not done that has it in its coalition."""

    order: tuple[int, ...]  # open tasks
    coalitions: tuple[tuple[int, ...], ...]  # the robots of each, in the same order
    ends: tuple[int, ...]  # the step in which each is done if nothing happens
    start: str  # what it was made from: crews, coalitions, the old plan, or kept
    scouts: tuple[tuple[int, int], ...] = ()  # robots, and the task that each looks at first

    @property
    def makespan(self) -> int:
        """Return the step in which the last task is done if nothing happens."""
        return max(self.ends, default=0)


class Situation(NamedTuple):
    """The present as arrays: robots that are left and open tasks, numbered anew."""

    robots: tuple[int, ...]  # their numbers in the scenario
    tasks: tuple[int, ...]
    problem: Relaxed
    crossings: Crossings
    company: Array  # (robots,) the lowest robot of the team that each is in
    forming_steps: int


def possible_tasks(scenario: Scenario, facts: Facts) -> tuple[int, ...]:
    """Return the open tasks that the robots left can do; others wait for one to come back."""
    left = (scenario.robots[robot] for team in facts.teams for robot in team)
    have = totals_by_region(scenario.world, left)
    return tuple(
        task
        for task in facts.open_tasks
        if covers(
            have.get(scenario.world.region(scenario.tasks[task].at), {}), scenario.tasks[task].needs
        )
    )


def situation_of(scenario: Scenario, facts: Facts) -> Situation:
    """Return the present as arrays; what is still to come in the scenario is not looked at."""
    robots = tuple(sorted(robot for team in facts.teams for robot in team))
    number = {robot: index for index, robot in enumerate(robots)}
    company = np.zeros(len(robots), np.int64)
    for team in facts.teams:
        company[[number[robot] for robot in team]] = min(number[robot] for robot in team)
    tasks = facts.open_tasks
    spots = [scenario.tasks[task].at for task in tasks]
    places = [*spots, *(facts.places[robot] for robot in robots)]
    cells, speed = _ways(scenario, spots, places, robots)
    no_way = 1 + int(cells[cells < UNREACHABLE].max())
    speeds, pace = np.unique(speed, return_inverse=True)
    counts = count_table([scenario.robots[r].can for r in robots], scenario)
    problem = Relaxed(
        cells=np.ascontiguousarray(np.minimum(cells, no_way)),
        steps=steps_of_cells(speeds, no_way),
        pace=pace.astype(np.int32),
        speed=speed,
        counts=counts,
        needs=count_table([scenario.tasks[task].needs for task in tasks], scenario),
        able=able_robots(counts),
        duration=np.array([scenario.tasks[task].duration for task in tasks], np.int32),
        appears=np.full(len(tasks), facts.step, np.int32),
        lost=np.full(len(robots), FAR, np.int32),
        ready=np.array([facts.free_at[robot] for robot in robots], np.int32),
    )
    crossings = find_crossings(scenario.world, spots, places, speeds)
    return Situation(robots, tasks, problem, crossings, company, scenario.forming_steps)


def situation_in_hindsight(scenario: Scenario) -> Situation:
    """Return the start as arrays for who knows what will happen: what appears, who will be lost."""
    start = Facts(
        step=0,
        open_tasks=tuple(range(len(scenario.tasks))),
        places=tuple(robot.at for robot in scenario.robots),
        teams=scenario.starting_teams,
        free_at=(0,) * len(scenario.robots),
    )
    situation, future = situation_of(scenario, start), future_of(scenario)
    problem = situation.problem._replace(appears=future.appears, lost=future.lost)
    return situation._replace(problem=problem)


def _ways(
    scenario: Scenario, spots: list[Place], places: list[Place], robots: tuple[int, ...]
) -> tuple[Array, Array]:
    """Return the cells from places to tasks, (tasks, places), and those that robots walk a step.

    On a plane a cell is a small fraction of the longest way, and no way is counted short.
    """
    pace = np.array([scenario.world.pace(scenario.robots[robot].speed) for robot in robots])
    if isinstance(scenario.world, Grid):
        return travel_matrix(scenario.world, places, spots).T, pace
    metres = straight_ways(spots, places)
    cell = max(1e-6, float(metres.max()) / MOST_CELLS)
    return np.ceil(metres / cell - 1e-9).astype(np.int32), pace / cell
