"""Drafts of scenarios, good and bad, as pages send them."""

from __future__ import annotations

import pytest

from teamformer.errors import TeamformerError
from teamformer.live.drafts import EMPTY, can_be_drawn, problems_of, read_draft

GOOD = EMPTY | {
    "robots": [{"at": [1, 1], "can": ["lift"]}],
    "tasks": [{"at": [2, 2], "needs": ["lift"]}],
}


def test_a_good_draft_is_a_scenario() -> None:
    assert problems_of(GOOD) == []
    assert read_draft(GOOD).tasks[0].at == (2, 2)


def test_an_empty_draft_says_what_it_lacks() -> None:
    assert [problem["message"] for problem in problems_of(EMPTY)] == [
        "there is no robot; add one",
        "there is no task; add one",
    ]


def test_a_mission_in_continuous_time_is_no_draft_to_run() -> None:
    with pytest.raises(TeamformerError, match="continuous time"):
        read_draft(GOOD | {"time": "continuous"})


@pytest.mark.parametrize("tree", [None, [], 3, {}, {"world": 3}, GOOD | {"robots": [7]}])
def test_what_is_no_draft_is_told_and_not_drawn(tree: object) -> None:
    assert problems_of(tree)
    assert not can_be_drawn(tree)
