"""A continuous world: a rectangle in metres without obstacles, in which ways are straight."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

LONGEST_SIDE = 100_000  # metres
SHORTEST_STEP, LONGEST_STEP = 0.01, 1000  # seconds
SHORTEST_UNIT = 0.001  # metres

DECIMALS = 6
"""Places are kept to a micrometre, so that records are short and exact."""


@dataclass(frozen=True)
class Plane:
    """A rectangle from (0, 0) to (`width`, `height`), both in metres.

    `step` is the length of a step in seconds. Two teams, or a team and a task, are in the same
    place if they are at most `arrival_radius` metres apart. `unit` is the length in metres that a
    policy trained on grids takes for one cell (0.20 m suits robots of a hand's width).
    """

    width: float
    height: float
    step: float = 1.0
    arrival_radius: float = 0.05
    unit: float = 0.20

    rows: ClassVar[tuple[str, ...]] = ()  # nothing is blocked
    y_axis: ClassVar[str] = "up"

    @property
    def corner(self) -> tuple[float, float]:
        """Return the place with the largest coordinates."""
        return self.width, self.height

    def is_inside(self, place: tuple[float, float]) -> bool:
        """Say whether a place is in the rectangle, edges included."""
        x, y = place
        return 0 <= x <= self.width and 0 <= y <= self.height

    def is_free(self, place: tuple[float, float]) -> bool:
        """Say whether a robot can be at a place."""
        return self.is_inside(place)

    def region(self, place: tuple[float, float]) -> int:
        """Return the number of the connected part that a place lies in: always 0."""
        return 0

    def pace(self, speed: float) -> float:
        """Return how many metres a robot with this speed walks in a step."""
        return speed * self.step

    def problems(self) -> Iterator[str]:
        """Return what is wrong with the plane itself."""
        for side in (self.width, self.height):
            if not 0 < side <= LONGEST_SIDE:
                most = f"use more than 0 and up to {LONGEST_SIDE:,}"
                yield f"a side of the plane is {side:g} m; {most}"
        if not SHORTEST_STEP <= self.step <= LONGEST_STEP:
            yield f"the step is {self.step:g} s; use {SHORTEST_STEP} to {LONGEST_STEP}"
        if not 0 <= self.arrival_radius <= LONGEST_SIDE:
            yield f"the arrival radius is {self.arrival_radius:g} m; use 0 or more"
        if not SHORTEST_UNIT <= self.unit <= LONGEST_SIDE:
            yield f"the unit is {self.unit:g} m; use {SHORTEST_UNIT} or more"
