"""What Robotarium is: its arena, its robots, and what makes it reject an experiment.

The figures are those of its official Python simulator, version 2.1. Coordinates begin in the
middle of the arena here, and in its lower left corner in missions.
"""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array

WIDTH, HEIGHT = 3.2, 2.0  # metres
MOST_ROBOTS = 20
LONGEST = 900.0  # seconds

TICK = 0.033  # seconds
DIAMETER = 0.11  # metres, of a robot
TOP_SPEED = 0.2  # metres a second
TOP_TURN = 3.64  # radians a second
TOP_WHEEL = 12.5  # radians a second
WHEEL_RADIUS = 0.016  # metres
WHEEL_BASE = 0.11  # metres between the wheels

LOOK_AHEAD = 0.025  # metres: collisions are judged between points so far ahead of the centres
COLLISION = 0.135  # metres: nearer than this, two such points have collided

MIDDLE = np.array([WIDTH / 2, HEIGHT / 2])
"""The middle of the arena in a mission's coordinates."""


def points_ahead(poses: Array, distance: float) -> Array:
    """Return the points so many metres ahead of robots at poses (robots, 3), as (robots, 2)."""
    towards = np.stack((np.cos(poses[:, 2]), np.sin(poses[:, 2])), axis=1)  # (robots, 2)
    ahead: Array = poses[:, :2] + distance * towards
    return ahead


def separations(points: Array) -> Array:
    """Return the distances between all points (robots, 2); to itself each is infinitely far."""
    apart: Array = np.linalg.norm(points[:, None] - points[None], axis=2)  # (robots, robots)
    np.fill_diagonal(apart, np.inf)
    return apart


def wheel_speeds(velocities: Array) -> Array:
    """Return the turning rates of left and right wheels for velocities (robots, 2) of v and w."""
    turn = velocities[:, 1:] * (WHEEL_BASE / 2) * np.array([-1.0, 1.0])  # (robots, 2)
    speeds: Array = (velocities[:, :1] + turn) / WHEEL_RADIUS
    return speeds
