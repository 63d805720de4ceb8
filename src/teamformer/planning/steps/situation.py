"""The present of a mission as arrays, which searches start from."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.checks.windows import opening_step
from teamformer.mission.coordination import Known, Plan, known_at_start
from teamformer.mission.model import Mission, Task
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.zones import all_rooms_of
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.permits import Permits, permits_of
from teamformer.planning.problem.relaxed_problem import Future, Relaxed, future_of, relax_ways
from teamformer.planning.problem.team_batteries import team_batteries
from teamformer.planning.problem.ways import are_ways_straight, ends_of
from teamformer.planning.step_times.crossings import Crossings, find_crossings, without_bound
from teamformer.world.rules.constants import FAR
from teamformer.world.rules.distances import straight_ways, travel_matrix
from teamformer.world.rules.starts import RoomLeft
from teamformer.world.rules.waits import room_taken

MOST_CELLS = 20_000
"""Of a plane: how many cells the longest way is counted in."""


class Situation(NamedTuple):
    """The present as arrays: robots that are left and open tasks, numbered anew."""

    robots: tuple[int, ...]  # their numbers in the mission
    tasks: tuple[int, ...]
    problem: Relaxed
    crossings: Crossings
    company: Array  # (robots,) the lowest robot of the team that each is in
    forming_steps: int


def situation_of(known: Known, in_table: bool = True) -> Situation:
    """Return the present as arrays; what is still to come in the mission is not looked at.

    Without `in_table` it has no table of ways where these can be worked out as they are needed.
    """
    mission, robots = known.mission, known.robots
    number = {robot: index for index, robot in enumerate(robots)}
    company = np.zeros(len(robots), np.int64)
    for team in known.teams:
        company[[number[robot] for robot in team]] = min(number[robot] for robot in team)
    tasks = known.open_tasks
    wanted = [mission.tasks[task] for task in tasks]
    spots = [task.at for task in wanted]
    places = [*ends_of(wanted), *(known.places[robot] for robot in robots)]
    if not in_table and are_ways_straight(mission.world, wanted):
        walked, speed = None, _paces(mission, robots)
    else:
        walked, speed = _ways(mission, spots, places, robots)
    problem = relax_ways(
        mission,
        wanted,
        [mission.robots[robot] for robot in robots],
        places,
        walked,
        speed,
        Future(
            appears=np.array([_opens(known, task) for task in wanted], np.int32),
            lost=np.full(len(robots), FAR, np.int32),
        ),
        ready=np.array([known.free_at[robot] for robot in robots], np.int32),
    )
    batteries = team_batteries(known, places, spots, speed)
    problem = problem._replace(permits=_permits(known), batteries=batteries)
    crossings = find_crossings(
        mission.world, spots, places, np.unique(speed), len(problem.lengths) > 1
    )
    is_load = np.array([task.to is not None for task in wanted])
    is_in_zone = np.array([any(row) for row in problem.permits.needs], np.bool_)
    if is_load.any() or is_in_zone.any():
        crossings = without_bound(crossings, is_load, is_in_zone)
    return Situation(robots, tasks, problem, crossings, company, mission.forming_steps)


def _permits(known: Known) -> Permits:
    """Return the room of all zones in which open tasks are, by their places among these.

    Loads take none: plans of missions with loads at zones are chosen by carrying them out.
    """
    tasks = known.mission.tasks
    place = {task: index for index, task in enumerate(known.open_tasks)}
    rooms = [
        RoomLeft(
            frozenset(place[k] for k in room.tasks if k in place and tasks[k].to is None),
            room.room,
            room_taken(known, room),
        )
        for room in all_rooms_of(known.mission)
    ]
    return permits_of([room for room in rooms if room.tasks], len(place), known.step)


def _opens(known: Known, task: Task) -> int:
    """Return how many steps are made when a task may begin, as far as services decide that."""
    tasks = known.mission.tasks
    ends = [until for before, until in known.under_way if tasks[before].name in task.after]
    return max([known.step, opening_step(task), *map(int, ends)])


def situation_in_hindsight(mission: Mission) -> Situation:
    """Return the start as arrays for who knows what will happen: what appears, who will be lost."""
    situation, future = situation_of(known_at_start(mission)), future_of(mission)
    problem = situation.problem._replace(appears=future.appears, lost=future.lost)
    return situation._replace(problem=problem)


def plan_of(situation: Situation, found: CoalitionPlan) -> Plan:
    """Return what was planned for a situation in the numbers of the mission.

    Tasks that are left out are not in it.
    """
    order = [task for task in found.order.tolist() if found.size[task] > 0]
    return Plan(
        order=tuple(situation.tasks[task] for task in order),
        coalitions=tuple(
            tuple(situation.robots[r] for r in sorted(found.coalition[task, : found.size[task]]))
            for task in order
        ),
    )


def _paces(mission: Mission, robots: tuple[int, ...]) -> Array:
    """Return what each robot walks in a step, in cells or metres, (robots,)."""
    return np.array([mission.world.pace(mission.robots[robot].speed) for robot in robots])


def _ways(
    mission: Mission, spots: list[Place], places: list[Place], robots: tuple[int, ...]
) -> tuple[Array, Array]:
    """Return the cells from places to tasks, (tasks, places), and those that robots walk a step.

    On a plane a cell is a small fraction of the longest way, and no way is counted short.
    """
    pace = _paces(mission, robots)
    if isinstance(mission.world, Grid):
        return travel_matrix(mission.world, places, spots).T, pace
    metres = straight_ways(spots, places)
    cell = max(1e-6, float(metres.max()) / MOST_CELLS)
    return np.ceil(metres / cell - 1e-9).astype(np.int32), pace / cell
