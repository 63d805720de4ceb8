"""Walking distances against a plain search."""

from __future__ import annotations

import numpy as np

from random_worlds import random_world
from teamformer.mission.parts.grid import Grid
from teamformer.world.reference.ways import PlainWays
from teamformer.world.rules.distances import (
    UNREACHABLE,
    blocked_cells,
    distance_fields,
    travel_matrix,
)

HOOK = Grid(4, 3, ("...@", ".@@.", "...."))
"""
. . . @
. @ @ .
. . . .
"""


def test_way_around_a_wall() -> None:
    [field] = distance_fields(HOOK, [(2, 0)])
    far = int(UNREACHABLE)
    assert field.tolist() == [[2, 1, 0, far], [3, far, far, 8], [4, 5, 6, 7]]


def test_blocked_cells_are_those_drawn() -> None:
    assert np.argwhere(blocked_cells(HOOK)).tolist() == [[0, 3], [1, 1], [1, 2]]
    assert not blocked_cells(Grid(3, 2)).any()
    assert blocked_cells(Grid(3, 2)).shape == (2, 3)


def test_matrix_without_walls_is_manhattan() -> None:
    matrix = travel_matrix(Grid(9, 9), [(0, 0), (4, 4)], [(1, 2), (8, 0), (4, 4)])
    assert matrix.tolist() == [[3, 8, 8], [5, 8, 0]]


def test_matrix_is_unreachable_across_a_closed_wall() -> None:
    grid = Grid(3, 1, (".@.",))
    assert travel_matrix(grid, [(0, 0), (2, 0)], [(2, 0)]).tolist() == [[UNREACHABLE], [0]]


def test_matrix_may_be_empty() -> None:
    assert travel_matrix(Grid(3, 3), [(0, 0)], []).shape == (1, 0)
    assert travel_matrix(HOOK, [], [(0, 0)]).shape == (0, 1)


def test_fields_and_matrix_are_what_a_plain_search_finds() -> None:
    rng = np.random.default_rng(0)
    for _ in range(60):
        grid = random_world(rng).world
        cells = [(x, y) for y in range(grid.height) for x in range(grid.width)]
        free = [cell for cell in cells if grid.is_free(cell)]
        goals = [free[i] for i in rng.integers(len(free), size=3)]
        ways = PlainWays(grid)
        expected = [[ways.length(cell, goal, flies=False) for goal in goals] for cell in free]
        assert travel_matrix(grid, free, goals).tolist() == expected
        fields = distance_fields(grid, goals)
        assert [[int(f[y, x]) for f in fields] for x, y in free] == expected
