"""The mission's places in metres of the ROS map, and back."""

from __future__ import annotations

import math
from itertools import product

from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads


def metres_of(world: Grid | Plane | Roads, place: Place) -> tuple[float, float]:
    """Return where a place of the mission is on the map, in metres.

    A cell of a grid without a map of its own is a square metre whose middle has its numbers.
    """
    frame = world.frame if isinstance(world, Grid) else None
    return (float(place[0]), float(place[1])) if frame is None else frame.point(place)


def place_of(world: Grid | Plane | Roads, x: float, y: float) -> Place:
    """Return the place of the mission for metres of the map: on grids the nearest free cell.

    A point next to no free cell becomes its own cell, which then is not free.
    """
    if not isinstance(world, Grid):
        return x, y
    if world.frame is not None:
        x, y = world.frame.place((x, y))
    near = [(round(x) + right, round(y) + up) for right, up in product((-1, 0, 1), repeat=2)]
    free = [cell for cell in near if world.is_free(cell)]
    return min(free or [(round(x), round(y))], key=lambda cell: math.dist(cell, (x, y)))
