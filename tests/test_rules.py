"""The shared rules, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.base.kernels.jit import entry
from teamformer.world.rules.constants import MICROMETRES
from teamformer.world.rules.coverage import covers, fills_gap, helps
from teamformer.world.rules.pairing import pair_off
from teamformer.world.rules.sorting import sort_indices
from teamformer.world.rules.splitting import anybody_fits, fits


@entry
def judged(have, need, brought):  # type: ignore[no-untyped-def]
    return covers(have, need), helps(have, need), fills_gap(have, need, brought)


@pytest.mark.parametrize(
    ("have", "need", "brought", "told"),
    [
        ((1, 0), (1, 0), (1, 1), (True, True, False)),
        ((1, 0), (2, 0), (1, 0), (False, True, True)),
        ((0, 1), (1, 0), (0, 5), (False, False, False)),
        ((0, 0), (0, 0), (1, 1), (True, False, False)),
    ],
)
def test_coverage(
    have: tuple[int, ...],
    need: tuple[int, ...],
    brought: tuple[int, ...],
    told: tuple[bool, ...],
) -> None:
    assert judged(*(np.array(counts, np.int16) for counts in (have, need, brought))) == told


@entry
def joined_at(arrival):  # type: ignore[no-untyped-def]
    return pair_off(arrival, len(arrival))


@pytest.mark.parametrize(
    ("arrival", "step"),
    [
        ((), 0),
        ((7,), 7),
        ((3, 3), 4),
        ((0, 0, 0), 2),  # two pair off, then the union and the third
        ((0, 0, 0, 0, 0), 3),
        ((0, 0, 9), 10),  # the first two wait as one
        ((0, 1, 1), 3),  # one at 0; at 1 three: two, then one
    ],
)
def test_pairing_off(arrival: tuple[int, ...], step: int) -> None:
    assert joined_at(np.array(arrival, np.int64)) == step


@pytest.mark.parametrize("seed", range(30))
def test_pairing_off_is_that_of_a_slow_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    arrival = np.sort(rng.integers(0, 5, size=rng.integers(1, 14)))
    step, teams, still_to_come = 0, 0, arrival.tolist()
    while still_to_come or teams > 1:
        if teams > 1:
            teams -= teams // 2
            step += 1
        else:
            step = max(step, still_to_come[0])
        teams += sum(other <= step for other in still_to_come)
        still_to_come = [other for other in still_to_come if other > step]
    assert joined_at(arrival.astype(np.int64)) == step


@entry
def sorted_indices(keys):  # type: ignore[no-untyped-def]
    order, spare = np.zeros(len(keys), np.int64), np.zeros(len(keys), np.int64)
    sort_indices(keys, order, spare)
    return order


@pytest.mark.parametrize("count", [0, 1, 2, 3, 4, 5, 7, 8, 9, 31, 64])
def test_sorting_keeps_the_order_of_equal_keys(count: int) -> None:
    keys = np.random.default_rng(count).integers(0, 1 + count // 2, size=count)
    assert sorted_indices(keys).tolist() == np.argsort(keys, kind="stable").tolist()


def test_a_metre_has_a_million_micrometres() -> None:
    assert MICROMETRES == 1_000_000


@entry
def stays(members, first, end, room):  # type: ignore[no-untyped-def]
    return fits(members[first], room), anybody_fits(members, first, end, room)


def test_who_stays_in_a_split() -> None:
    members = np.array([[2, 0], [1, 1], [0, 1]], np.int16)
    room = np.array([1, 1], np.int32)
    assert stays(members, 0, 1, room) == (False, False)
    assert stays(members, 0, 2, room) == (False, True)
    assert stays(members, 2, 3, room) == (True, True)
