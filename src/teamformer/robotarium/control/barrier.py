"""The safety filter: the velocities nearest to the wanted ones that keep all robots apart.

Control barrier functions for points ahead of the wheels (Wilson et al., "The Robotarium", IEEE
Control Systems Magazine 2020), all robots in one quadratic programme, as Robotarium's own filter:
the policy is decentralised, this is not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.robots.arena import HEIGHT, WIDTH, points_ahead

POINT = 0.03  # metres: the point ahead of the wheels that is steered

Solver = Callable[[Array, Array, Array], Array | None]
"""From wanted x, rows A and bounds b, the x nearest to the wanted one with A x <= b, or None."""


@dataclass(frozen=True)
class Safety:
    """How careful the filter is; lengths in metres, speeds in metres a second."""

    apart: float = 0.185  # between the points of two robots: back to back, 0.125 between centres
    in_sight: float = 0.7  # farther pairs are left alone
    from_walls: float = 0.06
    gain: float = 3.0  # of the barriers, 1/s
    speed: float = 0.199  # |v| + half_base |w| at most
    half_base: float = 0.055


class Barrier:
    """Filters the velocities of some robots with a solver."""

    def __init__(self, robots: int, solve: Solver) -> None:
        self._solve, self._safety = solve, Safety()
        self._first, self._second = np.triu_indices(robots, 1)
        self._limits = _speed_rows(robots, self._safety)  # (4 robots, 2 robots)

    def filter(self, poses: Array, wanted: Array, weight: Array | None = None) -> Array:
        """Return safe velocities (robots, 2) of v and w.

        `poses` is (robots, 3); `wanted` (robots, 2) are velocities of the points ahead, in x and y.
        `weight` (robots,) says how much each robot's wish counts: one that counts less gives way.
        """
        turned = _turns(poses[:, 2])  # (robots, 2, 2), from a robot's frame to the arena's
        own = np.einsum("rij,ri->rj", turned, wanted).ravel()  # (2 robots,)
        scale = np.ones(len(own)) if weight is None else np.sqrt(weight).repeat(2)
        points = points_ahead(poses, POINT)
        pair_rows, pair_bounds = self._pairs(points, turned)
        wall_rows, wall_bounds = self._walls(points, turned)
        rows = np.concatenate((pair_rows, wall_rows, self._limits)) / scale
        limits = np.full(len(self._limits), self._safety.speed)
        bounds = np.concatenate((pair_bounds, wall_bounds, limits))
        safe = self._solve(own * scale, rows, bounds)
        if safe is None:  # somebody is too near already: at least come no nearer
            safe = self._solve(own * scale, rows, np.maximum(bounds, 0.0))
        found = np.zeros_like(own) if safe is None else safe / scale
        return found.reshape(-1, 2) / (1.0, POINT)

    def _pairs(self, points: Array, turned: Array) -> tuple[Array, Array]:
        """Return a row for each pair in sight: how fast they may come nearer."""
        between = points[self._first] - points[self._second]  # (pairs, 2)
        distance = np.linalg.norm(between, axis=1)
        near = np.flatnonzero(distance < self._safety.in_sight)
        towards = between[near] / np.maximum(distance[near, None], 1e-6)  # (near, 2)
        first, second = self._first[near], self._second[near]
        rows = np.zeros((len(near), len(points), 2))
        every = np.arange(len(near))
        rows[every, first] = -np.einsum("pi,pij->pj", towards, turned[first])
        rows[every, second] = np.einsum("pi,pij->pj", towards, turned[second])
        bounds = self._safety.gain * (distance[near] - self._safety.apart)
        return rows.reshape(len(near), 2 * len(points)), bounds

    def _walls(self, points: Array, turned: Array) -> tuple[Array, Array]:
        """Return four rows for each robot: how fast its point may near each wall."""
        limit = np.array([WIDTH, HEIGHT]) / 2 - self._safety.from_walls
        robots = len(points)
        rows = np.zeros((2, 2, robots, robots, 2))  # side, axis, robot, robot, velocity
        every = np.arange(robots)
        for side, sign in enumerate((1.0, -1.0)):
            for axis in range(2):
                rows[side, axis, every, every] = sign * turned[:, axis]
        room = np.stack([limit - points, limit + points]).transpose(0, 2, 1)  # side, axis, robot
        return rows.reshape(4 * robots, -1), self._safety.gain * room.ravel()


def _turns(heading: Array) -> Array:
    cos, sin = np.cos(heading), np.sin(heading)
    return np.stack((np.stack((cos, -sin), axis=1), np.stack((sin, cos), axis=1)), axis=1)


def _speed_rows(robots: int, safety: Safety) -> Array:
    """Return the rows of |v| + half_base |w| <= speed, where POINT w is the second variable."""
    corners = np.array([[v, w * safety.half_base / POINT] for v in (1, -1) for w in (1, -1)])
    return np.kron(np.eye(robots), corners)
