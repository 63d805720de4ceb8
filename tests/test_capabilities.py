"""Arithmetic on capability counts, by hand."""

from __future__ import annotations

import pytest

from teamformer.capabilities import covers, describe, missing, total


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
    ],
)
def test_what_is_missing(have: dict, need: dict, short: dict) -> None:
    assert missing(have, need) == short
    assert covers(have, need) == (not short)


def test_counts_are_written_for_people() -> None:
    assert describe({"lift": 1, "weld": 2, "scan": 0}) == "lift, 2 x weld"
    assert describe({}) == ""
