"""The shared tour: exact where it says so, and never worse than it begins."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from teamformer.world.rules.tour import LARGEST_EXACT, _nearest_first_tour, plan_tour

Distances = tuple[np.ndarray, np.ndarray]


def tour_length(tour: np.ndarray, between: np.ndarray, from_start: np.ndarray) -> int:
    """Return the length of an open tour."""
    return int(from_start[tour[0]] + between[tour[:-1], tour[1:]].sum()) if len(tour) else 0


def line(*places: int, start: int = 0) -> Distances:
    """Return the distances between places on a line, and from its start."""
    at = np.array(places, dtype=np.int64)
    return np.abs(at[:, None] - at), np.abs(at - start)


def square(count: int, rng: np.random.Generator, side: int = 30) -> Distances:
    """Return Manhattan distances between random places, and from one more."""
    at = rng.integers(0, side, size=(count + 1, 2))
    away = np.abs(at[:, None] - at).sum(axis=2)
    return away[1:, 1:].copy(), away[0, 1:].copy()


def test_length_of_a_tour_by_hand() -> None:
    between, from_start = line(5, 3, -2)
    assert tour_length(np.array([1, 0, 2]), between, from_start) == 3 + 2 + 7
    assert tour_length(np.array([2, 1, 0]), between, from_start) == 2 + 5 + 2
    assert tour_length(np.array([], dtype=np.int64), between, from_start) == 0


def test_tour_does_not_return() -> None:
    """From 0: first the near end at -2, then all the way right: 2 + 5 + 2."""
    assert plan_tour(*line(5, 3, -2)).tolist() == [2, 1, 0]


def test_nothing_and_one() -> None:
    assert plan_tour(*line()).tolist() == []
    assert plan_tour(*line(4)).tolist() == [0]


def test_nearest_first_takes_the_lowest_of_equals() -> None:
    assert _nearest_first_tour(*line(3, -3, 4)).tolist() == [0, 2, 1]


@pytest.mark.parametrize("count", range(2, 8))
def test_few_tasks_get_the_shortest_of_all_tours(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(10):
        between, from_start = square(count, rng, side=8)  # small: many tours are equally short
        tour = plan_tour(between, from_start)
        shortest = min(
            tour_length(np.array(order), between, from_start)
            for order in permutations(range(count))
        )
        assert sorted(tour.tolist()) == list(range(count))
        assert tour_length(tour, between, from_start) == shortest


def test_many_tasks_get_a_tour_that_no_reversal_and_no_move_shortens() -> None:
    rng = np.random.default_rng(1)
    improved = 0
    for count in (LARGEST_EXACT + 1, 17, 40):
        between, from_start = square(count, rng)
        tour = plan_tour(between, from_start)
        length = tour_length(tour, between, from_start)
        first = _nearest_first_tour(between, from_start)
        assert sorted(tour.tolist()) == list(range(count))
        assert length <= tour_length(first, between, from_start)
        improved += length < tour_length(first, between, from_start)
        for other in neighbouring_tours(tour.tolist()):
            assert tour_length(np.array(other), between, from_start) >= length
    assert improved > 0


def neighbouring_tours(tour: list[int]) -> list[list[int]]:
    """Return every tour with one stretch reversed, or up to three tasks moved elsewhere."""
    count = len(tour)
    tours = [
        tour[:i] + tour[i:j][::-1] + tour[j:] for i in range(count) for j in range(i + 2, count + 1)
    ]
    for size in (1, 2, 3):
        for first in range(count - size + 1):
            rest = tour[:first] + tour[first + size :]
            stretch = tour[first : first + size]
            tours += [rest[:gap] + stretch + rest[gap:] for gap in range(len(rest) + 1)]
    return tours


@pytest.mark.parametrize("count", [9, 30])
def test_other_numbers_give_the_same_tour_where_no_two_distances_are_equal(count: int) -> None:
    rng = np.random.default_rng(5)
    between = np.triu(rng.permutation(count * count).reshape(count, count) + 1000, 1)
    between += between.T
    from_start = rng.permutation(count).astype(np.int64) + 500
    tour = plan_tour(between, from_start)
    old_number = rng.permutation(count)
    renamed = plan_tour(between[np.ix_(old_number, old_number)], from_start[old_number])
    assert old_number[renamed].tolist() == tour.tolist()


def test_unreachable_tasks_come_last() -> None:
    """A place beyond a wall is 2**30 away from all others; sums of them do not overflow."""
    between, from_start = line(9, 2, 5, 7)
    between[3, :3] = between[:3, 3] = 2**30
    from_start[3] = 2**30
    assert plan_tour(between, from_start).tolist() == [1, 2, 0, 3]
