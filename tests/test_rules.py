"""The shared rules, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.jit import entry
from teamformer.rules.coverage import covers, fills_gap, helps
from teamformer.rules.pairing import pair_off
from teamformer.rules.splitting import anybody_fits, fits


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


@entry
def stays(members, first, end, room):  # type: ignore[no-untyped-def]
    return fits(members[first], room), anybody_fits(members, first, end, room)


def test_who_stays_in_a_split() -> None:
    members = np.array([[2, 0], [1, 1], [0, 1]], np.int16)
    room = np.array([1, 1], np.int32)
    assert stays(members, 0, 1, room) == (False, False)
    assert stays(members, 0, 2, room) == (False, True)
    assert stays(members, 2, 3, room) == (True, True)
