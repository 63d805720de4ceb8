"""The paper's network: legal spellings only, each as likely as it is said to be."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import torch

from spelling_views import CAPS, SPELLINGS, illegal_decisions, random_views, tensors, wild_network
from teamformer.learning.nets.action_mask import (
    EDIT,
    Grammar,
    changes,
    sole_targets,
    spell,
    steps_with_a_choice,
)
from teamformer.learning.nets.teamformer import Spelling, Tokens
from teamformer.methods.learned.token_features import SpellingCodec
from teamformer.world.env import Decision
from teamformer.world.view import View

CODEC = SpellingCodec(CAPS)


def legal_wishes(view: View, row: int) -> set[tuple[int, ...]]:
    """Return all counts that a team may want, by trying every one."""
    own, caps = view.counts[row].astype(int), view.counts.shape[1]
    padding = (0,) * (CAPS - caps)
    if view.is_serving[row]:
        return {(*own, *padding)}
    wishes = {tuple(own)}
    for other in np.flatnonzero(view.can_join[row]):
        wishes.add(tuple(own + view.seen_counts[row, other]))
    members = view.member_counts[view.first_member[row] : view.first_member[row + 1]]
    for kept in itertools.product(*(range(n + 1) for n in own)):
        if (members <= np.array(kept)).all(axis=1).any():
            wishes.add(kept)
    return {wish + padding for wish in wishes}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_probabilities_of_all_legal_decisions_sum_to_one(spelling: str) -> None:
    network = wild_network(spelling)
    checked = 0
    for view, _ in random_views(15, 1):
        tokens = CODEC.encode(view)
        has_choice = CODEC.has_choice(view, tokens)
        for row in range(len(view.slot)):
            wishes = sorted(legal_wishes(view, row))
            assert (len(wishes) > 1) == has_choice[row]
            repeated = tuple(np.repeat(part[row : row + 1], len(wishes), 0) for part in tokens)
            with torch.no_grad():
                prepared = network.prepare(tensors(repeated), torch.tensor(wishes))
                log_prob, entropy = network.evaluate(prepared)
            assert log_prob.exp().sum().item() == pytest.approx(1.0, abs=1e-5)
            assert log_prob.min() > -1e6
            assert entropy.min() >= -1e-6
            checked += len(wishes)
    assert checked > 150


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_sampled_decisions_are_legal_and_as_likely_as_evaluated(spelling: str) -> None:
    network, generator = wild_network(spelling), torch.Generator().manual_seed(1)
    teams, changed = 0, 0
    for view, env in random_views(15, 2, worlds=20):
        tokens = CODEC.encode(view)
        with torch.no_grad():
            action, log_prob = network.act(tensors(tokens), generator)
            again, _ = network.evaluate(network.prepare(tensors(tokens), action))
        assert torch.allclose(log_prob, again, atol=1e-5)
        wanted = CODEC.decode(view, action.numpy())
        teams, changed = teams + len(wanted), changed + (wanted != view.counts).any(axis=1).sum()
        before = illegal_decisions(env)
        env.step(Decision(wanted))
        assert illegal_decisions(env) == before
    assert teams > 600
    assert changed > teams / 4


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_greedy_decisions_are_the_likeliest_symbols(spelling: str) -> None:
    network = wild_network(spelling)
    [(view, _)] = random_views(1, 3, worlds=30)
    tokens = tensors(CODEC.encode(view))
    with torch.no_grad():
        action, log_prob = network.act(tokens, None)
        again, _ = network.act(tokens, None)
        assert torch.equal(action, again)
        said, _ = network.evaluate(network.prepare(tokens, action))
        assert torch.allclose(log_prob, said, atol=1e-5)


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_padding_order_and_other_teams_change_nothing(spelling: str) -> None:
    network, rng = wild_network(spelling), np.random.default_rng(4)
    [(view, _)] = random_views(1, 5, worlds=20)
    given = Tokens(*tensors(CODEC.encode(view)))
    teams, tasks = given.is_team.shape[1], given.is_task.shape[1]
    of_teams = torch.from_numpy(np.concatenate([[0], 1 + rng.permutation(teams - 1)]))
    of_tasks = torch.from_numpy(np.concatenate([[0], 1 + rng.permutation(tasks - 1)]))
    shuffled = Tokens(
        *(part[:, of_teams] for part in given[:2]),
        *(part[:, of_tasks] for part in given[2:4]),
        given.is_team[:, of_teams],
        given.is_task[:, of_tasks],
        given.can_join[:, of_teams],
        given.singles,
        given.profiles.flip(1),
    )
    padded = Tokens(*(_pad(part) for part in given[:7]), given.singles, given.profiles)
    with torch.no_grad():
        action, _ = network.act(given, torch.Generator().manual_seed(6))
        log_prob, entropy = network.evaluate(network.prepare(given, action))
        for other in (shuffled, padded):
            again = network.evaluate(network.prepare(other, action))
            assert torch.allclose(log_prob, again[0], atol=1e-5)
            assert torch.allclose(entropy, again[1], atol=1e-5)
        for row in range(10):
            one = tuple(part[row : row + 1] for part in given)
            alone = network.evaluate(network.prepare(one, action[row : row + 1]))
            assert alone[0].item() == pytest.approx(log_prob[row].item(), abs=1e-5)


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_without_padding_scores_and_gradients_are_the_same(spelling: str) -> None:
    """Packed tokens and steps go through a kernel, padded ones through products of matrices."""
    network = wild_network(spelling)
    [(view, _)] = random_views(1, 8, worlds=20)
    given = Tokens(*tensors(CODEC.encode(view)))
    action, _ = network.act(given, torch.Generator().manual_seed(9))
    said = Spelling(*network.prepare(given, action)[-4:])
    change = torch.nn.functional.pad(changes(spelling, said.symbol, CAPS)[:, :-1], (0, 0, 1, 0))
    found = []
    for is_packed in (False, True):
        if is_packed:
            scores = network._scores_of_packed(given, change, said.is_there)
        else:
            scores, _ = network.decode(network.encode(given), change, change.cumsum(dim=1), None)
        scores = scores[said.is_there]  # those of steps that are not there mean nothing
        network.zero_grad()
        scores.sin().sum().backward()
        found.append(
            [scores.detach(), *(w.grad for w in network.parameters() if w.grad is not None)]
        )
    for is_there in (given.is_team, given.is_task, said.is_there):
        assert not is_there.all()
    assert len(found[0]) == len(found[1]) > 30
    for padded, packed in zip(*found, strict=True):
        torch.testing.assert_close(packed, padded, rtol=1e-4, atol=2e-4)


def _pad(part: torch.Tensor) -> torch.Tensor:
    """Add three tokens of padding, full of what must not be looked at."""
    filler = torch.zeros_like(part[:, :1]) if part.dtype == torch.bool else 0 * part[:, :1] + 7.0
    return torch.cat([part, filler, filler, filler], dim=1)


def test_a_spelling_is_ascending_and_repeats_what_is_counted() -> None:
    """Have 1 0 2, want 1 1 3: in full 0 1 2 2 2 end (3), in edit add 1, add 2, end (6)."""
    own, wanted = torch.tensor([[1.0, 0.0, 2.0]]), torch.tensor([[1.0, 1.0, 3.0]])
    assert spell("full", own, wanted)[0].tolist() == [[0, 1, 2, 2, 2, 3]]
    assert spell("edit", own, wanted)[0].tolist() == [[1, 2, 6]]


def test_what_is_dropped_has_symbols_of_its_own() -> None:
    """Have 1 0 2, want 0 0 1: drop 0 (symbol 3), drop 2 (symbol 5), end; maintaining is the end."""
    own = torch.tensor([[1.0, 0.0, 2.0], [1.0, 0.0, 2.0]])
    wanted = torch.tensor([[0.0, 0.0, 1.0], [1.0, 0.0, 2.0]])
    symbol, is_there = spell("edit", own, wanted)
    assert symbol.tolist() == [[3, 5, 6], [6, 6, 6]]
    assert is_there.tolist() == [[True, True, True], [True, False, False]]
    assert changes("edit", symbol, 3)[0].tolist() == [[-1, 0, 0], [0, 0, -1], [0, 0, 0]]


def test_maintaining_is_likely_before_training() -> None:
    [(view, _)] = random_views(1, 7, worlds=60)
    tokens = CODEC.encode(view)
    rows = CODEC.has_choice(view, tokens)
    given = tensors(tuple(part[rows] for part in tokens))
    action = given[1][:, 0].long()
    with torch.no_grad():
        shy, bold = (
            network.evaluate(network.prepare(given, action))[0].exp().mean()
            for network in (wild_network("edit", bias=8.0), wild_network("edit", bias=0.0))
        )
    assert shy > 0.95 > 0.6 > bold


def grammar_of_three() -> Grammar:
    """A team with c may add a b, a b b or b (in the capabilities a, b, c)."""
    targets = torch.tensor([[[0, 0, 0], [1, 1, 0], [1, 2, 0], [0, 1, 0]]]).float()
    own = torch.tensor([[0.0, 0.0, 1.0]])
    nobody = torch.zeros(1, 0, 3)
    return Grammar(own, targets, torch.ones(1, 4, dtype=torch.bool), own, nobody)


def test_from_which_symbol_on_the_rest_is_certain_by_hand() -> None:
    """b is certain at once; after a, b both go on, until the next symbol is the end or b again."""
    grammar = grammar_of_three()
    for wanted, steps in (([0, 0, 1], 1), ([0, 1, 1], 1), ([1, 1, 1], 3), ([1, 2, 1], 3)):
        assert steps_with_a_choice(EDIT, grammar, torch.tensor([wanted]).float()).tolist() == [
            steps
        ]
    for spelled, sole in (
        ([0, 0, 0], None),
        ([0, 1, 0], [0, 1, 0]),
        ([1, 1, 0], None),
        ([1, 2, 0], [1, 2, 0]),
    ):
        is_sole, target = sole_targets(EDIT, grammar, torch.tensor([[spelled]]).float())
        assert is_sole.tolist() == [sole is not None]
        assert sole is None or target.tolist() == [sole]
