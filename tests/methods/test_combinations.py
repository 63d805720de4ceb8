"""Combinations: what an action means is what the environment does, and nothing else can be said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from torch import nn

from random_worlds import random_world
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec, generate
from teamformer.learning.architectures import ARCHITECTURES
from teamformer.learning.evaluation import torch_brain
from teamformer.learning.export.onnx_export import NETWORK_FILE
from teamformer.methods.learned.combinations import CombinationCodec, Combined, combining
from teamformer.methods.learned.policy import rows_of
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import Decision, TeamFormation

JOIN_A, JOIN_B = 0b01, 0b10
SPLIT_A, SPLIT_B = 0b101, 0b110  # over two capabilities


def pair_and_one(teams: tuple[tuple[int, ...], ...]) -> TeamFormation:
    """Robots {a}, {b}, {a} in one cell, the first two as one team if so told."""
    robots = tuple(Robot(f"r{i}", (1, 1), {cap: 1}) for i, cap in enumerate("aba"))
    tasks = (Task("t0", (4, 4), {"a": 2, "b": 1}),)
    return TeamFormation([Mission("three", Grid(5, 5), ("a", "b"), robots, tasks, teams)])


def legal(env: TeamFormation) -> list[set[int]]:
    rows = CombinationCodec(2).encode(env.view()).is_legal
    return [set(np.flatnonzero(row).tolist()) for row in rows]


def test_legal_combinations_by_hand() -> None:
    assert legal(pair_and_one(())) == [{0, JOIN_A, JOIN_B}, {0, JOIN_A}, {0, JOIN_A, JOIN_B}]
    assert legal(pair_and_one(((0, 1),))) == [{0, JOIN_A, SPLIT_A, SPLIT_B}, {0, 0b11}]
    # of two {a} and one {b} all but one of anything may go
    assert legal(pair_and_one(((0, 1, 2),))) == [{0, SPLIT_A, SPLIT_B, 0b111}]


def test_actions_stand_for_counts_by_hand() -> None:
    view = pair_and_one(((0, 1, 2),)).view()
    codec = CombinationCodec(2)
    for action, wanted in ((0, [2, 1]), (SPLIT_A, [1, 1]), (SPLIT_B, [2, 0]), (0b111, [1, 0])):
        assert codec.decode(view, np.array([action])).tolist() == [wanted]
    view = pair_and_one(()).view()
    assert codec.decode(view, np.array([JOIN_B, JOIN_A, 0])).tolist() == [[1, 1], [1, 1], [1, 0]]


def test_whatever_is_legal_is_carried_out() -> None:
    rng = np.random.default_rng(0)
    env = TeamFormation([random_world(rng) for _ in range(200)])
    caps = env.worlds.has.shape[2]
    codec, tried = CombinationCodec(caps), 0
    for _ in range(40):
        view = env.view()
        if not len(view.slot):
            break
        tokens = codec.encode(view)
        drawn = np.where(tokens.is_legal, rng.random(tokens.is_legal.shape), -1.0).argmax(axis=1)
        tried += int((drawn > 0).sum())
        env.step(Decision(codec.decode(view, drawn)))
    assert env.worlds.count["illegal"].sum() == 0
    assert tried > 2000
    assert env.worlds.count["splits"].sum() > 500


def test_more_capabilities_than_the_network_has_are_refused() -> None:
    view = TeamFormation([generate(Spec(8, 2, 8), np.random.default_rng(0))]).view()
    with pytest.raises(TeamformerError, match="knows 4 capabilities, the mission has 8"):
        CombinationCodec(4).encode(view)
    with pytest.raises(TeamformerError, match="2097152 actions"):
        CombinationCodec(20)


@pytest.fixture(params=["deepset", "gnn"])
def network(request: pytest.FixtureRequest) -> nn.Module:
    torch.manual_seed(0)
    made = ARCHITECTURES[request.param].make(4)
    with torch.no_grad():
        for weights in made.parameters():
            weights += 0.2 * torch.randn_like(weights)  # scores far apart, as after training
    return made


def some_tokens(seed: int = 0, worlds: int = 20) -> Combined:
    """Return tokens of fleets with duplicates, some of them in teams."""
    rng = np.random.default_rng(seed)
    spec = Spec(7, 5, 4, starts_in_teams=True)
    env = TeamFormation([generate(spec, rng) for _ in range(worlds)])
    return CombinationCodec(4).encode(env.view())


def run(network: nn.Module, tokens: Combined) -> torch.Tensor:
    with torch.no_grad():
        return network(*map(torch.from_numpy, tokens))  # type: ignore[no-any-return]


def test_illegal_actions_have_no_probability(network: nn.Module) -> None:
    tokens = some_tokens()
    probability = run(network, tokens).softmax(dim=-1).numpy()
    assert (probability[~tokens.is_legal] == 0).all()
    np.testing.assert_allclose(probability.sum(axis=1), 1.0, rtol=1e-5)


@pytest.mark.thorough
def test_padding_order_and_company_change_nothing(network: nn.Module) -> None:
    tokens = some_tokens()
    scores = run(network, tokens)
    teams, tasks = tokens.teams.copy(), tokens.tasks.copy()
    teams[~tokens.is_team], tasks[~tokens.is_task] = 9.0, 9.0
    padded = tokens._replace(teams=teams, tasks=tasks)
    torch.testing.assert_close(run(network, padded), scores, rtol=1e-5, atol=1e-5)
    seen = np.array([0, *range(tokens.teams.shape[1] - 1, 0, -1)])  # the own team stays first
    shuffled = tokens._replace(
        teams=tokens.teams[:, seen],
        is_team=tokens.is_team[:, seen],
        tasks=tokens.tasks[:, ::-1].copy(),
        is_task=tokens.is_task[:, ::-1].copy(),
    )
    torch.testing.assert_close(run(network, shuffled), scores, rtol=1e-4, atol=1e-4)
    alone = torch.cat([run(network, Combined(*(p[i : i + 1] for p in tokens))) for i in range(20)])
    torch.testing.assert_close(alone, scores[:20], rtol=1e-4, atol=1e-4)


def test_log_probabilities_are_those_of_the_same_actions_again(network: nn.Module) -> None:
    tokens = tuple(map(torch.from_numpy, some_tokens()))
    with torch.no_grad():
        action, log_prob = network.act(tokens, torch.Generator().manual_seed(0))  # type: ignore[operator]
        again, entropy = network.evaluate((*tokens, action))  # type: ignore[operator]
        log_probs = network(*tokens).log_softmax(dim=-1)
    torch.testing.assert_close(again, log_prob)
    by_hand = -(log_probs.exp() * log_probs).sum(dim=-1)
    torch.testing.assert_close(entropy, by_hand)


@pytest.mark.parametrize("name", [pytest.param("deepset", marks=pytest.mark.slow), "gnn"])
@pytest.mark.thorough
def test_onnx_decides_as_torch_over_a_thousand_views(name: str, tmp_path: Path) -> None:
    torch.manual_seed(1)
    network = ARCHITECTURES[name].make(4)
    with torch.no_grad():
        for weights in network.parameters():
            weights += 0.2 * torch.randn_like(weights)
    ARCHITECTURES[name].export(network, 4, tmp_path)
    policy = combining((tmp_path / NETWORK_FILE).read_bytes(), name, 4)
    in_torch, codec, views = torch_brain(network), CombinationCodec(4), 0  # type: ignore[arg-type]
    rng = np.random.default_rng(2)
    env = TeamFormation([generate(Spec(7, 5, 4, starts_in_teams=True), rng) for _ in range(60)])
    for _ in range(12):
        view = env.view()
        tokens = codec.encode(view)
        rows = np.flatnonzero(codec.has_choice(view, tokens))
        given = tuple(part[rows] for part in tokens)
        action = policy.brain(given)
        assert (action == in_torch(given)).all()
        views += len(rows)
        wanted = view.counts.copy()
        wanted[rows] = codec.decode(rows_of(view, rows), action)
        env.step(Decision(wanted))
    assert views > 1000
