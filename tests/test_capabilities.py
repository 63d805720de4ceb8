"""Arithmetic on capability counts, by hand."""

from __future__ import annotations

import itertools

import pytest

from teamformer.mission.parts.capabilities import (
    covers,
    describe,
    exact,
    in_units,
    is_exact,
    missing,
    out_of_units,
    total,
    units_of,
)


def test_counts_are_added_up_by_name() -> None:
    assert total([{"lift": 1, "scan": 2}, {}, {"scan": 1, "weld": 4}]) == {
        "lift": 1,
        "scan": 3,
        "weld": 4,
    }
    assert total([]) == {}


@pytest.mark.parametrize(
    ("have", "need", "short"),
    [
        ({}, {}, {}),
        ({"lift": 1}, {}, {}),
        ({"lift": 2}, {"lift": 2}, {}),
        ({"lift": 1}, {"lift": 2}, {"lift": 1}),
        ({"lift": 9}, {"lift": 1, "scan": 3}, {"scan": 3}),
        ({"lift": 0}, {"lift": 1}, {"lift": 1}),  # zero is as good as absent
        ({}, {"lift": 0}, {}),
        ({"lift": 12.5}, {"lift": 20.25}, {"lift": 7.75}),
        ({"lift": 0.7}, {"lift": 0.8}, {"lift": 0.1}),  # not 0.10000000000000009
    ],
)
def test_what_is_missing(have: dict, need: dict, short: dict) -> None:
    assert missing(have, need) == short
    assert covers(have, need) == (not short)


def test_counts_are_written_for_people() -> None:
    assert describe({"lift": 1, "weld": 2, "scan": 0}) == "lift, 2 x weld"
    assert describe({}) == ""
    assert describe({"lift": 12.5, "weld": 0.001, "scan": 1.0}) == "12.5 x lift, 0.001 x weld, scan"


def test_sums_are_what_one_would_write_down() -> None:
    assert 0.1 + 0.2 != 0.3
    assert total([{"lift": 0.1}, {"lift": 0.2}]) == {"lift": 0.3}
    assert covers(total([{"lift": 0.1}] * 10), {"lift": 1})
    assert not covers(total([{"lift": 33.333}] * 3), {"lift": 100})
    assert covers(total([{"lift": 33.334}] * 3), {"lift": 100})
    whole = total([{"lift": 12.5}, {"lift": 7.5}])["lift"]
    assert whole == 20
    assert isinstance(whole, int)


@pytest.mark.parametrize(
    ("count", "is_so"),
    [(1, True), (1.001, True), (1.0005, False), (float("nan"), False), (float("inf"), False)],
)
def test_counts_have_three_places(count: float, is_so: bool) -> None:
    assert is_exact(count) == is_so


@pytest.mark.parametrize(
    ("brought", "unit"),
    [
        ([2, 4], 1000),  # whole numbers are counted in ones
        ([2.0, 3], 1000),
        ([12.5, 12.5], 12_500),
        ([12.5, 20.25], 250),
        ([0.5, 1], 500),
        ([33.333, 33.334], 1),
        ([0.1, 0.2, 0.3], 100),
    ],
)
def test_the_unit_is_what_all_bring_multiples_of(brought: list[float], unit: int) -> None:
    units = units_of({"lift": count} for count in brought)
    assert units == {"lift": unit}
    counts = [in_units({"lift": count}, units)["lift"] for count in brought]
    assert [exact(count * unit / 1000) for count in counts] == brought
    assert out_of_units({"lift": counts[0]}, units) == {"lift": brought[0]}


def test_needs_are_rounded_up_to_units_which_changes_nothing() -> None:
    """All sums of up to four robots of 2.5 or 4 against all needs of up to 20 in steps of 0.05."""
    units = units_of([{"lift": 2.5}, {"lift": 4}])
    assert units == {"lift": 500}
    assert in_units({"lift": 20.25, "scan": 2}, units) == {"lift": 41, "scan": 2}
    for light, heavy in itertools.product(range(3), range(3)):
        have = total([*[{"lift": 2.5}] * light, *[{"lift": 4}] * heavy])
        for need in range(1, 400):
            wanted = {"lift": need / 20}
            in_kilograms = covers(have, wanted)
            assert covers(in_units(have, units), in_units(wanted, units)) == in_kilograms
