"""Ways: how long they are, and where one is after some of the way.

On a grid lengths are cells, on a plane whole micrometres, so that equal ones are equal.
"""

from __future__ import annotations

import math

from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import DECIMALS, Plane

UNREACHABLE = 2**30
"""The length of a way where there is none."""

ROUNDING = 1e-9
"""Speeds are binary fractions: ten steps at 0.1 must make one cell."""

MICROMETRES = 10.0**DECIMALS
MOST_FLOODS = 4096
"""Goals to which ways are kept; partners are goals that move."""


def apart(one: Place, other: Place) -> float:
    """Return how far two places are apart, straight on."""
    return math.sqrt(apart_squared(one, other))


def apart_squared(one: Place, other: Place) -> float:
    """Return the square of how far two places are apart, straight on."""
    away_x, away_y = one[0] - other[0], one[1] - other[1]
    return away_x * away_x + away_y * away_y


def micrometres(one: Place, other: Place) -> int:
    """Return how many millionths two places are apart, straight on."""
    return round(apart(one, other) * MICROMETRES)


def cells(one: Place, other: Place) -> int:
    """Return how many cells two places are apart where nothing is in the way."""
    return int(abs(one[0] - other[0]) + abs(one[1] - other[1]))


class PlainWays:
    """The shortest ways of a world, each worked out only as far as somebody asks."""

    def __init__(self, world: Grid | Plane) -> None:
        self._world = world
        self._floods: dict[Place, _Flood] = {}
        self._map = _Map(world) if isinstance(world, Grid) and world.rows else None

    def length(self, start: Place, goal: Place, flies: bool) -> int:
        """Return the length of the way to a goal; UNREACHABLE if walls leave none."""
        if isinstance(self._world, Plane):
            return micrometres(start, goal)
        if flies or self._map is None:
            return cells(start, goal)
        return self._flood(goal, self._map).length_from(start)

    def after_cells(self, place: Place, goal: Place, count: int, flies: bool) -> Place:
        """Return the cell in which one is after so many of the cells to a goal, at most all.

        Of shortest ways it is the one that goes first along the axis with more left to go, along x
        if both are equal, and towards larger coordinates if walls leave both sides open.
        """
        straight = flies or self._map is None
        for _ in range(count):
            is_along_x = abs(goal[0] - place[0]) >= abs(goal[1] - place[1])
            if straight:
                place = _straight_on(place, goal, is_along_x)
            else:
                assert self._map is not None
                place = self._flood(goal, self._map).next_cell(place, is_along_x)
        return place

    def _flood(self, goal: Place, world: _Map) -> _Flood:
        if goal not in self._floods:
            if len(self._floods) == MOST_FLOODS:
                del self._floods[next(iter(self._floods))]
            self._floods[goal] = _Flood(world, goal)
        return self._floods[goal]


def _straight_on(place: Place, goal: Place, is_along_x: bool) -> Place:
    (x, y), (goal_x, goal_y) = place, goal
    if is_along_x:
        return x + (1 if goal_x > x else -1), y
    return x, y + (1 if goal_y > y else -1)


def after_metres(place: Place, goal: Place, length: float) -> Place:
    """Return the point of a plane, to a micrometre, after so much of the way to a goal."""
    to_go, (x, y) = apart(place, goal), place
    if to_go <= length + ROUNDING:
        return goal
    x, y = x + (goal[0] - x) * length / to_go, y + (goal[1] - y) * length / to_go
    return round(x * MICROMETRES) / MICROMETRES, round(y * MICROMETRES) / MICROMETRES


class _Map:
    """The free cells of a grid, one row after the other, within a border of obstacles."""

    def __init__(self, grid: Grid) -> None:
        self.width = grid.width + 2
        edge = [False] * self.width
        rows = ([False, *(grid.is_free((x, y)) for x in range(grid.width)), False]
                for y in range(grid.height))  # fmt: skip
        self.is_free = bytes([*edge, *(cell for row in rows for cell in row), *edge])

    def number(self, place: Place) -> int:
        return (int(place[1]) + 1) * self.width + int(place[0]) + 1

    def place(self, number: int) -> Place:
        row, column = divmod(number, self.width)
        return column - 1, row - 1


class _Flood:
    """The cells around a goal, ring by ring; none around a goal over an obstacle."""

    def __init__(self, world: _Map, goal: Place) -> None:
        self._map = world
        begin = world.number(goal)
        self._ring = [begin] if world.is_free[begin] else []
        self._lengths = dict.fromkeys(self._ring, 0)
        self._rings = 0

    def length_from(self, place: Place) -> int:
        cell = self._map.number(place)
        while cell not in self._lengths and self._ring:
            self._grow()
        return self._lengths.get(cell, UNREACHABLE)

    def next_cell(self, place: Place, is_along_x: bool) -> Place:
        cell, width = self._map.number(place), self._map.width
        nearer = self.length_from(place) - 1
        sides = (1, -1, width, -width) if is_along_x else (width, -width, 1, -1)
        return self._map.place(
            next(cell + side for side in sides if self._lengths.get(cell + side) == nearer)
        )

    def _grow(self) -> None:
        lengths, is_free, width = self._lengths, self._map.is_free, self._map.width
        self._rings += 1
        ring = []
        for cell in self._ring:
            for beside in (cell + 1, cell - 1, cell + width, cell - width):
                if is_free[beside] and beside not in lengths:
                    lengths[beside] = self._rings
                    ring.append(beside)
        self._ring = ring
