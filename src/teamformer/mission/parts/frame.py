"""Where a grid lies: its cells in the metres of the map that it was made from."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True)
class Frame:
    """A grid's place in a map's frame, as ROS map_server has it.

    `cell` is the side of a cell in metres; (`x`, `y`) in metres is the lower left corner of the
    cell [0, 0], and `yaw` in radians how far the grid is turned about it, counterclockwise.
    """

    cell: float
    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def point(self, place: tuple[float, float]) -> tuple[float, float]:
        """Return the middle of a cell in metres of the map's frame."""
        along, up = ((number + 0.5) * self.cell for number in place)
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + cos * along - sin * up, self.y + sin * along + cos * up

    def place(self, point: tuple[float, float]) -> tuple[float, float]:
        """Return where metres of the map's frame are among cells: whole numbers at the middles."""
        x, y = point[0] - self.x, point[1] - self.y
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        return (cos * x + sin * y) / self.cell - 0.5, (cos * y - sin * x) / self.cell - 0.5

    def problems(self) -> Iterator[str]:
        """Return what is wrong with the frame."""
        if not 0 < self.cell < math.inf:
            yield f"a cell of the map is {self.cell:g} m wide; use more than 0"
        if not all(map(math.isfinite, (self.x, self.y, self.yaw))):
            yield f"the map's origin is [{self.x:g}, {self.y:g}, {self.yaw:g}]; use numbers"
