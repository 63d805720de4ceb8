"""Ways that robots go by: round walls on a grid, straight on in a plane, by a table on roads."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array, Floats, Int32s
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import AIR, GROUND, Roads
from teamformer.world.rules.distances import distance_fields

BLOCKED = 2**29
"""From this distance on there is no way."""

SAME = 1e-9
"""By such a share of a way the sums of its parts may differ from it, as they are rounded."""

Stage = tuple[Place, float]
"""A place on a way, and how far it is from where the way begins."""


class Ways:
    """The ways of one world; distances to each goal are worked out when it is first asked for."""

    def __init__(self, world: Grid | Plane | Roads) -> None:
        self._world = world
        self._fields: dict[Place, Int32s] = {}
        self._tables: dict[str, Floats] = {}

    def stages(self, here: Place, goal: Place, moves: str = GROUND) -> list[Stage]:
        """Return the places after `here` on a way to a goal, each with its distance from `here`.

        Distances are times at speed 1: cells, metres, or what the table of roads says. On roads
        these are all places that the quickest way leads through. Empty if the goal is here.
        """
        if here == goal:
            return []
        if isinstance(self._world, Roads):
            return self._stages_on_roads(here, goal, moves)
        if isinstance(self._world, Plane):
            return [(goal, float(np.hypot(here[0] - goal[0], here[1] - goal[1])))]
        cells = self.cells(here, goal, moves)
        return [(cell, float(number)) for number, cell in enumerate(cells, start=1)]

    def length(self, here: Place, goal: Place, moves: str = GROUND) -> float:
        """Return how far it is to a goal; infinite if no way leads there."""
        if here == goal:
            return 0.0
        if isinstance(self._world, Roads):
            return float(self._table(moves)[int(here[0]), int(goal[0])])
        if isinstance(self._world, Plane):
            return float(np.hypot(here[0] - goal[0], here[1] - goal[1]))
        if self._is_open(moves):
            return float(abs(here[0] - goal[0]) + abs(here[1] - goal[1]))
        left = int(self._field(goal)[int(here[1]), int(here[0])])
        return float(left) if left < BLOCKED else math.inf

    def cells(self, here: Place, goal: Place, moves: str = GROUND) -> list[Place]:
        """Return the cells of a shortest way on a grid, first along the axis with more to go.

        The way on from a cell of it is the rest of it. It is empty if there is none.
        """
        if self._is_open(moves):
            return _straight_cells(here, goal)
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
        return goal if left <= far else part_of_way(here, goal, far / left)

    def _is_open(self, moves: str) -> bool:
        return moves == AIR or not self._world.rows

    def _stages_on_roads(self, here: Place, goal: Place, moves: str) -> list[Stage]:
        """Return the places that lie between two on a way that takes no longer, in order."""
        table, end = self._table(moves), int(goal[0])
        at, length = int(here[0]), float(table[int(here[0]), end])
        away = table[at]  # (places,)
        is_on = _is_equal(away + table[:, end], length)
        is_on[[at, end]] = False
        stages: list[Stage] = []
        for place in sorted(np.flatnonzero(is_on).tolist(), key=lambda one: (away[one], one)):
            rest = table[at, end]
            if _is_equal(table[at, place] + table[place, end], rest):
                stages.append(((place, 0), float(away[place])))
                at = place
        return [*stages, (goal, length)]

    def _table(self, moves: str) -> Floats:
        """Return how long ways on roads take, (places, places)."""
        assert isinstance(self._world, Roads)
        if moves not in self._tables:
            self._tables[moves] = np.array(self._world.ways[moves])
        return self._tables[moves]

    def _field(self, goal: Place) -> Int32s:
        if goal not in self._fields:
            assert isinstance(self._world, Grid)
            self._fields[goal] = distance_fields(self._world, [goal])[0]
        return self._fields[goal]


def way_together(
    ways: Ways, movers: Sequence[tuple[str, float]], here: Place, goal: Place
) -> list[Stage]:
    """Return the places on the way of a load, each with the time there, by the slowest.

    `movers` are how each of those moves who carry it, and its speed. If somebody walks, nobody
    flies over obstacles.
    """
    own = [ways.stages(here, goal, moves) for moves, _ in movers]
    takes = [
        way[-1][1] / speed if way else 0.0 for way, (_, speed) in zip(own, movers, strict=True)
    ]
    walkers = [n for n, (moves, _) in enumerate(movers) if moves != AIR]
    slowest = max(walkers or range(len(movers)), key=takes.__getitem__)
    speed, longest = movers[slowest][1], max(takes)
    stages = [(place, away / speed) for place, away in own[slowest]]
    if takes[slowest] in (0.0, longest):
        return stages
    return [(place, spent * longest / takes[slowest]) for place, spent in stages]


def part_of_way(here: Place, goal: Place, part: float) -> Place:
    """Return the point of a plane after a part of a straight way, 0 to 1."""
    return here[0] + part * (goal[0] - here[0]), here[1] + part * (goal[1] - here[1])


def _is_equal(sums: Array, length: float) -> Array:
    """Say which sums of the parts of ways are as long as the whole."""
    return np.asarray(abs(sums - length) <= SAME * length)


def _straight_cells(here: Place, goal: Place) -> list[Place]:
    (x, y), (goal_x, goal_y), cells = here, goal, list[Place]()
    while (x, y) != (goal_x, goal_y):
        if abs(goal_x - x) >= abs(goal_y - y):
            x += 1 if goal_x > x else -1
        else:
            y += 1 if goal_y > y else -1
        cells.append((x, y))
    return cells
