"""The paper's network: legal spellings only, each as likely as it is said to be."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import torch

from random_worlds import random_decision, random_world
from teamformer.nets.teamformer import Teamformer, TeamformerSettings
from teamformer.policies.spelling import TASK_FEATURES, TEAM_FEATURES, SpellingCodec
from teamformer.sim.arrays import Array
from teamformer.sim.env import Decision, TeamFormation
from teamformer.sim.view import View

CAPS = 4
CODEC = SpellingCodec(CAPS)
SPELLINGS = ["edit", "full"]


def network(spelling: str, bias: float = 1.0, seed: int = 0) -> Teamformer:
    """Return a network with large random weights, so that nothing is likely by default."""
    torch.manual_seed(seed)
    settings = TeamformerSettings(CAPS, TEAM_FEATURES, TASK_FEATURES, spelling, maintain_bias=bias)
    net = Teamformer(settings).eval()
    for weights in net.parameters():
        torch.nn.init.normal_(weights, std=0.3) if weights.ndim > 1 else None
    return net


def tensors(tokens: tuple[Array, ...]) -> tuple[torch.Tensor, ...]:
    return tuple(torch.from_numpy(np.asarray(part)) for part in tokens)


def random_views(count: int, seed: int) -> list[tuple[View, TeamFormation]]:
    """Return views from random worlds, some steps into their trials."""
    rng, views = np.random.default_rng(seed), []
    while len(views) < count:
        env = TeamFormation([random_world(rng) for _ in range(4)])
        for _ in range(int(rng.integers(0, 8))):
            env.step(random_decision(env.view(), rng, 0.8))
        if len(env.view().slot):
            views.append((env.view(), env))
    return views


def legal_wishes(view: View, row: int) -> set[tuple[int, ...]]:
    """Return all counts that a team may want, by trying every one."""
    own, caps = view.counts[row].astype(int), view.counts.shape[1]
    padding = (0,) * (CAPS - caps)
    wishes = {tuple(own)}
    if view.is_serving[row]:
        return {tuple(own) + padding}
    for other in np.flatnonzero(view.can_join[row]):
        wishes.add(tuple(own + view.seen_counts[row, other]))
    members = view.member_counts[view.first_member[row] : view.first_member[row + 1]]
    for kept in itertools.product(*(range(n + 1) for n in own)):
        if (members <= np.array(kept)).all(axis=1).any():
            wishes.add(kept)
    return {wish + padding for wish in wishes}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_probabilities_of_all_legal_decisions_sum_to_one(spelling: str) -> None:
    net = network(spelling)
    checked = 0
    for view, _ in random_views(60, 1):
        tokens = CODEC.encode(view)
        has_choice = CODEC.has_choice(view, tokens)
        for row in range(len(view.slot)):
            wishes = sorted(legal_wishes(view, row))
            assert (len(wishes) > 1) == has_choice[row]
            repeated = tuple(np.repeat(part[row : row + 1], len(wishes), 0) for part in tokens)
            with torch.no_grad():
                log_prob, entropy = net.evaluate(tensors(repeated), torch.tensor(wishes))
            assert log_prob.min() > -1e6
            assert log_prob.exp().sum().item() == pytest.approx(1.0, abs=1e-5)
            assert (entropy >= -1e-6).all()
            checked += len(wishes)
    assert checked > 500


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_sampled_decisions_are_legal_and_as_likely_as_evaluated(spelling: str) -> None:
    net, generator = network(spelling), torch.Generator().manual_seed(1)
    for view, env in random_views(100, 2):
        tokens = CODEC.encode(view)
        with torch.no_grad():
            action, log_prob = net.act(tensors(tokens), generator)
            again, _ = net.evaluate(tensors(tokens), action)
        assert torch.allclose(log_prob, again, atol=1e-5)
        before = sum(env.tally(w).illegal_decisions for w in range(len(env.scenarios)))
        env.step(Decision(CODEC.decode(view, action.numpy())))
        after = sum(env.tally(w).illegal_decisions for w in range(len(env.scenarios)))
        assert after == before
