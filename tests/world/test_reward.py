"""Eq. 1 by hand: alpha 7, delta 2, beta 1 unless said otherwise."""

from __future__ import annotations

import pytest

from small_worlds import make, play, robot, task, two_robots_one_task
from teamformer.world.env import TeamFormation
from teamformer.world.reward import Reward


def test_a_step_costs_and_what_fits_pays() -> None:
    """T needs a and b; each robot brings one of two: -2 + 1/2."""
    env = TeamFormation([two_robots_one_task()])
    play(env)
    assert env.rewards[0].tolist() == [-1.5, -1.5]


def test_what_is_not_needed_costs() -> None:
    """The team aacc for T (a, b, c): c+ is a and c, c- is a and c again: -2 + (2 - 2) / 3."""
    robots = [robot("aacc", 0), robot("b", 0)]
    env = TeamFormation([make(robots, [task("abc", 5)])])
    play(env)
    assert env.rewards[0].tolist() == pytest.approx([-2, -2 + 1 / 3])


def test_doing_the_task_pays() -> None:
    """A team with exactly what is needed: 7 + 1 in the step of completion."""
    env = TeamFormation([two_robots_one_task(teams=((0, 1),))])
    play(env, 2)
    assert env.rewards[0].tolist() == [-1.0, 0.0]
    play(env)
    assert env.rewards[0].tolist() == [8.0, 0.0]


def test_a_join_counts_as_the_union() -> None:
    env = TeamFormation([two_robots_one_task()])
    play(env, joins={0: 1})
    assert env.rewards[0].tolist() == [-1.0, 0.0]


def test_without_assignment_only_the_step_counts() -> None:
    env = TeamFormation([make([robot("a", 0), robot("b", 0)], [task("a", 3)])])
    play(env)
    assert env.rewards[0].tolist() == [-1.0, -2.0]


def test_a_task_done_in_passing_pays_as_well() -> None:
    """U at 3 is done on the way to T at 5, which needs a and b: 7 + 1/2 for a."""
    tasks = [task("ab", 5), task("a", 3), task("ab", 1)]
    env = TeamFormation([make([robot("a", 0), robot("b", 19)], tasks, sensing_radius=0)])
    play(env, 3)
    assert env.worlds.tasks["done_at"][0, 1] == 3
    assert env.rewards[0, 0] == 7.5


def test_only_the_team_that_did_it_is_paid() -> None:
    robots = [robot("a", 0), robot("a", 2)]
    env = TeamFormation([make(robots, [task("a", 1), task("aa", 9)], sensing_radius=0)])
    play(env)
    assert env.rewards[0].tolist() == [8.0, -1.0]


@pytest.mark.thorough
def test_weights_are_settings() -> None:
    reward = Reward(done=10, step=0.5, fit=3)
    env = TeamFormation([two_robots_one_task(teams=((0, 1),))], reward)
    play(env)
    assert env.rewards[0].tolist() == [2.5, 0.0]
    play(env, 2)
    assert env.rewards[0].tolist() == [13.0, 0.0]


def test_worlds_that_are_over_give_nothing() -> None:
    short = make([robot("a", 0)], [task("a", 1)])
    env = TeamFormation([short, two_robots_one_task()])
    play(env)
    assert env.rewards.tolist() == [[8.0, 0.0], [-1.5, -1.5]]
    play(env)
    assert env.rewards.tolist() == [[0.0, 0.0], [-1.5, -1.5]]


def test_the_loss_of_the_lowest_robot_keeps_the_task_in_mind() -> None:
    """b and a are left of a team for T (a, b) when the first robot is lost: -2 + 2/2."""
    robots = [robot("a", 0, lost=1), robot("b", 0), robot("a", 0)]
    env = TeamFormation([make(robots, [task("ab", 5)], teams=((0, 1, 2),))])
    play(env)
    assert env.rewards[0].tolist() == [0.0, -1.0, 0.0]
