"""Bounds on sets of paths, against every set of paths there is."""

from __future__ import annotations

from itertools import pairwise, permutations, product

import numpy as np
import pytest

from teamformer.base.array_types import Floats
from teamformer.planning.bounds.open_paths import bound_paths, span


def draw_places(rng: np.random.Generator, count: int) -> tuple[Floats, Floats]:
    """Return the legs between places on a grid, and the ways to them from one cell."""
    places = rng.integers(0, 9, (count + 1, 2))
    apart = np.abs(places[:, None] - places).sum(axis=2).astype(np.float64)
    return apart[1:, 1:], apart[0, 1:]


def best_order(legs: Floats, ready: Floats, places: tuple[int, ...]) -> float:
    """Return the length of the shortest path through some places."""
    return min(
        ready[order[0]] + sum(legs[i, j] for i, j in pairwise(order))
        for order in permutations(places)
    )


def shortest_paths(legs: Floats, ready: Floats, paths: int) -> float:
    """Return the least total length of so many paths through all places."""
    best = np.inf
    for owner in product(range(paths), repeat=len(ready)):
        groups = [tuple(k for k, one in enumerate(owner) if one == p) for p in range(paths)]
        if all(groups):
            best = min(best, sum(best_order(legs, ready, group) for group in groups))
    return best


@pytest.mark.parametrize("seed", range(10))
def test_no_set_of_paths_is_shorter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for count in (1, 3, 5, 5):
        legs, ready = draw_places(rng, count)
        most = min(3, count)
        bounds = bound_paths(legs, ready, most, rounds=100)
        exact = np.array([shortest_paths(legs, ready, paths) for paths in range(1, most + 1)])
        assert (bounds <= exact + 1e-6).all()
        assert bounds[most - 1] >= 0.8 * exact[most - 1]


def test_one_path_is_bounded_closely() -> None:
    rng = np.random.default_rng(0)
    ratios = []
    for _ in range(30):
        legs, ready = draw_places(rng, 7)
        exact = best_order(legs, ready, tuple(range(7)))
        ratios.append(bound_paths(legs, ready, 1, rounds=100)[0] / exact)
    assert max(ratios) <= 1 + 1e-9
    assert np.mean(ratios) > 0.99


def test_the_tree_spans_by_the_shortest_legs() -> None:
    """Places at 2, 3 and 9 on a line from 0: the tree is the line."""
    at = np.array([2.0, 3.0, 9.0])
    assert span(np.abs(at[:, None] - at), at) == 9.0
