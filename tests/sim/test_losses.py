"""Robots that come back: where, to whom, and what waits for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_world
from small_worlds import done_at, make, places, play, robot, task, teams_of
from teamformer.errors import ScenarioError
from teamformer.model import Robot, Scenario
from teamformer.policies import POLICIES
from teamformer.referee import judge
from teamformer.sim.env import TeamFormation
from teamformer.trials.registry import load_policy
from teamformer.trials.trial import Trial, run_trial


def away(able: str, at: int, lost: int, back: int) -> Robot:
    return replace(robot(able, at, lost=lost), back=back)


def trial_of(world: Scenario, policy: str) -> Trial:
    return run_trial(world, load_policy(policy, POLICIES), policy)


def test_it_is_back_alone_where_it_was_lost() -> None:
    """a and b walk from 0 to 9 together; b is lost in step 3 at place 3 and back in step 6."""
    robots = [robot("a", 0), away("b", 0, 3, 6)]
    env = TeamFormation([make(robots, [task("ab", 9)], teams=((0, 1),))])
    play(env, 5)
    assert teams_of(env) == {0: [0]}
    assert places(env) == {0: 5}
    play(env, 1)
    assert teams_of(env) == {0: [0], 1: [1]}
    assert places(env) == {0: 6, 1: 3}
    play(env, 6)  # b walks from 3 to 9
    assert places(env) == {0: 9, 1: 9}
    play(env, joins={1: 0})
    assert done_at(env) == [13]


def test_the_lowest_robot_takes_its_slot_again() -> None:
    robots = [away("a", 0, 2, 4), robot("b", 0)]
    env = TeamFormation([make(robots, [task("b", 9)], teams=((0, 1),))])
    play(env, 3)
    assert teams_of(env) == {1: [1]}
    play(env, 1)
    assert teams_of(env) == {0: [0], 1: [1]}
    assert places(env) == {0: 2, 1: 4}


@pytest.mark.parametrize("allocation", ["paper", "nearest", "crews", "plan"])
def test_what_waits_for_it_does_not_end_the_trial(allocation: str) -> None:
    """Only b can do the task at 5; it is lost at 3 in step 3, back in 5, and there in step 7."""
    robots = [robot("a", 15), away("b", 0, 3, 5)]
    world = make(robots, [task("b", 5), task("a", 19)], allocation=allocation)
    trial = trial_of(world, "join-fitting")
    assert judge(trial.replay).findings == ()
    assert trial.replay.end.status == "completed"
    assert trial.replay.end.makespan == 7
    assert dict(trial.replay.steps[3].done) == {1: 0}
    assert trial.replay.steps[4].back == (1,)


def test_without_anybody_left_time_goes_on_until_somebody_is_back() -> None:
    world = make([away("a", 0, 2, 6)], [task("a", 4)])
    for listing in POLICIES:
        trial = trial_of(world, listing.name)
        assert trial.replay.end.makespan == 8, listing.name  # 2 steps, 4 away, 2 more
        assert judge(trial.replay).findings == ()


def test_the_shared_plan_is_made_anew_when_a_robot_is_back() -> None:
    robots = [robot("a", 0), away("a", 0, 2, 4)]
    world = make(robots, [task("a", 9), task("a", 1)], allocation="plan")
    plans = dict(trial_of(world, "follow-plan").replay.plans)
    assert {steps: plan.reasons for steps, plan in plans.items()} == {
        0: ("start",),
        2: ("robot lost",),
        4: ("robot back",),
    }


@pytest.mark.parametrize("is_plane", [False, True])
@pytest.mark.parametrize("allocation", ["paper", "crews", "plan"])
def test_nothing_blocks_whoever_comes_back(allocation: str, is_plane: bool) -> None:
    rng, worlds = np.random.default_rng(11), []
    while len(worlds) < 12:
        world = random_world(rng, is_plane=is_plane)
        if any(robot.back is not None for robot in world.robots):
            worlds.append(replace(world, allocation=allocation))
    ends = []
    for world in worlds:
        trial = trial_of(world, "join-fitting")
        assert judge(trial.replay).findings == ()
        ends.append(trial.replay.end.status)
    assert set(ends) <= {"completed", "infeasible"}
    assert ends.count("completed") >= 6


@pytest.mark.parametrize(
    ("lost", "back", "said"),
    [
        (None, 4, "robot 'r0' is back but never lost; add lost or drop back"),
        (4, 4, "robot 'r0' is lost at step 4 and back at step 4; it must be back later"),
        (4, 5.5, "back at step 5.5; use a whole number"),
    ],
)
def test_returns_that_cannot_be(lost: int | None, back: float, said: str) -> None:
    robots = (Robot("r0", (0, 0), {"a": 1}, lost=lost, back=back),)  # type: ignore[arg-type]
    good = make([robot("a", 0)], [task("a", 4)])
    with pytest.raises(ScenarioError) as caught:
        Scenario("bad", good.world, good.capabilities, robots, good.tasks)
    assert said in str(caught.value)
