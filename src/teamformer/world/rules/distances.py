"""How far it is: on a grid by breadth-first distance fields, on a plane straight on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Array, Floats, Int32s
from teamformer.base.kernels.jit import entry, kernel
from teamformer.mission.parts.grid import BLOCKED, Grid, Place

UNREACHABLE = np.int32(2**30)
"""The distance to a place that cannot be reached; sums of a few of them still fit."""


def blocked_cells(grid: Grid) -> npt.NDArray[np.bool_]:
    """Return where the grid is blocked, as (height, width)."""
    if not grid.rows:
        return np.zeros((grid.height, grid.width), dtype=np.bool_)
    return np.array([[cell == BLOCKED for cell in row] for row in grid.rows], dtype=np.bool_)


def distance_fields(grid: Grid, places: Sequence[Place]) -> Int32s:
    """Return the walking distance from every cell to each place, as (places, height, width)."""
    blocked = blocked_cells(grid)
    fields = np.full((len(places), grid.height, grid.width), UNREACHABLE, dtype=np.int32)
    for field, (x, y) in zip(fields, places, strict=True):
        fill_field(blocked, int(x), int(y), field)
    return fields


def travel_matrix(grid: Grid, origins: Sequence[Place], goals: Sequence[Place]) -> Int32s:
    """Return the walking distances in cells, as (origins, goals); UNREACHABLE where no way is.

    Without obstacles they are Manhattan distances.
    """
    from_x, from_y = np.array(origins, dtype=np.int32).reshape(-1, 2).T
    to_x, to_y = np.array(goals, dtype=np.int32).reshape(-1, 2).T
    if not grid.rows:
        away_x = np.abs(from_x[:, None] - to_x)  # (origins, goals)
        manhattan: Int32s = (away_x + np.abs(from_y[:, None] - to_y)).astype(np.int32)
        return manhattan
    distances = np.empty((len(origins), len(goals)), dtype=np.int32)
    blocked = blocked_cells(grid)
    field = np.empty(blocked.shape, dtype=np.int32)
    for goal in range(len(goals)):
        field[:] = UNREACHABLE
        fill_field(blocked, to_x[goal], to_y[goal], field)
        distances[:, goal] = field[from_y, from_x]
    return distances


def longest_straight(origins: Array, goals: Array) -> int:
    """Return the longest Manhattan distance from origins to goals, (places, 2) each."""
    (from_x, from_y), (to_x, to_y) = origins.T, goals.T
    turned = ((from_x + from_y, to_x + to_y), (from_x - from_y, to_x - to_y))
    return max(max(int(a.max() - b.min()), int(b.max() - a.min())) for a, b in turned)


@kernel
def way_between(table: Array, spots: Array, goals: Array, place: int, goal: int) -> int:
    """Return the way from a place to a goal, from a table (goals, places) if that has entries.

    Else it is the Manhattan distance from `spots` (places, 2) to `goals` (goals, 2).
    """
    if len(table) > 0:
        return table[goal, place]
    away_x = abs(goals[goal, 0] - spots[place, 0])
    return away_x + abs(goals[goal, 1] - spots[place, 1])


def straight_ways(origins: Sequence[Place], goals: Sequence[Place]) -> Floats:
    """Return the distances between points of a plane in metres, as (origins, goals)."""
    apart = np.reshape(origins, (-1, 1, 2)) - np.reshape(goals, (1, -1, 2))  # (origins, goals, 2)
    ways: Floats = np.hypot(apart[..., 0], apart[..., 1])
    return ways


@entry
def fill_field(blocked: Array, x: int, y: int, field: Array) -> None:
    """Fill in the distance from each cell to (x, y), breadth first; leave the unreachable."""
    height, width = blocked.shape
    queue = np.empty(height * width, dtype=np.int32)
    queue[0] = y * width + x
    field[y, x] = 0
    head, tail = 0, 1
    while head < tail:
        cell_y, cell_x = divmod(queue[head], width)
        head += 1
        for side in range(4):
            to_x = cell_x + (1 if side == 0 else -1 if side == 1 else 0)
            to_y = cell_y + (1 if side == 2 else -1 if side == 3 else 0)
            if not (0 <= to_x < width and 0 <= to_y < height) or blocked[to_y, to_x]:
                continue
            if field[to_y, to_x] == UNREACHABLE:
                field[to_y, to_x] = field[cell_y, cell_x] + 1
                queue[tail] = to_y * width + to_x
                tail += 1
