"""Which tasks lie on the way: a team that comes past one that it can do does it.

On a grid a team that walks from one place to another stands, step by step, in the cells of one
shortest way. Other tasks in these cells are listed once, so that a plan can be timed without
walking.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.mission.model import World
from teamformer.mission.parts.grid import Grid, Place
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.distances import UNREACHABLE, distance_fields
from teamformer.world.rules.steps import next_cell

MOST_WAYS = 300_000
"""Of more ways than this between places and tasks, what lies on them is not looked at."""


class Crossings(NamedTuple):
    """The tasks on every way, in the order in which one comes to them.

    What lies on the way from a place to a task is at `first[place * tasks + task]` and on; what
    lies under that way in the air, if robots fly over walls, is `places * tasks` ways later. The
    last cell counts. The first does on the way from a task to itself, and where a robot starts,
    which may still be there after a step.
    """

    first: Array  # (movers * places * tasks + 1,)
    task: Array  # (crossings,)
    cells: Array  # (crossings,) from the beginning of the way
    speeds: Array  # (speeds,) cells a step, as fractions decide where a step ends


def no_crossings() -> Crossings:
    """Return a list that says nothing about any way."""
    nothing = np.zeros(0, np.int32)
    return Crossings(nothing, nothing, nothing, np.zeros(0))


def find_crossings(
    world: World,
    tasks: Sequence[Place],
    places: Sequence[Place],
    speeds: Array,
    any_fly: bool = False,
) -> Crossings:
    """Return which tasks are on the ways from places to tasks; none on planes and vast maps.

    `places` begin with the tasks'; `speeds` are those of the robots, sorted, each once. `any_fly`
    says that some robots fly over walls.
    """
    if not isinstance(world, Grid) or len(tasks) * len(places) > MOST_WAYS:
        return no_crossings()
    spots = np.array([*places], np.int32).reshape(-1, 2)
    goals = np.array([*tasks], np.int32).reshape(-1, 2)
    no_fields = np.zeros((len(goals), 0, 0), np.int32)
    fields = distance_fields(world, tasks) if world.rows else no_fields
    found: Crossings = list_crossings(fields, spots, goals, world.width, world.height, speeds)
    if any_fly:
        flown = list_crossings(no_fields, spots, goals, world.width, world.height, speeds)
        found = found._replace(
            first=np.append(found.first, flown.first[1:] + found.first[-1]),
            task=np.append(found.task, flown.task),
            cells=np.append(found.cells, flown.cells),
        )
    return found


def without_bound(crossings: Crossings, is_load: Array, is_in_zone: Array) -> Crossings:
    """Return crossings without those that loads and tasks in zones play no part in; both (tasks,).

    Nobody begins either in passing, and who takes up a load does nothing else where it is.
    """
    tasks, count = len(is_load), np.diff(crossings.first)
    way = np.repeat(np.arange(len(count)), count)
    is_here = way // tasks == way % tasks  # what is where a task is
    is_bound = is_load | is_in_zone
    is_kept = ~is_bound[crossings.task] & ~(is_here & is_load[way % tasks])
    first = np.concatenate([[0], np.cumsum(np.bincount(way[is_kept], minlength=len(count)))])
    task, cells = crossings.task[is_kept], crossings.cells[is_kept]
    return Crossings(first.astype(np.int32), task, cells, crossings.speeds)


@entry
def list_crossings(
    fields: Array, spots: Array, goals: Array, width: int, height: int, speeds: Array
) -> Crossings:
    """Return the crossings of ways from `spots` (places, 2) to `goals` (tasks, 2).

    `fields` (tasks, height, width) holds the distances to each task, or no cells if no cell of
    the map is blocked.
    """
    tasks = len(goals)
    head = np.full((height, width), NOBODY, dtype=np.int32)  # the first task in each cell
    following = np.full(tasks, NOBODY, dtype=np.int32)
    for task in range(tasks - 1, -1, -1):
        x, y = goals[task]
        following[task], head[y, x] = head[y, x], task
    first = np.zeros(len(spots) * tasks + 1, dtype=np.int32)
    count = 0
    found = Crossings(first, np.empty(0, np.int32), np.empty(0, np.int32), speeds)
    for is_final in (False, True):
        if is_final:
            found = Crossings(first, np.empty(count, np.int32), np.empty(count, np.int32), speeds)
        count = 0
        for place in range(len(spots)):
            for task in range(tasks):
                first[place * tasks + task] = count
                is_same = place == task
                count = _walk(
                    fields, head, following, spots[place], goals, task, found, count, is_final,
                    is_same, place >= tasks,
                )  # fmt: skip
        first[len(spots) * tasks] = count
    return found


@kernel
def _walk(
    fields: Array, head: Array, following: Array, spot: Array, goals: Array, task: int,
    found: Crossings, count: int, is_final: bool, is_same: bool, is_start: bool,
) -> int:  # fmt: skip
    """Walk one way; count the tasks on it and, in the end, write them down."""
    x, y = spot[0], spot[1]
    has_walls = fields.shape[1] > 0
    if has_walls and fields[task, y, x] >= UNREACHABLE:
        return count
    cells = 0
    if is_start and (x != goals[task, 0] or y != goals[task, 1]):
        count = _note(head, following, x, y, task, cells, found, count, is_final)
    if is_same:
        return _note(head, following, x, y, task, cells, found, count, is_final)
    while x != goals[task, 0] or y != goals[task, 1]:
        x, y = next_cell(fields, has_walls, task, x, y, goals[task, 0], goals[task, 1])
        cells += 1
        count = _note(head, following, x, y, task, cells, found, count, is_final)
    return count


@kernel
def _note(
    head: Array, following: Array, x: int, y: int, task: int, cells: int,
    found: Crossings, count: int, is_final: bool,
) -> int:  # fmt: skip
    other = head[y, x]
    while other != NOBODY:
        if other != task:
            if is_final:
                found.task[count], found.cells[count] = other, cells
            count += 1
        other = following[other]
    return count
