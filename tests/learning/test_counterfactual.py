"""What would have been: forks, gains by hand, and a network fitted to them."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from random_worlds import random_world
from small_worlds import pair_with_a_task_each_side
from teamformer.learning.algorithms.counterfactual import Trials, try_others
from teamformer.learning.algorithms.rollout_improvement import RolloutImprovementSettings, fit
from teamformer.learning.trainer import make_learner
from teamformer.learning.training_settings import TrainSettings
from teamformer.methods.learned.any_fleet import AnyFleetCodec
from teamformer.methods.learned.macro_actions import FOLLOW, HALVE
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import TeamFormation


def test_a_fork_goes_its_own_way() -> None:
    rng = np.random.default_rng(0)
    env = TeamFormation([random_world(rng) for _ in range(30)])
    for _ in range(3):
        env.step(JoinAll().decide(env.view()))
    twin, steps = env.fork(), env.worlds.count["steps"].copy()
    while twin.is_running.any():
        twin.step(JoinAll().decide(twin.view()))
    assert (env.worlds.count["steps"] == steps).all()
    while env.is_running.any():
        env.step(JoinAll().decide(env.view()))
    for array, other in zip(env.worlds, twin.worlds, strict=True):
        np.testing.assert_array_equal(array, other)


def tried_by_pairs() -> Trials:
    worlds = [pair_with_a_task_each_side()] * 40
    return try_others(AnyFleetCodec(), worlds, np.random.default_rng(1), share=1.0)[0]


def test_gains_by_hand() -> None:
    """As one the pair takes four steps, halved at once three; halved later, nothing is won."""
    tried = tried_by_pairs()
    at_start = tried.tokens[2][:, 1].any(dim=1)  # there are two tasks
    assert set(tried.gain[at_start & (tried.other == HALVE)].tolist()) == {1.0}
    assert (tried.gain[~at_start] <= 0).all()


def test_steps_played_are_counted_forks_included() -> None:
    """The pair takes four steps; a fork at the start goes to its own end, which may be earlier."""
    worlds = [pair_with_a_task_each_side()]
    tried, steps = try_others(AnyFleetCodec(), worlds, np.random.default_rng(1), share=0.0)
    assert len(tried.gain) == 1
    assert steps == 4 + 4 - int(tried.gain[0])


def test_where_nobody_has_a_choice_nothing_is_learned() -> None:
    alone = Mission(
        "alone", Grid(4, 1), ("a",), (Robot("r", (0, 0), {"a": 1}),), (Task("t", (3, 0), {"a": 1}),)
    )
    tried, steps = try_others(AnyFleetCodec(), [alone], np.random.default_rng(1), share=1.0)
    assert (len(tried.gain), steps) == (0, 3 + 3)  # a step in each of three forks
    learner = make_learner(TrainSettings(seed=1))
    before = [part.clone() for part in learner.policy.parameters()]
    assert fit(learner, tried, RolloutImprovementSettings(), 0.0, torch.Generator()) == 0.0
    assert all(map(torch.equal, before, learner.policy.parameters()))


def test_a_network_fitted_to_gains_promises_them_less_the_margin() -> None:
    settings = RolloutImprovementSettings(passes=200, minibatch=64, margin=0.25)
    learner = make_learner(TrainSettings(seed=1))
    fit(learner, tried_by_pairs(), settings, 0.0, torch.Generator().manual_seed(0))
    view = TeamFormation([pair_with_a_task_each_side()]).view()
    scores = learner.policy(*(torch.from_numpy(part) for part in AnyFleetCodec().encode(view)))[0]
    assert scores[HALVE].item() - scores[FOLLOW].item() == pytest.approx(0.75, abs=0.1)
    assert scores.argmax() != FOLLOW
