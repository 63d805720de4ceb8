"""A simulated Robotarium: unicycles that move as told, late and blurred if wanted, and a count
of everything that would make the real one reject the experiment."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.robots.arena import (
    COLLISION,
    DIAMETER,
    HEIGHT,
    LOOK_AHEAD,
    TICK,
    TOP_SPEED,
    TOP_TURN,
    TOP_WHEEL,
    WIDTH,
    points_ahead,
    separations,
    wheel_speeds,
)

ROUNDING = 1e-9


class Robots(Protocol):
    """What a controller drives: look where the robots are, then drive them for a tick."""

    def poses(self) -> Array:
        """Return the measured poses (robots, 3): x and y in metres, heading in radians."""

    def drive(self, velocities: Array) -> None:
        """Move for a tick at velocities (robots, 2): metres and radians a second."""


@dataclass(frozen=True)
class Violations:
    """How often rules were broken, in robots (for collisions pairs) times ticks.

    `min_separation` is how near the centres of two robots came, in metres.
    """

    collisions: int = 0
    boundary_violations: int = 0
    actuator_violations: int = 0
    min_separation: float = float("inf")

    @property
    def is_clean(self) -> bool:
        """Say whether Robotarium would accept the experiment."""
        return not (self.collisions or self.boundary_violations or self.actuator_violations)

    def after(self, poses: Array, velocities: Array) -> Violations:
        """Return the count with one tick more, in which robots at poses are told velocities."""
        ahead = separations(points_ahead(poses, LOOK_AHEAD))  # (robots, robots)
        centres = separations(poses[:, :2])  # (robots, robots)
        has_collided = (ahead < COLLISION) | (centres <= DIAMETER)
        is_outside = (np.abs(poses[:, :2]) > (WIDTH / 2, HEIGHT / 2)).any(axis=1)
        is_too_fast = (np.abs(velocities) > np.array([TOP_SPEED, TOP_TURN]) + ROUNDING).any(axis=1)
        is_too_fast |= (np.abs(wheel_speeds(velocities)) > TOP_WHEEL + ROUNDING).any(axis=1)
        return replace(
            self,
            collisions=self.collisions + int(has_collided.sum()) // 2,
            boundary_violations=self.boundary_violations + int(is_outside.sum()),
            actuator_violations=self.actuator_violations + int(is_too_fast.sum()),
            min_separation=min(self.min_separation, float(centres.min())),
        )


@dataclass(frozen=True)
class Weather:
    """What keeps robots from doing at once exactly what they are told: nothing by default."""

    delay: float = 0.0  # seconds until a velocity takes effect, in whole ticks
    blur: float = 0.0  # metres, standard deviation of measured places
    turn_blur: float = 0.0  # radians, of measured headings


class Plant:
    """Robots that move as unicycles; `faults` counts what they did wrong."""

    def __init__(self, poses: Array, weather: Weather | None = None, seed: int = 0) -> None:
        self._poses = np.array(poses, dtype=float)  # (robots, 3)
        self._weather = weather or Weather()
        self._rng = np.random.default_rng(seed)
        still = np.zeros((len(poses), 2))
        ticks = round(self._weather.delay / TICK)
        self._under_way = deque([still] * ticks)
        self.faults = Violations()

    @property
    def true_poses(self) -> Array:
        """Return where the robots are, as (robots, 3)."""
        return self._poses.copy()

    def poses(self) -> Array:
        """Return where the robots seem to be, as (robots, 3)."""
        blur = (self._weather.blur, self._weather.blur, self._weather.turn_blur)
        if not any(blur):
            return self._poses.copy()
        measured: Array = self._poses + self._rng.normal(size=self._poses.shape) * blur
        return measured

    def drive(self, velocities: Array) -> None:
        """Move for a tick at the velocities (robots, 2) that are due."""
        self._under_way.append(np.array(velocities, dtype=float))
        due = self._under_way.popleft()
        self.faults = self.faults.after(self._poses, due)
        self._poses = advance(self._poses, due)


def advance(poses: Array, velocities: Array) -> Array:
    """Return poses (robots, 3) a tick later at velocities (robots, 2): one Euler step."""
    v, turn, heading = velocities[:, 0], velocities[:, 1], poses[:, 2]
    change = np.stack((v * np.cos(heading), v * np.sin(heading), turn), axis=1)  # (robots, 3)
    moved: Array = poses + TICK * change
    moved[:, 2] = np.arctan2(np.sin(moved[:, 2]), np.cos(moved[:, 2]))
    return moved
