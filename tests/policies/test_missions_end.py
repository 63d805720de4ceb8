"""Every mission ends under every shipped learned policy, whatever happened before."""

from __future__ import annotations

import pytest

from blocked_worlds import blocked_worlds
from teamformer.mission.rules import ALLOCATIONS
from teamformer.policies.learned.policy import Learned
from teamformer.trials.methods import METHODS, load_method

LEARNED = [
    listing.name for listing in METHODS if isinstance(load_method(listing.name).policy, Learned)
]
PLAYED = [
    (name, allocation)
    for name in LEARNED
    for allocation in (ALLOCATIONS if name == "teamformer" else ("paper",))
]
"""The network for any fleet knows crews and plans too, which Python may have it play with."""


def test_all_learned_policies_are_here() -> None:
    assert {"teamformer", "teamformer-c4", "deepset-c8", "gnn-c8"} <= set(LEARNED)


@pytest.mark.parametrize(
    ("name", "allocation"), [case for case in PLAYED if not case[0].endswith("-ppo")]
)
def test_nothing_blocks(name: str, allocation: str) -> None:
    policy = load_method(name).policy
    count = 5 if allocation == "plan" else 25  # a plan takes a while
    assert blocked_worlds(policy, allocation, count, seed=21) == []
    assert blocked_worlds(policy, allocation, count, seed=22, is_plane=True) == []


@pytest.mark.slow
@pytest.mark.parametrize(("name", "allocation"), PLAYED)
def test_nothing_blocks_in_ten_thousand_worlds(name: str, allocation: str) -> None:
    policy = load_method(name).policy
    assert blocked_worlds(policy, allocation, count=10_000, seed=23) == []
    assert blocked_worlds(policy, allocation, count=2500, seed=24, is_plane=True) == []
