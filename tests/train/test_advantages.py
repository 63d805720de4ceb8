"""Returns and advantages against sums done by hand, through merges and splits."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from teamformer.model import Grid, Robot, Scenario, Task
from teamformer.nets.critic import Critic, CriticSettings
from teamformer.policies.choices import HALVE, JOIN, MAINTAIN
from teamformer.policies.relations import Relations
from teamformer.sim.arrays import Array
from teamformer.sim.env import TeamFormation
from teamformer.sim.view import View
from teamformer.train import outlook
from teamformer.train.advantages import advantages
from teamformer.train.rollout import MissionReward, Rollout, credit, play


def test_without_decay_it_is_the_surprise() -> None:
    rewards, values = np.array([[1.0], [2.0]]), np.array([[3.0], [4.0], [5.0]])
    found = advantages(rewards, values, np.ones((2, 1), dtype=bool), 0.5, 0.0)
    assert found[:, 0].tolist() == [1 + 0.5 * 4 - 3, 2 + 0.5 * 5 - 4]


def test_with_full_decay_it_is_the_return_less_the_value() -> None:
    rewards, values = np.array([[1.0], [2.0], [4.0]]), np.array([[3.0], [4.0], [5.0], [0.0]])
    found = advantages(rewards, values, np.ones((3, 1), dtype=bool), 0.5, 1.0)
    assert found[:, 0].tolist() == [1 + 1 + 1 - 3, 2 + 2 - 4, 4 - 5]


def test_a_world_that_has_ended_gives_nothing() -> None:
    rewards = np.array([[1.0, 1.0], [1.0, 0.0]])
    values = np.array([[0.5, 0.5], [0.5, 0.0], [8.0, 0.0]])
    is_running = np.array([[True, True], [True, False]])
    found = advantages(rewards, values, is_running, 0.5, 0.5)
    first = 1 + 0.5 * 0.5 - 0.5
    second = 1 + 0.5 * 8 - 0.5  # cut off: the critic says what would have come
    assert found[:, 0].tolist() == [first + 0.5 * 0.5 * second, second]
    assert found[:, 1].tolist() == [0.5, 0.0]


def pair_with_a_task_each_side() -> Scenario:
    """Robots {a}, {a} in one cell as one team; tasks need a: t0 one cell left, t1 two right."""
    return Scenario(
        "pair",
        Grid(4, 1),
        ("a",),
        (Robot("r0", (1, 0), {"a": 1}), Robot("r1", (1, 0), {"a": 1})),
        (Task("t0", (0, 0), {"a": 1}), Task("t1", (3, 0), {"a": 1})),
        teams=((0, 1),),
    )


class _Script:
    """Makes the same choice for all teams that have one, step after step, then maintains."""

    def __init__(self, *choices: int) -> None:
        self.choices = list(choices)

    def __call__(self, view: View, relations: Relations, has_choice: Array) -> tuple[Array, Array]:
        choice = self.choices.pop(0) if self.choices else MAINTAIN
        rows = int(has_choice.sum())
        return np.full(rows, choice), np.zeros(rows, dtype=np.float32)


def zero_critic() -> Critic:
    critic = Critic(
        CriticSettings(outlook.TEAM_FEATURES, outlook.TASK_FEATURES, outlook.WORLD_FEATURES)
    )
    for weights in critic.parameters():
        torch.nn.init.zeros_(weights)
    return critic


def played(*choices: int, steps: int = 50) -> Rollout:
    return play(
        TeamFormation([pair_with_a_task_each_side()]),
        _Script(*choices),
        MissionReward(step=-0.125, done=0.5),
        steps,
    )


def test_parts_of_a_split_share_what_comes_after_it() -> None:
    """Halve; one goes left (done after step 2), the other right (step 3): three steps."""
    rollout = played(HALVE)
    assert rollout.has_ended.tolist() == [True]
    assert rollout.rewards[:, 0].tolist() == [-0.125, 0.375, 0.375]
    assert rollout.state.tolist()[:1] == [0]
    gains, targets = credit(rollout, zero_critic(), 0.5, 1.0)
    by_hand = [-0.125 + 0.5 * 0.375 + 0.25 * 0.375, 0.375 + 0.5 * 0.375, 0.375]
    assert gains.tolist() == pytest.approx(by_hand)
    assert targets.tolist() == pytest.approx(by_hand)
    for state, choice in zip(rollout.state.tolist(), rollout.choice.tolist(), strict=True):
        assert (choice == HALVE) == (state == 0)


def test_a_union_and_both_who_formed_it_are_given_the_same_sums() -> None:
    """Halve, then both ask to join again: both askers and the union share the world's return."""
    rollout = played(HALVE, JOIN)
    both = rollout.choice == JOIN
    assert rollout.state[both].tolist() == [1, 1]
    gains, _ = credit(rollout, zero_critic(), 0.5, 1.0)
    sums = []
    ahead = 0.0
    for reward in rollout.rewards[::-1, 0]:
        ahead = float(reward) + 0.5 * ahead
        sums.insert(0, ahead)
    assert gains.tolist() == pytest.approx(sums)
    assert rollout.rewards.sum() == pytest.approx(2 * 0.5 - 0.125 * len(rollout.rewards))
    assert len(rollout.rewards) > 3


def test_a_trial_cut_off_counts_on_the_critic() -> None:
    rollout, critic = played(HALVE, steps=1), zero_critic()
    assert rollout.has_ended.tolist() == [False]
    torch.nn.init.constant_(critic.out[-1].bias, 2.0)  # type: ignore[arg-type]
    gains, targets = credit(rollout, critic, 0.5, 1.0)
    assert gains.tolist() == [-0.125 + 0.5 * 2.0 - 2.0]
    assert targets.tolist() == [-0.125 + 0.5 * 2.0]
