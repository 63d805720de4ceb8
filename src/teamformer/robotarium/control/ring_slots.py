"""Where the robots of a team stand: on a ring around its task."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.robots.arena import HEIGHT, WIDTH

SPACING = 0.23  # metres between neighbours
FROM_WALLS = 0.12  # metres from a slot to a wall


def ring_radius(robots: int) -> float:
    """Return the radius in metres of the ring on which so many neighbours are SPACING apart."""
    return 0.0 if robots == 1 else float(SPACING / (2 * np.sin(np.pi / robots)))


def slots_around(centre: Array, robots: int) -> Array:
    """Return (robots, 2) slots on a ring around a centre (2,)."""
    angle = 2 * np.pi * np.arange(robots) / robots
    around = np.stack((np.cos(angle), np.sin(angle)), axis=1)
    ring: Array = centre + ring_radius(robots) * around
    return ring


def fits(points: Array) -> Array:
    """Return which points (n, 2) are far enough from the walls, as (n,)."""
    limit = np.array([WIDTH, HEIGHT]) / 2 - FROM_WALLS
    return np.asarray((np.abs(points) <= limit + 1e-9).all(axis=-1))
