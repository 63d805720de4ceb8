"""Ways through a fleet's world: round walls on a grid, straight on in a plane."""

from __future__ import annotations

import math

from teamformer.base.array_types import Int32s
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.world.rules.distances import distance_fields

BLOCKED = 2**29
"""From this distance on there is no way."""


class Ways:
    """The ways of one world; distances to each goal are worked out when it is first asked for."""

    def __init__(self, world: Grid | Plane | Roads) -> None:
        self._world = world
        self._fields: dict[Place, Int32s] = {}

    def cells(self, here: Place, goal: Place) -> list[Place]:
        """Return the cells of a shortest way on a grid, first along the axis with more to go.

        The way on from a cell of it is the rest of it.
        """
        away = self._field(goal)
        cells: list[Place] = []
        height, width = away.shape
        x, y = int(here[0]), int(here[1])
        goal_x, goal_y = int(goal[0]), int(goal[1])
        left = int(away[y, x])
        while 0 < left < BLOCKED:
            along_x, along_y = abs(goal_x - x) >= abs(goal_y - y), (goal_y > y) * 2 - 1
            towards_x = (goal_x > x) * 2 - 1
            sides = [(towards_x, 0), (0, along_y), (0, -along_y), (-towards_x, 0)]
            for dx, dy in sides if along_x else [sides[1], sides[0], sides[3], sides[2]]:
                to_x, to_y = x + dx, y + dy
                if 0 <= to_x < width and 0 <= to_y < height and away[to_y, to_x] == left - 1:
                    x, y, left = to_x, to_y, left - 1
                    cells.append((x, y))
                    break
        return cells

    def next_place(self, here: Place, goal: Place, far: float) -> Place:
        """Return the next cell on the way to a goal; in a plane the place `far` metres on."""
        if isinstance(self._world, Grid):
            return next(iter(self.cells(here, goal)), goal)
        left = math.dist(here, goal)
        if left <= far:
            return goal
        part = far / left
        return here[0] + part * (goal[0] - here[0]), here[1] + part * (goal[1] - here[1])

    def _field(self, goal: Place) -> Int32s:
        if goal not in self._fields:
            assert isinstance(self._world, Grid)
            self._fields[goal] = distance_fields(self._world, [goal])[0]
        return self._fields[goal]
