"""Ways around the rings at which others stand: straight ones would press against them."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.control.ring_slots import fits

BERTH = 0.24  # metres outside a ring that passing robots keep
AMPLE = 1.15  # of it: where they head for, so that the ring is out of the way once they are there
NARROW = 0.19  # metres outside two rings at least, where a robot can pass between them
BEYOND = 0.25  # metres behind the middle between two rings: where robots head for that pass there


def way_point(at: Array, goal: Array, centres: Array, radii: Array) -> Array:
    """Return where to head for from a place (2,) to reach a goal (2,): a point beside a ring.

    It is the goal itself where no ring of `radii` (rings,) around `centres` (rings, 2) is in the
    way. The nearest ring in the way counts, and the side that is nearer, unless a wall is there or
    another ring so near that nobody can pass; a robot that can passes midway between the two.
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
    points: list[Array] = [
        centres[nearest] + s * AMPLE * berths[nearest] * left for s in (side, -side)
    ]
    inside = [point for point in points if fits(point)]
    for point in inside:
        is_near = (np.linalg.norm(centres - point, axis=1) < berths) & ~is_goal
        is_near[nearest] = False
        if not is_near.any():
            return point
        two = [nearest, int(is_near.argmax())]
        between = _between(centres[two], radii[two], ahead)
        if between is not None:
            return between
    return inside[0] if inside else goal


def _between(centres: Array, radii: Array, ahead: Array) -> Array | None:
    """Return a point behind the middle between two rings; None if they are too near each other."""
    across = centres[1] - centres[0]
    length = float(np.linalg.norm(across))
    gap = length - radii.sum()
    if gap < 2 * NARROW:
        return None
    across = across / length
    through = np.array([-across[1], across[0]])
    forth = 1.0 if through @ ahead >= 0 else -1.0
    point: Array = centres[0] + (radii[0] + gap / 2) * across + forth * BEYOND * through
    return point
