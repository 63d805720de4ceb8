"""Learning by imitation: whose states are shown, losses by hand, and a script that is learned."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import Tensor, nn

from random_worlds import random_world
from small_worlds import two_robots_one_task
from teamformer.base.array_types import Array
from teamformer.learning.algorithms.demonstrations import Demonstrations, demonstrate
from teamformer.learning.algorithms.imitation import ImitationSettings, fit
from teamformer.learning.iteration import learn_by_imitation
from teamformer.learning.nets.actor import OneChoice
from teamformer.learning.trainer import make_learner
from teamformer.learning.training_settings import TrainSettings
from teamformer.learning.training_worlds import Mixture
from teamformer.methods.learned.combinations import CombinationCodec
from teamformer.methods.learned.token_features import SpellingCodec
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.world.env import Decision, TeamFormation


def never_act(tokens: tuple[Array, ...]) -> tuple[Array, Array]:
    """Maintain: combination 0."""
    return np.zeros(len(tokens[0]), dtype=np.int64), np.zeros(len(tokens[0]))


def shown(by_script: float, share: float = 1.0) -> tuple[Demonstrations, int]:
    worlds = [two_robots_one_task(step_limit=9)]
    rng = np.random.default_rng(0)
    return demonstrate(CombinationCodec(3), never_act, worlds, rng, by_script, share)


def test_the_script_is_asked_in_states_that_only_the_network_leads_to() -> None:
    """One that never joins stays apart for all nine steps, and is told to join in each of them."""
    apart, steps = shown(by_script=0.0)
    assert steps == 9
    assert (apart.agreed, apart.ended) == (0.0, 0.0)
    assert apart.action.tolist() == 9 * [0b010, 0b001]  # a joins b, b joins a
    together, steps = shown(by_script=1.0, share=0.0)
    assert steps == 4  # one to join, three to walk
    assert together.action.tolist() == [0b010, 0b001]  # then a team could only split: left out
    assert shown(by_script=1.0)[0].action.tolist() == [0b010, 0b001, 0, 0, 0]


def test_an_action_for_what_the_script_wants_means_just_that() -> None:
    rng = np.random.default_rng(2)
    env = TeamFormation([random_world(rng) for _ in range(60)])
    caps = env.worlds.has.shape[2]
    forming = 0
    while env.is_running.any():
        view = env.view()
        wanted = JoinFitting().decide(view).wanted
        spelled, combined = SpellingCodec(caps + 2), CombinationCodec(caps)
        meant = spelled.decode(view, spelled.action_for(view, wanted))
        np.testing.assert_array_equal(meant, wanted)
        meant = combined.decode(view, combined.action_for(view, wanted))  # the nearest with these
        np.testing.assert_array_equal(meant > view.counts, wanted > view.counts)
        forming += int((meant != view.counts).any(axis=1).sum())
        env.step(Decision(wanted))
    assert forming > 100


def test_an_action_for_a_split_by_hand() -> None:
    env = TeamFormation([two_robots_one_task(teams=((0, 1),))])
    kept = np.array([[1, 0, 0]])  # of a, b
    assert CombinationCodec(3).action_for(env.view(), kept).tolist() == [0b1010]  # b goes
    assert SpellingCodec(4).action_for(env.view(), kept).tolist() == [[1, 0, 0, 0]]


class Fixed(OneChoice):
    """Scores two choices by its two weights, whatever it sees."""

    def __init__(self) -> None:
        super().__init__()
        self.scores = nn.Parameter(torch.tensor([math.log(3.0), 0.0]))

    def forward(self, seen: Tensor) -> Tensor:
        return self.scores.expand(len(seen), 2)


def test_the_loss_by_hand() -> None:
    """Choices of 3/4 and 1/4; of four rows the script wants the first in three, then in one."""
    policy = Fixed()
    optimizer = torch.optim.Adam(policy.parameters(), 0.0)
    learner = replace(make_learner(TrainSettings()), policy=policy, policy_optimizer=optimizer)
    still = ImitationSettings(learning_rate=0.0, last_learning_rate=0.0)
    generator = torch.Generator().manual_seed(0)
    for action, loss in (
        ([0, 0, 0, 1], -(3 * math.log(0.75) + math.log(0.25)) / 4),
        ([0, 1, 1, 1], -(math.log(0.75) + 3 * math.log(0.25)) / 4),
    ):
        told = Demonstrations((torch.zeros(4, 1),), torch.tensor(action), 0.0, 0.0)
        assert fit(learner, told, still, 0.0, generator) == pytest.approx(loss)
    often = replace(still, learning_rate=0.05, passes=200, minibatch=4)
    told = Demonstrations((torch.zeros(4, 1),), torch.tensor([0, 1, 1, 1]), 0.0, 0.0)
    fit(learner, told, often, 0.0, generator)
    assert policy.scores.softmax(dim=0).tolist() == pytest.approx([0.25, 0.75], abs=0.01)


def test_a_short_training_learns_whom_to_join() -> None:
    """In a crowd in few places, on worlds that it has not seen; a network that knows nothing
    agrees in less than a tenth."""
    settings = TrainSettings(
        network="teamformer",
        capabilities=12,
        method="imitation",
        worlds=24,
        mixture=Mixture(
            robots=(10, 12), capabilities=(12, 12), tasks=(1, 4), crowds=0.0, grid=(4, 8),
            more_robots=0.0, wide_sensing=0.0, steps=40,
        ),
    )  # fmt: skip
    learner = make_learner(settings)
    first = learn_by_imitation(learner, settings, 0, 0.0).figures
    for number in range(1, 8):
        last = learn_by_imitation(learner, settings, number, number / 8).figures
    print(first, last)
    assert last["agreed"] > 0.9
    assert last["ended"] == 1.0
    assert last["loss"] < first["loss"] / 2
