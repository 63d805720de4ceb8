"""Who takes which slot, against all permutations."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from teamformer.robotarium.control.assignment import match


@pytest.mark.parametrize("n", [1, 2, 3, 5, 6])
def test_the_squares_of_the_ways_add_up_to_the_least(n: int) -> None:
    rng = np.random.default_rng(n)
    for _ in range(20):
        places, slots = rng.uniform(-1, 1, (n, 2)), rng.uniform(-1, 1, (n, 2))
        taken = match(places, slots)
        assert sorted(map(tuple, taken)) == sorted(map(tuple, slots))
        least = min(((places - slots[list(p)]) ** 2).sum() for p in permutations(range(n)))
        assert ((places - taken) ** 2).sum() == pytest.approx(least)


def test_nobody_passes_through_the_others() -> None:
    """Three in a row move up by one: the last does not overtake, though that is as far."""
    places = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    slots = np.array([[3.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    np.testing.assert_allclose(match(places, slots), places + np.array([1.0, 0.0]))
