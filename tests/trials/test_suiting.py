"""A policy that knows some allocations only plays under one of them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from teamformer.errors import TeamformerError
from teamformer.mission.rules import ALLOCATIONS
from teamformer.policies import POLICIES
from teamformer.scenarios.smallest import smallest_scenario
from teamformer.trials.registry import load_policy
from teamformer.trials.suiting import knows, refuse_unknown, suited


@pytest.mark.parametrize("name", [listing.name for listing in POLICIES])
def test_what_knows_an_allocation_plays_under_it_and_what_does_not_under_its_own(
    name: str,
) -> None:
    policy = load_policy(name, POLICIES)
    is_limited = name.startswith(("teamformer-c", "deepset", "gnn"))
    for allocation in ALLOCATIONS:
        scenario = replace(smallest_scenario(), allocation=allocation)
        is_known = allocation in ("paper", "nearest") or not is_limited
        assert knows(policy, allocation) == is_known
        expected = scenario if is_known else replace(scenario, allocation="paper")
        assert suited(scenario, policy) == expected


def test_asking_for_an_allocation_that_a_policy_does_not_know_is_refused() -> None:
    policy = load_policy("teamformer-c4", POLICIES)
    refuse_unknown(policy, "teamformer-c4", None)
    refuse_unknown(policy, "teamformer-c4", "nearest")
    with pytest.raises(TeamformerError) as error:
        refuse_unknown(policy, "teamformer-c4", "crews")
    assert str(error.value) == (
        "policy 'teamformer-c4' was made for allocation paper or nearest, not crews"
    )
    assert error.value.hint == "leave --allocation out, or use paper"
