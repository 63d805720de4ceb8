"""A map of cells, each free or blocked."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

from teamformer.mission.parts.frame import Frame
from teamformer.mission.parts.regions import Regions, find_regions

Place = tuple[float, float]
"""A cell of a grid, two whole numbers, or a point of a plane in metres: `(x, y)`."""

LARGEST_MAP = 4_200_000
"""Cells: 2048 x 2048."""

MOST_NEAR = 100
"""Cells along an axis: where a free cell is looked for."""

FREE = "."
BLOCKED = "@"


@dataclass(frozen=True)
class Grid:
    """A 4-connected map of cells; one cell is one unit and takes one step at speed 1.

    `rows[y][x]` is `FREE` or `BLOCKED`; no rows at all means that nothing is blocked. `y_axis`
    says only which way a drawing turns the map, never what a coordinate means.
    """

    width: int
    height: int
    rows: tuple[str, ...] = ()
    y_axis: Literal["up", "down"] = "up"
    frame: Frame | None = None  # where a map that others have made has it

    @property
    def corner(self) -> Place:
        """Return the place with the largest coordinates."""
        return self.width - 1, self.height - 1

    def pace(self, speed: float) -> float:
        """Return the cells that a robot of so many cells a step walks in a step."""
        return speed

    def is_inside(self, place: Place) -> bool:
        """Say whether a place is on the map at all."""
        x, y = place
        return 0 <= x < self.width and 0 <= y < self.height

    def is_free(self, place: Place) -> bool:
        """Say whether a robot can be at a place."""
        if not self.is_inside(place):
            return False
        return not self.rows or self.rows[int(place[1])][int(place[0])] == FREE

    def nearest_free(self, place: Place) -> Place | None:
        """Return the nearest free cell, or None if none within `MOST_NEAR` cells is free."""
        x, y = place
        found: list[tuple[float, Place]] = []  # with its distance, squared
        for reach in range(MOST_NEAR + 1):
            if found and min(found)[0] <= reach * reach:
                break
            for beside in _ring(place, reach):
                if self.is_free(beside):
                    found.append(((beside[0] - x) ** 2 + (beside[1] - y) ** 2, beside))
        return min(found)[1] if found else None

    def neighbours(self, place: Place) -> Iterator[Place]:
        """Return the free cells that one step leads to."""
        x, y = place
        for beside in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
            if self.is_free(beside):
                yield beside

    @cached_property
    def regions(self) -> Regions:
        """Return the connected parts of a map that has rows."""
        return find_regions(self.rows, FREE)

    def region(self, place: Place) -> int:
        """Return the connected part that a free place lies in; without obstacles there is one."""
        return self.regions.number(int(place[0]), int(place[1])) if self.rows else 0


def _ring(middle: Place, reach: int) -> Iterator[Place]:
    """Yield the cells that are `reach` away along one axis, and no farther along the other."""
    x, y = middle
    for along in range(-reach, reach + 1):
        yield from {(x + along, y - reach), (x + along, y + reach)}
        yield from {(x - reach, y + along), (x + reach, y + along)}
