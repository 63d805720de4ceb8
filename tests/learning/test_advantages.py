"""Returns and advantages against sums done by hand, through merges and splits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from small_worlds import pair_with_a_task_each_side
from teamformer.base.array_types import Array
from teamformer.learning.algorithms import global_state
from teamformer.learning.algorithms.advantages import advantages, credit, stream_values
from teamformer.learning.algorithms.reward_streams import MissionReward, TeamReward
from teamformer.learning.algorithms.rollout import Rollout, play
from teamformer.learning.nets.critic import Critic, CriticSettings
from teamformer.methods.learned.any_fleet import AnyFleetCodec
from teamformer.methods.learned.macro_actions import HALVE, JOIN, MAINTAIN
from teamformer.mission.model import Absence
from teamformer.world.env import TeamFormation


def streams(*rows: list[float]) -> Array:
    """Return one stream for each world, as (steps, worlds, 1)."""
    return np.array(rows)[:, :, None]


def test_without_decay_it_is_the_surprise() -> None:
    rewards, values = streams([1.0], [2.0]), streams([3.0], [4.0], [5.0])
    found = advantages(rewards, values, np.ones((2, 1), dtype=bool), 0.5, 0.0)
    assert found[:, 0, 0].tolist() == [1 + 0.5 * 4 - 3, 2 + 0.5 * 5 - 4]


def test_with_full_decay_it_is_the_return_less_the_value() -> None:
    rewards, values = streams([1.0], [2.0], [4.0]), streams([3.0], [4.0], [5.0], [0.0])
    found = advantages(rewards, values, np.ones((3, 1), dtype=bool), 0.5, 1.0)
    assert found[:, 0, 0].tolist() == [1 + 1 + 1 - 3, 2 + 2 - 4, 4 - 5]


def test_a_world_that_has_ended_gives_nothing() -> None:
    rewards = streams([1.0, 1.0], [1.0, 0.0])
    values = streams([0.5, 0.5], [0.5, 0.0], [8.0, 0.0])
    is_running = np.array([[True, True], [True, False]])
    found = advantages(rewards, values, is_running, 0.5, 0.5)
    first = 1 + 0.5 * 0.5 - 0.5
    second = 1 + 0.5 * 8 - 0.5  # cut off: the critic says what would have come
    assert found[:, 0, 0].tolist() == [first + 0.5 * 0.5 * second, second]
    assert found[:, 1, 0].tolist() == [0.5, 0.0]


class _Script:
    """Makes the same choice for all teams that have one, step after step, then maintains."""

    def __init__(self, *choices: int) -> None:
        self.choices = list(choices)

    def __call__(self, tokens: tuple[Array, ...]) -> tuple[Array, Array]:
        choice = self.choices.pop(0) if self.choices else MAINTAIN
        rows = len(tokens[0])
        return np.full(rows, choice), np.zeros(rows, dtype=np.float32)


def zero_critic(is_per_team: bool = False) -> Critic:
    features = global_state.TEAM_FEATURES, global_state.TASK_FEATURES, global_state.WORLD_FEATURES
    critic = Critic(CriticSettings(*features, is_per_team))
    for weights in critic.parameters():
        torch.nn.init.zeros_(weights)
    return critic


MISSION = MissionReward(step=-0.125, done=0.5)


def played(*choices: int, steps: int = 50, reward: MissionReward | TeamReward = MISSION) -> Rollout:
    env = TeamFormation([pair_with_a_task_each_side()], reward.of_environment)
    return play(env, AnyFleetCodec(), _Script(*choices), reward, steps)


def test_parts_of_a_split_share_what_comes_after_it() -> None:
    """Halve; one goes left (done after step 2), the other right (step 3): three steps."""
    rollout = played(HALVE)
    assert rollout.has_ended.tolist() == [True]
    assert rollout.rewards[:, 0, 0].tolist() == [-0.125, 0.375, 0.375]
    assert rollout.state.tolist()[:1] == [0]
    found = credit(rollout, zero_critic(), 0.5, 1.0)
    by_hand = [-0.125 + 0.5 * 0.375 + 0.25 * 0.375, 0.375 + 0.5 * 0.375, 0.375]
    assert found.gain.tolist() == pytest.approx([by_hand[s] for s in rollout.state.tolist()])
    assert found.target[:, 0].tolist() == pytest.approx(by_hand)
    for state, choice in zip(rollout.state.tolist(), rollout.action.tolist(), strict=True):
        assert (choice == HALVE) == (state == 0)


def test_a_union_and_both_who_formed_it_are_given_the_same_sums() -> None:
    """Halve, then both ask to join again: both askers and the union share the world's return."""
    rollout = played(HALVE, JOIN)
    both = rollout.action == JOIN
    assert rollout.state[both].tolist() == [1, 1]
    found = credit(rollout, zero_critic(), 0.5, 1.0)
    sums = []
    ahead = 0.0
    for reward in rollout.rewards[::-1, 0, 0]:
        ahead = float(reward) + 0.5 * ahead
        sums.insert(0, ahead)
    assert found.gain.tolist() == pytest.approx([sums[s] for s in rollout.state.tolist()])
    assert rollout.rewards.sum() == pytest.approx(2 * 0.5 - 0.125 * len(rollout.rewards))
    assert len(rollout.rewards) > 3


def test_a_trial_cut_off_counts_on_the_critic() -> None:
    rollout, critic = played(HALVE, steps=1), zero_critic()
    assert rollout.has_ended.tolist() == [False]
    torch.nn.init.constant_(critic.out[-1].bias, 2.0)  # type: ignore[arg-type]
    found = credit(rollout, critic, 0.5, 1.0)
    assert found.gain.tolist() == [-0.125 + 0.5 * 2.0 - 2.0]
    assert found.target.tolist() == [[-0.125 + 0.5 * 2.0]]


def opinionated_critic() -> Critic:
    """Return a critic that says something else of every state."""
    torch.manual_seed(3)
    features = global_state.TEAM_FEATURES, global_state.TASK_FEATURES, global_state.WORLD_FEATURES
    critic = Critic(CriticSettings(*features, False))
    for weights in critic.parameters():
        torch.nn.init.normal_(weights, std=0.3)
    return critic


@pytest.mark.parametrize("steps", [2, 50], ids=["cut off", "to the end"])
def test_what_the_critic_says_of_each_state_counts_where_it_was_said(steps: int) -> None:
    """Two worlds, of which one ends earlier: each has a plain sum over its own states.

    Sum from a state on: of (reward + 0.5 * the next state's value - its own), each step farther
    on counting 0.5 * 0.7 of the one before; after the last step of a trial that has ended there
    is nothing, and where it was cut off there is what the critic says of its last state.
    """
    near = pair_with_a_task_each_side()
    near = replace(near, tasks=(near.tasks[0], replace(near.tasks[0], name="t1")))
    env = TeamFormation([near, pair_with_a_task_each_side()], MISSION.of_environment)
    rollout, critic = play(env, AnyFleetCodec(), _Script(), MISSION, steps), opinionated_critic()
    assert rollout.is_running.sum(axis=0).tolist() == ([1, 2] if steps == 2 else [1, 4])
    assert rollout.has_ended.tolist() == [True, steps == 50]
    found = credit(rollout, critic, 0.5, 0.7)
    with torch.no_grad():
        said = critic(*rollout.global_state)[:, 0].tolist()
        at_last = critic(*rollout.last_global_state)[:, 0].tolist()
    assert len({round(value, 4) for value in (*said, *at_last)}) > len(said)
    state_of, number = {}, 0
    for step, running in enumerate(rollout.is_running):
        for world in np.flatnonzero(running).tolist():
            state_of[step, world], number = number, number + 1
    for (step, world), state in state_of.items():
        gain, weight = 0.0, 1.0
        for now in range(step, len(rollout.rewards)):
            if (now, world) not in state_of:
                break
            after = state_of.get((now + 1, world))
            ahead = said[after] if after is not None else 0.0
            if after is None and not rollout.has_ended[world]:
                ahead = at_last[world]
            value = said[state_of[now, world]]
            gain += weight * (float(rollout.rewards[now, world, 0]) + 0.5 * ahead - value)
            weight *= 0.5 * 0.7
        assert found.target[state, 0].item() == pytest.approx(gain + said[state], abs=1e-5)
        for row in np.flatnonzero(rollout.state.numpy() == state):
            assert found.gain[row].item() == pytest.approx(gain, abs=1e-5)


def test_a_stream_without_a_value_is_worth_nothing() -> None:
    values = torch.tensor([[3.0, 5.0], [7.0, 9.0]])  # two states, of two teams
    value_of = torch.tensor([[1, 0, -1], [-1, 1, 1]])  # three robots each
    assert stream_values(values, value_of).tolist() == [[5.0, 3.0, 0.0], [0.0, 9.0, 9.0]]


def test_lost_robots_are_not_there() -> None:
    """r1 is missing after step 2, so that it has no stream in the third state."""
    near = pair_with_a_task_each_side()
    near = replace(near, robots=(near.robots[0], replace(near.robots[1], absences=(Absence(2),))))
    env, reward = TeamFormation([near]), TeamReward(scale=1.0)
    rollout = play(env, AnyFleetCodec(), _Script(), reward, 3)
    found = credit(rollout, zero_critic(is_per_team=True), 0.5, 1.0)
    assert rollout.value_of[0].min() == 0  # the first team counts, too
    assert found.is_there.tolist() == [[True, True], [True, True], [True, False]]


def test_a_robots_stream_goes_on_through_a_split_and_a_merge() -> None:
    """Eq. 1 with done 7, step 2, fit 1: halve, then both ask to join, then go as one.

    Step 1: the team of two is halved; r0 and r1 have no task yet when they split, get one in
    allocation and earn -2 + 1. Afterwards each robot earns what its team of the time earns.
    """
    reward = TeamReward(scale=1.0)
    rollout = played(HALVE, JOIN, reward=reward)
    earned = rollout.rewards[:, 0]  # (steps, robots)
    assert earned[0].tolist() == [-1.0, -1.0]
    together = (rollout.value_of[:, 0] == rollout.value_of[:, 1]).numpy()
    assert together[0]
    assert not together[1]  # halved in step 1
    for step in range(len(earned) - 1):
        if together[step + 1]:  # one team after the step, so that both earned the same
            assert earned[step, 0] == earned[step, 1]
    found = credit(rollout, zero_critic(is_per_team=True), 0.5, 1.0)
    sums = np.zeros_like(earned)
    ahead = np.zeros(2)
    for step in range(len(earned) - 1, -1, -1):
        ahead = earned[step] + 0.5 * ahead
        sums[step] = ahead
    np.testing.assert_allclose(found.target.numpy(), sums, rtol=1e-6)
    first = rollout.state.tolist().index(0)
    assert found.gain[first].item() == pytest.approx(sums[0].mean())  # one team of both robots
    for row in np.flatnonzero(rollout.state.numpy() == 1):
        [robot] = np.flatnonzero(rollout.share[row].numpy())
        assert found.gain[row].item() == pytest.approx(sums[1, robot])
