"""Connected parts of maps: by hand, and against walking through them."""

from __future__ import annotations

import numpy as np
import pytest

from small_worlds import reachable
from teamformer.mission.parts import regions as module
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid
from teamformer.mission.parts.regions import find_regions, flood


def test_two_parts_and_a_pocket() -> None:
    rows = (
        "..@..",
        ".@@@.",
        "..@..",
        "@.@@@",
    )
    regions = find_regions(rows, FREE)
    assert regions.number(0, 0) == regions.number(1, 3) == 0
    assert regions.number(3, 0) == regions.number(4, 1) == regions.number(3, 2)
    assert regions.number(3, 0) != 0
    assert regions.largest() == 0  # 6 cells against 5
    assert list(regions.cells(0)) == [(0, 0), (1, 0), (0, 1), (0, 2), (1, 2), (1, 3)]


def test_a_map_without_free_cells() -> None:
    regions = find_regions(("@@", "@@"), FREE)
    assert regions.largest() == -1
    assert list(regions.cells(-1)) == []


@pytest.mark.parametrize("seed", range(30))
def test_parts_are_what_can_be_walked_to(seed: int) -> None:
    rng = np.random.default_rng(seed)
    height, width = rng.integers(1, 12, size=2).tolist()
    is_blocked = rng.random((height, width)) < rng.uniform(0.1, 0.7)
    rows = tuple("".join(BLOCKED if cell else FREE for cell in row) for row in is_blocked)
    grid = Grid(width, height, rows)
    free = [(x, y) for y in range(height) for x in range(width) if grid.is_free((x, y))]
    for place in free:
        walked = reachable(grid, place)
        assert walked == {there for there in free if grid.region(there) == grid.region(place)}
        assert walked == set(grid.regions.cells(grid.region(place)))


def walk(grid: Grid, begins: list[tuple[int, int]]) -> int:
    """Return how many steps a flood takes, cell by cell."""
    reached, steps = set(begins), -1
    front = reached
    while front:
        reached = reached | front
        front = {beside for cell in front for beside in grid.neighbours(cell)} - reached
        steps += 1
    return steps


@pytest.mark.parametrize("seed", range(30))
def test_a_flood_takes_as_long_as_walking_does(seed: int) -> None:
    rng = np.random.default_rng(seed)
    height, width = rng.integers(1, 12, size=2).tolist()
    is_blocked = rng.random((height, width)) < rng.uniform(0.0, 0.5)
    is_blocked[0, 0] = is_blocked[-1, -1] = False
    rows = tuple("".join(BLOCKED if cell else FREE for cell in row) for row in is_blocked)
    for begins in ([(0, 0)], [(width - 1, height - 1)], [(0, 0), (width - 1, height - 1)]):
        assert flood(rows, FREE, begins) == walk(Grid(width, height, rows), begins)


def test_a_map_too_large_to_flood_gets_an_upper_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = ("....",) * 3
    assert flood(rows, FREE, [(0, 0)]) == 5
    monkeypatch.setattr(module, "MOST_FLOODING", 1)  # stops with 3 of 12 cells reached
    assert flood(rows, FREE, [(0, 0)]) == 1 + 9
