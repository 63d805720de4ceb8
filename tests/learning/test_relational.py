"""The network: whatever does not matter changes nothing."""

from __future__ import annotations

import pytest
import torch

from teamformer.learning.nets.critic import Critic, CriticSettings
from teamformer.learning.nets.relational import (
    REFUSED,
    RelationalPolicy,
    RelationalSettings,
    RelationTokens,
)

SEEN, TASKS = 5, 4


@pytest.fixture
def network() -> RelationalPolicy:
    torch.manual_seed(0)
    made = RelationalPolicy(RelationalSettings(6, 7, 8, width=16))
    for weights in made.parameters():  # larger than at the start, so that differences would show
        torch.nn.init.normal_(weights, std=0.5)
    return made


def tokens(teams: int = 20) -> RelationTokens:
    torch.manual_seed(1)
    is_legal = torch.rand(teams, 4 + SEEN + TASKS) < 0.6
    is_legal[:, 0] = True
    return RelationTokens(
        torch.randn(teams, 6),
        torch.randn(teams, SEEN, 7),
        torch.randn(teams, TASKS, 8),
        torch.rand(teams, SEEN) < 0.7,
        torch.rand(teams, TASKS) < 0.7,
        is_legal,
    )


@pytest.mark.thorough
def test_illegal_choices_are_refused_and_the_others_sum_to_one(network: RelationalPolicy) -> None:
    given = tokens()
    scores = network(*given)
    assert (scores[~given.is_legal] == REFUSED).all()
    probabilities = scores.softmax(dim=-1)
    assert (probabilities[~given.is_legal] == 0).all()
    torch.testing.assert_close((probabilities * given.is_legal).sum(dim=-1), torch.ones(20))


@pytest.mark.thorough
def test_what_stands_in_padding_changes_nothing(network: RelationalPolicy) -> None:
    given = tokens()
    legal = given.is_legal.clone()
    legal[:, 4 : 4 + SEEN] &= given.is_team  # padding can be neither joined nor split for
    legal[:, 4 + SEEN :] &= given.is_task
    given = given._replace(is_legal=legal)
    teams, tasks = given.teams.clone(), given.tasks.clone()
    teams[~given.is_team], tasks[~given.is_task] = 100.0, -100.0
    torch.testing.assert_close(network(*given._replace(teams=teams, tasks=tasks)), network(*given))


def test_order_of_tokens_changes_only_the_order_of_choices(network: RelationalPolicy) -> None:
    given, seen, tasks = tokens(), torch.randperm(SEEN), torch.randperm(TASKS)
    places = torch.cat([torch.arange(4), 4 + seen, 4 + SEEN + tasks])
    shuffled = RelationTokens(
        given.own,
        given.teams[:, seen],
        given.tasks[:, tasks],
        given.is_team[:, seen],
        given.is_task[:, tasks],
        given.is_legal[:, places],
    )
    torch.testing.assert_close(network(*shuffled), network(*given)[:, places])


def test_other_teams_in_a_batch_change_nothing(network: RelationalPolicy) -> None:
    given = tokens()
    alone = torch.cat([network(*(part[i : i + 1] for part in given)) for i in range(20)])
    torch.testing.assert_close(alone, network(*given), rtol=1e-4, atol=1e-4)


def test_following_is_likely_at_the_start() -> None:
    torch.manual_seed(2)
    network = RelationalPolicy(RelationalSettings(6, 7, 8))
    given = tokens()._replace(is_legal=torch.ones(20, 13, dtype=torch.bool))
    scores = [4.0, 2.0] + (2 + SEEN + TASKS) * [0.0]
    expected = torch.tensor(scores).softmax(dim=0)[0].item()
    assert network(*given).softmax(dim=-1)[:, 0].tolist() == pytest.approx(
        [expected] * 20, abs=0.05
    )


@pytest.mark.parametrize("is_per_team", [False, True])
def test_critic_sees_no_padding_and_no_order(is_per_team: bool) -> None:
    torch.manual_seed(3)
    critic = Critic(CriticSettings(4, 5, 3, is_per_team))
    teams, is_team = torch.randn(6, 5, 4), torch.rand(6, 5) < 0.6
    tasks, is_task = torch.randn(6, 7, 5), torch.rand(6, 7) < 0.6
    world = torch.randn(6, 3)
    value = critic(teams, is_team, tasks, is_task, world)
    assert value.shape == ((6, 5) if is_per_team else (6, 1))
    order = torch.randperm(7)
    shuffled = critic(teams, is_team, tasks[:, order], is_task[:, order], world)
    torch.testing.assert_close(shuffled, value)
    teams[~is_team] = 50.0
    torch.testing.assert_close(critic(teams, is_team, tasks, is_task, world), value)
    if is_per_team:
        assert (value[~is_team] == 0).all()
        turned = critic(teams.flip(1), is_team.flip(1), tasks, is_task, world)
        torch.testing.assert_close(turned.flip(1), value)
