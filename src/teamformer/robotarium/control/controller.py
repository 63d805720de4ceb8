"""Drives robots to their goals: straight there, safely, and around whoever blocks the way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.control.barrier import POINT, Barrier, Solver
from teamformer.robotarium.robots.arena import points_ahead


@dataclass(frozen=True)
class Steering:
    """How robots head for their goals."""

    speed: float = 0.13  # metres a second, at most
    gain: float = 2.0  # 1/s: speed falls with what is left to go
    slow: float = 0.3  # of the wanted speed: slower than this is stalled
    at_rest: float = 0.03  # metres to go: nearer than this nobody is stalled
    patience: int = 10  # ticks of stalling until the robot turns aside
    long_patience: int = 60  # ticks until it turns to the other side
    forgets: int = 120  # ticks until it begins again
    aside: float = np.pi / 3
    idle_weight: float = 0.1  # of the wishes of robots without a slot, who give way to others


class Controller:
    """Turns measured poses and goals into safe velocities, tick by tick."""

    def __init__(self, robots: int, solve: Solver, steering: Steering | None = None) -> None:
        self._steering = steering or Steering()
        self._barrier = Barrier(robots, solve)
        self._stalled = np.zeros(robots, dtype=np.int64)  # ticks

    def steer(self, poses: Array, goals: Array, is_idle: Array) -> Array:
        """Return velocities (robots, 2) for poses (robots, 3) and goals (robots, 2).

        Robots that are idle (robots,) give way to the others.
        """
        steering, points = self._steering, points_ahead(poses, POINT)
        way = goals - points
        to_go = np.linalg.norm(way, axis=1)
        fraction = np.minimum(steering.speed / np.maximum(to_go, 1e-9), steering.gain)
        wanted = turn(way * fraction[:, None], self._detours())
        weight = np.where(is_idle, steering.idle_weight, 1.0)
        velocities = self._barrier.filter(poses, wanted, weight)
        made = np.linalg.norm(velocities * (1.0, POINT), axis=1)
        is_slow = made < steering.slow * np.linalg.norm(wanted, axis=1)
        self._count(is_slow & (to_go > steering.at_rest))
        return velocities

    def _detours(self) -> Array:
        """Return the angle by which each robot turns aside, as (robots,)."""
        ticks, steering = self._stalled, self._steering
        is_first, is_second = ticks >= steering.patience, ticks >= steering.long_patience
        angle: Array = np.where(is_second, -steering.aside, is_first * steering.aside)
        return angle

    def _count(self, is_stalled: Array) -> None:
        """Count stalling up, and down again while a robot gets on."""
        steps = np.where(is_stalled, 1, -1)
        self._stalled = np.maximum(self._stalled + steps, 0)
        self._stalled[self._stalled >= self._steering.forgets] = 0


def turn(vectors: Array, angles: Array) -> Array:
    """Return vectors (n, 2) turned to the left by angles (n,) in radians."""
    cos, sin = np.cos(angles), np.sin(angles)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack((cos * x - sin * y, sin * x + cos * y), axis=1)
