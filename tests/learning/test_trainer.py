"""Training: one seed is one run, stopped or not, and what is exported decides the same."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor

from teamformer.base.errors import TeamformerError
from teamformer.learning.algorithms.optimiser import Learner
from teamformer.learning.algorithms.ppo import clipped_loss
from teamformer.learning.algorithms.reward_streams import MissionReward, TeamReward
from teamformer.learning.algorithms.rollout import play, sampler
from teamformer.learning.checkpoint import ABOUT, WEIGHTS, load_weights, read_about
from teamformer.learning.evaluation import torch_brain
from teamformer.learning.nets.actor import Actor
from teamformer.learning.trainer import make_learner
from teamformer.learning.trainer import train as train_and_export
from teamformer.learning.training_settings import TrainSettings
from teamformer.learning.training_worlds import (
    Mixture,
    paper_mixture,
    selection_worlds,
    training_worlds,
)
from teamformer.methods.by_name import load_method
from teamformer.methods.learned.policy import Learned
from teamformer.mission.model import Mission
from teamformer.trials.trial import run_trials
from teamformer.world.env import TeamFormation

SHORT = TrainSettings(
    method="ppo",
    seed=3,
    iterations=4,
    worlds=8,
    mixture=Mixture(robots=(2, 5), tasks=(1, 4), grid=(5, 8), steps=40),
    evaluate_every=2,
)


train = partial(train_and_export, exports=False)


def weights(learner: Learner) -> list[Tensor]:
    return [
        part.clone()
        for name in ("policy", "critic")
        for part in getattr(learner, name).state_dict().values()
    ]


def held_out() -> list[list[Mission]]:
    mixture = replace(SHORT.worlds_from, crowds=0.0)
    return [training_worlds(mixture, 4, (9, 0))]


def test_one_seed_is_one_run_and_another_is_another(tmp_path: Path) -> None:
    first = weights(train(SHORT, tmp_path / "a", held_out()))
    again = weights(train(SHORT, tmp_path / "b", held_out()))
    other = weights(train(replace(SHORT, seed=4), tmp_path / "c", held_out()))
    assert all(torch.equal(a, b) for a, b in zip(first, again, strict=True))
    assert not all(torch.equal(a, b) for a, b in zip(first, other, strict=True))


@pytest.mark.parametrize(
    ("method", "network", "capabilities"),
    [("ppo", "any", None), ("rollouts", "any", None), ("imitation", "gnn", 8)],
)
def test_a_resumed_run_ends_as_an_uninterrupted_one(
    method: str, network: str, capabilities: int | None, tmp_path: Path
) -> None:
    assert SHORT.mixture is not None
    mixture = replace(SHORT.mixture, crowds=0.0)  # of more capabilities than eight
    settings = replace(
        SHORT, method=method, network=network, capabilities=capabilities, mixture=mixture
    )
    whole = weights(train(settings, tmp_path / "whole", held_out()))
    train(settings, tmp_path / "parts", held_out(), until=3)
    parts = weights(train(settings, tmp_path / "parts", held_out()))
    assert all(torch.equal(a, b) for a, b in zip(whole, parts, strict=True))
    assert read_about(tmp_path / "parts" / "last")["progress"]["iteration"] == 4


def test_bad_folders_are_refused(tmp_path: Path) -> None:
    train(SHORT, tmp_path, [], until=1)
    with pytest.raises(TeamformerError, match="another training"):
        train(replace(SHORT, worlds=9), tmp_path, [])
    about = json.loads((tmp_path / "last" / ABOUT).read_text())
    (tmp_path / "last" / ABOUT).write_text(json.dumps({**about, "format": 99}))
    with pytest.raises(TeamformerError, match="checkpoint format 99"):
        train(SHORT, tmp_path, [])
    (tmp_path / "last" / ABOUT).write_text(json.dumps(about))
    whole = (tmp_path / "last" / WEIGHTS).read_bytes()
    (tmp_path / "last" / WEIGHTS).write_bytes(whole[:1000])
    with pytest.raises(TeamformerError, match="not readable"):
        train(SHORT, tmp_path, [])


@pytest.mark.parametrize(
    ("network", "capabilities", "words"),
    [
        ("quantum", None, "there is no network 'quantum'"),
        ("any", 4, "serves any number"),
        ("gnn", None, "is made for a number"),
        ("deepset", 40, "40 capabilities make"),
    ],
)
def test_networks_that_cannot_be_are_refused(
    network: str, capabilities: int | None, words: str
) -> None:
    with pytest.raises(TeamformerError, match=words):
        TrainSettings(network=network, capabilities=capabilities)


def test_methods_that_cannot_be_are_refused() -> None:
    with pytest.raises(TeamformerError, match="'gnn' does not learn by rollouts"):
        TrainSettings(network="gnn", capabilities=4, method="rollouts")
    with pytest.raises(TeamformerError, match="'any' does not learn by imitation"):
        TrainSettings(method="imitation")
    with pytest.raises(TeamformerError, match="knows no reward"):
        TrainSettings(mission_reward=None)


def test_training_may_begin_from_the_weights_of_another(tmp_path: Path) -> None:
    first = train(SHORT, tmp_path, [], until=1)
    second = make_learner(replace(SHORT, seed=8))
    load_weights(tmp_path / "last", second)
    assert all(torch.equal(a, b) for a, b in zip(weights(first), weights(second), strict=True))
    assert not second.policy_optimizer.state_dict()["state"]
    per_team = make_learner(replace(SHORT, mission_reward=None))  # its critic is another one
    with pytest.raises(TeamformerError, match="another network"):
        load_weights(tmp_path / "last", per_team)


def test_log_probs_of_a_rollout_are_those_of_the_same_actions_again() -> None:
    learner = make_learner(SHORT)
    codec = SHORT.architecture.codec(None)
    env = TeamFormation(training_worlds(SHORT.worlds_from, 30, (5, 0)))
    choose = sampler(learner.policy, torch.Generator().manual_seed(0))
    rollout = play(env, codec, choose, MissionReward(), 40)
    prepared = learner.policy.prepare(rollout.tokens, rollout.action)
    again, _ = learner.policy.evaluate(prepared)
    torch.testing.assert_close(again, rollout.log_prob)
    assert (rollout.tokens[-1].sum(dim=1) > 1).all()  # forced ones are left out
    assert env.worlds.count["illegal"].sum() == 0


def test_losses_by_hand() -> None:
    ratio, gain = torch.tensor([1.5, 1.5, 0.5, 0.5]), torch.tensor([1.0, -1.0, 1.0, -1.0])
    assert clipped_loss(ratio, gain, 0.2).tolist() == pytest.approx([-1.2, 1.5, -0.5, 0.8])


def test_training_worlds_are_mixed_and_come_from_their_numbers_alone() -> None:
    worlds = training_worlds(Mixture(), 200, (1, 7))
    assert worlds == training_worlds(Mixture(), 200, (1, 7))
    assert worlds[0] != training_worlds(Mixture(), 200, (1, 8))[0]
    crowds = [w for w in worlds if len(w.robots) > 14]
    assert 3 < len(crowds) < 20
    doubled = np.mean([len(w.robots) > len(w.capabilities) for w in worlds])
    assert 0.6 < doubled < 0.95
    assert {len(w.tasks) for w in worlds} == set(range(1, 19))
    in_teams = np.mean([len(w.starting_teams) < len(w.robots) for w in worlds])
    assert 0.15 < in_teams < 0.35
    larger = selection_worlds(2)
    assert max(len(world.tasks) for spec in larger for world in spec) == 60


def test_the_papers_worlds_have_four_robots_some_of_them_alike() -> None:
    worlds = training_worlds(paper_mixture(8), 200, (1, 0))
    assert {len(world.robots) for world in worlds} == {4}
    assert {len(world.tasks) for world in worlds} == {1, 2, 3, 4}
    assert {world.capabilities for world in worlds} == {tuple(f"c{i}" for i in range(1, 9))}
    present = [{name for robot in world.robots for name in robot.can} for world in worlds]
    assert set.union(*present) == {f"c{i}" for i in range(1, 9)}
    alike = np.mean([len(names) == 2 for names in present])
    assert 0.15 < alike < 0.35
    assert {len(names) for names in present} == {2, 4}


def test_the_team_reward_trains_and_resumes_too(tmp_path: Path) -> None:
    settings = replace(SHORT, mission_reward=None, team_reward=TeamReward(), iterations=2)
    whole = weights(train(settings, tmp_path / "whole", held_out()))
    train(settings, tmp_path / "parts", held_out(), until=1)
    parts = weights(train(settings, tmp_path / "parts", held_out()))
    assert all(torch.equal(a, b) for a, b in zip(whole, parts, strict=True))


def test_what_training_leaves_runs_by_the_folders_name(tmp_path: Path) -> None:
    train_and_export(SHORT, tmp_path, held_out())
    policy = load_method(str(tmp_path)).policy
    worlds = held_out()[0]
    in_torch = Learned(SHORT.architecture.codec(None), torch_brain(best_of(tmp_path)))
    assert run_trials(worlds, policy) == run_trials(worlds, in_torch)


def best_of(folder: Path) -> Actor:
    learner = make_learner(SHORT)
    load_weights(folder / "best", learner)
    return learner.policy
