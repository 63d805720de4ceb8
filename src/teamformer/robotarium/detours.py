"""Ways around the rings at which others stand: straight ones would press against them."""

from __future__ import annotations

import numpy as np

from teamformer.robotarium.formation import fits
from teamformer.sim.arrays import Array

BERTH = 0.24  # metres outside a ring that passing robots keep
AMPLE = 1.15  # of it: where they head for, so that the ring is out of the way once they are there


def way_point(at: Array, goal: Array, centres: Array, radii: Array) -> Array:
    """Return where to head for from a place (2,) to reach a goal (2,): a point beside a ring.

    It is the goal itself where no ring of `radii` (rings,) around `centres` (rings, 2) is in the
    way. The nearest ring in the way counts, and the side that is nearer, unless a wall is there.
    """
    way = goal - at
    length = float(np.linalg.norm(way))
    if length < 1e-6 or not len(centres):
        return goal
    ahead = way / length
    along = (centres - at) @ ahead  # (rings,) how far ahead each is
    left = np.array([-ahead[1], ahead[0]])
    beside = (centres - at) @ left  # (rings,) how far to the left
    berths = radii + BERTH
    is_goal = np.linalg.norm(centres - goal, axis=1) < berths  # the goal is in there
    is_in_way = (along > 0) & (along < length) & (np.abs(beside) < berths) & ~is_goal
    if not is_in_way.any():
        return goal
    nearest = int(np.where(is_in_way, along, np.inf).argmin())
    side = -1.0 if beside[nearest] > 0 else 1.0
    points = [centres[nearest] + s * AMPLE * berths[nearest] * left for s in (side, -side)]
    inside = [point for point in points if fits(point)]
    return inside[0] if inside else goal
