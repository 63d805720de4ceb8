"""How long all ways of a mission take, as tables, and how finely times are told apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from teamformer.base.array_types import Floats, Ints
from teamformer.mission.keys.mission_keys import HOME as ENDS_HOME
from teamformer.mission.model import Mission, Robot, Task, World
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.roads import AIR, Roads
from teamformer.world.rules.distances import UNREACHABLE, straight_ways, travel_matrix

MOST_TICKS, MOST_WITH_WAITS = 2 * 10**9, 10**12
"""About how many ticks everything takes at most, one task after the other: all that is done, and
that with waiting for the last window to begin."""

STRAIGHT = 1 - 1e-9
"""A way is shorter than another if it is by more than what rounding makes of equal ones."""


MOST_WEIGHT = 10**6
"""Tasks that weigh more together have fewer ticks: what they cost has to stay a whole number."""


def distances(world: World, moves: str, origins: Sequence[Place], goals: Sequence[Place]) -> Floats:
    """Return how long ways take at speed 1, as (origins, goals); infinite where there is none."""
    if isinstance(world, Roads):
        here, there = ([int(number) for number, _ in some] for some in (origins, goals))
        return np.array(world.ways[moves])[np.ix_(here, there)]
    if not isinstance(world, Grid):
        return straight_ways(origins, goals)
    is_in_the_way = moves != AIR and world.rows
    cells = travel_matrix(world if is_in_the_way else replace(world, rows=()), origins, goals)
    return np.where(cells < UNREACHABLE, cells.astype(np.float64), np.inf)


def ways_of_loads(world: World, moves: str, tasks: Sequence[Task]) -> Floats:
    """Return how long loads are carried at speed 1, as (tasks,); 0 for tasks without one.

    A load that has come to be where it goes is carried no more.
    """
    carried = np.zeros(len(tasks))
    for number, task in enumerate(tasks):
        if task.to is not None and task.to != task.at:
            carried[number] = distances(world, moves, [task.at], [task.to])[0, 0]
    return carried


def ways_home(mission: Mission, robots: Sequence[Robot], places: Sequence[Place]) -> Floats:
    """Return how long each robot takes home from each place, (robots, places)."""
    ends = mission.ends
    if ends is None:
        return np.zeros((len(robots), len(places)))
    home = {(r.moves, r.at if ends == ENDS_HOME else ends): np.empty(0) for r in robots}
    for moves, goal in home:
        assert not isinstance(goal, str)
        home[moves, goal] = distances(mission.world, moves, places, [goal])[:, 0]
    return np.array([home[r.moves, r.at if ends == ENDS_HOME else ends] / r.speed for r in robots])


def longest_of(
    tasks: Sequence[Task], forming: float, ways: Floats, home: Floats, carry: Floats
) -> float:
    """Return how long all that is done takes at most, one task after the other."""
    longest = max(part[np.isfinite(part)].max(initial=0.0) for part in (ways, home))
    total = sum(task.duration + task.unload + forming for task in tasks)
    total += float(carry[:, np.isfinite(carry).all(axis=0)].max(axis=0).sum())
    return float(total + longest * (len(tasks) + 1) + 1e-6)


def ticks_in_a_unit(busy: float, waits: float, weight: float) -> float:
    """Return a power of ten: as many ticks in a unit as there may be of all times together.

    One window that begins long after all else does not make what is done before it coarse.
    `weight` is that of all tasks.
    """
    most, scale = MOST_WITH_WAITS / max(1.0, weight / MOST_WEIGHT), 1e-6
    while 10 * scale * busy <= MOST_TICKS and 10 * scale * (busy + waits) <= most:
        scale *= 10
    return scale


def ways_by_pace(
    mission: Mission, robots: Sequence[Robot], tasks: Sequence[Task], places: Sequence[Place]
) -> tuple[Ints, Floats, Floats]:
    """Return the pace of each robot, and by pace how long ways and carrying take.

    Ways are (paces, places, tasks), to where tasks begin; carrying is (paces, tasks).
    """
    paces = sorted({(robot.moves, robot.speed) for robot in robots})
    pace = np.array([paces.index((robot.moves, robot.speed)) for robot in robots])
    begins = [task.at for task in tasks]
    world, movers = mission.world, {moves for moves, _ in paces}
    metres = {moves: distances(world, moves, places, begins) for moves in movers}
    loads = {moves: ways_of_loads(world, moves, tasks) for moves in movers}
    ways = np.array([metres[moves] / speed for moves, speed in paces])
    carry = np.array([loads[moves] / speed for moves, speed in paces])
    np.einsum("pkk->pk", ways[:, : len(tasks)])[:] = 0.0  # not the way from an end to a beginning
    return pace, ways, carry


def has_detour(ways: Floats, home: Floats, pace: Ints, takes: Floats) -> bool:
    """Say whether some way by a task, which takes so long, is shorter than the straight one."""
    for task, spent in enumerate(takes):
        by_task = ways[:, :, task] + spent  # (paces, places)
        is_shorter = by_task[:, :, None] + ways[:, None, task] < ways * STRAIGHT
        back = by_task[pace] + home[:, task, None]  # (robots, places)
        if is_shorter.any() or (back < home * STRAIGHT).any():
            return True
    return False
