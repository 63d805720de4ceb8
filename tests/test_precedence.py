"""Orders in which tasks stand behind those that they come after."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.mission.precedence import keep_precedence


@pytest.mark.parametrize(
    ("order", "before", "kept"),
    [
        ([2, 0, 1], {}, [2, 0, 1]),
        ([2, 0, 1], {2: [1]}, [0, 1, 2]),
        ([2, 0, 1, 3], {2: [1], 0: [2]}, [1, 2, 0, 3]),
        ([2, 0], {2: [1]}, [2, 0]),  # what is not in the order does not count
    ],
)
def test_tasks_are_moved_back_as_little_as_need_be(
    order: list[int], before: dict[int, list[int]], kept: list[int]
) -> None:
    assert keep_precedence(order, before) == kept


def test_of_all_orders_that_keep_precedence_it_is_the_first_by_the_old_places() -> None:
    """Each time the earliest task of the old order that may come next."""
    rng = np.random.default_rng(0)
    for _ in range(50):
        rank, order = rng.permutation(8), rng.permutation(8).tolist()
        before = {
            k: [j for j in range(8) if rank[j] < rank[k] and rng.random() < 0.2] for k in order
        }
        wanted: list[int] = []
        while len(wanted) < len(order):
            wanted.append(
                next(k for k in order if k not in wanted and set(before[k]) <= set(wanted))
            )
        assert keep_precedence(order, before) == wanted
