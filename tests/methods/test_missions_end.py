"""Every mission ends under every shipped learned policy, whatever happened before."""

from __future__ import annotations

import pytest

from blocked_worlds import blocked_worlds
from teamformer.methods.by_name import load_method
from teamformer.methods.learned.policy import Learned
from teamformer.methods.listings import our_method_names

LEARNED = [name for name in our_method_names() if isinstance(load_method(name).policy, Learned)]


def test_all_learned_policies_are_here() -> None:
    assert {"teamformer", "teamformer-c4", "deepset-c8", "gnn-c8"} <= set(LEARNED)


@pytest.mark.parametrize("name", [name for name in LEARNED if not name.endswith("-ppo")])
def test_nothing_blocks(name: str) -> None:
    method = load_method(name)
    assert blocked_worlds(method, 25, seed=21) == []
    assert blocked_worlds(method, 25, seed=22, is_plane=True) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", LEARNED)
def test_nothing_blocks_in_ten_thousand_worlds(name: str) -> None:
    method = load_method(name)
    assert blocked_worlds(method, count=10_000, seed=23) == []
    assert blocked_worlds(method, count=2500, seed=24, is_plane=True) == []
