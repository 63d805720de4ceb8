"""The present of a mission as arrays, which searches start from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.coordination import Known, Plan
from teamformer.grid import Grid, Place
from teamformer.model import Scenario
from teamformer.planning.prices import prices_of
from teamformer.planning.relaxation.problem import (
    Relaxed,
    able_robots,
    count_table,
    flights,
    future_of,
    number_ways,
    paces_of,
    steps_of_ways,
)
from teamformer.planning.relaxation.relaxed_plan import Array
from teamformer.planning.steps.crossings import Crossings, find_crossings
from teamformer.planning.steps.team_plan import TeamPlan
from teamformer.rules.constants import FAR
from teamformer.rules.distances import straight_ways, travel_matrix

MOST_CELLS = 20_000
"""Of a plane: how many cells the longest way is counted in."""


class Situation(NamedTuple):
    """The present as arrays: robots that are left and open tasks, numbered anew."""

    robots: tuple[int, ...]  # their numbers in the scenario
    tasks: tuple[int, ...]
    problem: Relaxed
    crossings: Crossings
    company: Array  # (robots,) the lowest robot of the team that each is in
    forming_steps: int


def situation_of(known: Known) -> Situation:
    """Return the present as arrays; what is still to come in the mission is not looked at."""
    scenario, robots = known.mission, known.robots
    number = {robot: index for index, robot in enumerate(robots)}
    company = np.zeros(len(robots), np.int64)
    for team in known.teams:
        company[[number[robot] for robot in team]] = min(number[robot] for robot in team)
    tasks = known.open_tasks
    spots = [scenario.tasks[task].at for task in tasks]
    places = [*spots, *(known.places[robot] for robot in robots)]
    walked, speed = _ways(scenario, spots, places, robots)
    cells, lengths = number_ways(walked, flights(scenario, spots, places))
    speeds, rank = np.unique(speed, return_inverse=True)
    counts = count_table([scenario.robots[r].can for r in robots], scenario)
    problem = Relaxed(
        cells=cells,
        lengths=lengths,
        steps=steps_of_ways(speeds, lengths),
        pace=paces_of(rank, [scenario.robots[robot] for robot in robots], lengths),
        speed=speed,
        counts=counts,
        needs=count_table([scenario.tasks[task].needs for task in tasks], scenario),
        able=able_robots(counts),
        duration=np.array([scenario.tasks[task].duration for task in tasks], np.int32),
        appears=np.full(len(tasks), known.step, np.int32),
        lost=np.full(len(robots), FAR, np.int32),
        ready=np.array([known.free_at[robot] for robot in robots], np.int32),
        prices=prices_of(scenario, [scenario.tasks[task] for task in tasks]),
    )
    crossings = find_crossings(scenario.world, spots, places, speeds, len(lengths) > 1)
    return Situation(robots, tasks, problem, crossings, company, scenario.forming_steps)


def situation_in_hindsight(scenario: Scenario) -> Situation:
    """Return the start as arrays for who knows what will happen: what appears, who will be lost."""
    start = Known(
        mission=scenario,
        step=0,
        open_tasks=tuple(range(len(scenario.tasks))),
        places=tuple(robot.at for robot in scenario.robots),
        teams=scenario.starting_teams,
        free_at=(0,) * len(scenario.robots),
    )
    situation, future = situation_of(start), future_of(scenario)
    problem = situation.problem._replace(appears=future.appears, lost=future.lost)
    return situation._replace(problem=problem)


def plan_of(situation: Situation, found: TeamPlan) -> Plan:
    """Return what was planned for a situation in the numbers of the mission."""
    order = found.order.tolist()
    return Plan(
        order=tuple(situation.tasks[task] for task in order),
        coalitions=tuple(
            tuple(situation.robots[r] for r in sorted(found.coalition[task, : found.size[task]]))
            for task in order
        ),
    )


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
