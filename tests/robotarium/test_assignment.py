"""The assignment against all permutations."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from teamformer.robotarium.control.assignment import assign, match


@pytest.mark.parametrize("n", [1, 2, 3, 5, 6])
def test_it_costs_the_least_of_all(n: int) -> None:
    rng = np.random.default_rng(n)
    for _ in range(20):
        cost = rng.uniform(-1, 1, (n, n))
        columns = assign(cost)
        assert sorted(columns.tolist()) == list(range(n))
        best = min(sum(cost[r, c] for r, c in enumerate(p)) for p in permutations(range(n)))
        assert cost[np.arange(n), columns].sum() == pytest.approx(best)


def test_nobody_passes_through_the_others() -> None:
    """Three in a row move up by one: the last does not overtake, though that is as far."""
    places = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    slots = np.array([[3.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    np.testing.assert_allclose(match(places, slots), places + np.array([1.0, 0.0]))
