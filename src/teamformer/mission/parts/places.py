"""Where a task may be whose place is not known: in some cells, points or places of roads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.parts.plane import DECIMALS, Plane
from teamformer.mission.parts.roads import LONGEST_WAY, Roads

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task, World
    from teamformer.mission.parts.grid import Place

WIDEST = 30
"""Cells, on a plane units: nobody may be asked to look for a task farther around than that."""

ROUNDING = 1e-9
"""Of lengths: a radius of 0.3 m holds what is three units of 0.1 m away."""


def possible_places(world: World, at: Place, within: float) -> tuple[Place, ...]:
    """Return where a task may be that is within a distance of a place, straight on; nearest first.

    On a grid these are the free cells of one connected part of the map: the part of the nearest
    one. On a plane they are the points at whole numbers of the plane's unit from the place. Of
    equally near ones the lowest comes first, then the one farthest left. There may be none. On
    roads they are the places to which the way takes no longer, at speed 1, by whatever is quickest.
    """
    if isinstance(world, Roads):
        return _places_on_roads(world, at, within)
    is_plane = isinstance(world, Plane)
    unit = world.unit if isinstance(world, Plane) else 1
    reach = int(within / unit + ROUNDING)
    found = []
    for along, up in product(range(-reach, reach + 1), repeat=2):
        x, y = at[0] + along * unit, at[1] + up * unit
        if is_plane:
            x, y = round(x, DECIMALS), round(y, DECIMALS)
        away_squared = (x - at[0]) ** 2 + (y - at[1]) ** 2
        if away_squared <= (within + ROUNDING) ** 2 and world.is_free((x, y)):
            found.append((round(away_squared, DECIMALS), y, x))
    places = [(x, y) for _, y, x in sorted(found)]
    return tuple(p for p in places if world.region(p) == world.region(places[0]))


def _places_on_roads(world: Roads, at: Place, within: float) -> tuple[Place, ...]:
    here = int(at[0])
    rows = [ways[here] for ways in world.ways.values()]
    away = {n: min(row[n] for row in rows) for n in range(len(world.places))} | {here: 0.0}
    near = (n for n, far in away.items() if far <= within + ROUNDING)
    return tuple((n, 0) for n in sorted(near, key=lambda n: (away[n], n)))


def sight_of(world: World, one: Place, other: Place) -> float:
    """Return how far apart two places are for one who looks: straight on, or not at all on roads.

    There who stands in one place sees nothing of another, which is infinitely far away.
    """
    if isinstance(world, Roads):
        return 0.0 if one == other else math.inf
    return math.dist(one, other)


def believed_place(world: World, task: Task) -> Place:
    """Return where a task is believed to be before anybody has looked for it."""
    return possible_places(world, task.at, task.within)[0] if task.within else task.at


def find_region_problems(
    world: World, what: str, at: Place, within: float, where: tuple[str | int, ...]
) -> Iterator[Problem]:
    """Return what is wrong with how far from its place something may be."""
    is_road = isinstance(world, Roads)
    place = f"'{world.name_of(at)}'" if isinstance(world, Roads) else f"[{at[0]}, {at[1]}]"
    what = f"{what} is within {within:g} of {place}"
    widest = LONGEST_WAY if is_road else WIDEST * (world.unit if isinstance(world, Plane) else 1)
    if not 0 <= within <= widest:  # NaN too
        yield Problem(where, f"{what}; use 0 to {widest:g}")
    elif not possible_places(world, at, within):
        yield Problem(where, f"{what}, where no cell is free; move it or widen it")


def busiest_part(mission: Mission) -> int:
    """Return the connected part of the map in which most robots start, the first of equals."""
    parts = [mission.world.region(robot.at) for robot in mission.robots]
    return max(sorted(set(parts)), key=parts.count)
