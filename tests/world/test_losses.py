"""Robots that come back: where, to whom, and what waits for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_world
from small_worlds import done_at, make, places, play, robot, task, teams_of
from teamformer.base.errors import MissionError
from teamformer.methods.by_name import load_method
from teamformer.methods.listings import our_method_names
from teamformer.mission.model import Absence, Mission, Robot
from teamformer.record.referee import judge
from teamformer.trials.trial import PlayedTrial, run_trial
from teamformer.world.env import TeamFormation


def away(able: str, at: int, lost: int, back: int) -> Robot:
    return replace(robot(able, at), absences=(Absence(lost, back),))


def trial_of(world: Mission, name: str) -> PlayedTrial:
    return run_trial(world, load_method(name))


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


@pytest.mark.parametrize("method", ["join-fitting", "crews", "plan"])
def test_it_may_be_lost_again_and_again(method: str) -> None:
    """a walks to 9: two steps, away for three, four steps, away for two, the last three steps.

    Others in the batch are lost once, or never.
    """
    often = replace(robot("a", 0), absences=(Absence(3, 6), Absence(10, 12), Absence(40)))
    worlds = [
        make([often], [task("a", 9)]),
        make([away("a", 0, 3, 6)], [task("a", 9)]),
        make([robot("a", 0)], [task("a", 9)]),
    ]
    trials = [trial_of(world, method) for world in worlds]
    assert [trial.record.end.makespan for trial in trials] == [14, 12, 9]
    lost = [n for n, step in enumerate(trials[0].record.steps, start=1) if step.lost]
    back = [n for n, step in enumerate(trials[0].record.steps, start=1) if step.back]
    assert (lost, back) == ([3, 10], [6, 12])
    assert judge(trials[0].record).findings == ()
    env = TeamFormation(worlds)
    play(env, 13)
    assert [env.tally(w).steps for w in range(3)] == [13, 12, 9]
    play(env, 1)
    assert (env.tally(0).status, env.tally(0).steps) == ("completed", 14)


def test_what_waits_for_it_is_given_up_when_it_is_lost_for_good() -> None:
    """b is at 2 when it is lost, at 4 when it is lost again: its task at 5 is never done."""
    often = replace(robot("b", 0), absences=(Absence(3, 5), Absence(7)))
    record = trial_of(make([often], [task("b", 5)]), "join-fitting").record
    assert (record.end.status, record.end.steps) == ("infeasible", 7)
    assert record.end.blocked_tasks == ("t0",)
    assert judge(record).findings == ()


def test_the_lowest_robot_takes_its_slot_again() -> None:
    robots = [away("a", 0, 2, 4), robot("b", 0)]
    env = TeamFormation([make(robots, [task("b", 9)], teams=((0, 1),))])
    play(env, 3)
    assert teams_of(env) == {1: [1]}
    play(env, 1)
    assert teams_of(env) == {0: [0], 1: [1]}
    assert places(env) == {0: 2, 1: 4}


@pytest.mark.parametrize("method", ["join-fitting", "crews", "plan"])
def test_what_waits_for_it_does_not_end_the_trial(method: str) -> None:
    """Only b can do the task at 5; it is lost at 3 in step 3, back in 5, and there in step 7."""
    robots = [robot("a", 15), away("b", 0, 3, 5)]
    world = make(robots, [task("b", 5), task("a", 19)])
    trial = trial_of(world, method)
    assert judge(trial.record).findings == ()
    assert trial.record.end.status == "completed"
    assert trial.record.end.makespan == 7
    assert dict(trial.record.steps[3].done) == {1: 0}
    assert trial.record.steps[4].back == (1,)


def test_who_is_due_back_after_all_steps_ends_no_trial() -> None:
    """In a later step than the worlds' arrays can say."""
    world = make([away("a", 0, 1, 2 * 10**9)], [task("a", 9)], step_limit=4)
    trial = trial_of(world, "join-fitting")
    assert (trial.record.end.status, trial.record.end.steps) == ("step limit", 4)
    assert judge(trial.record).findings == ()


def test_without_anybody_left_time_goes_on_until_somebody_is_back() -> None:
    world = make([away("a", 0, 2, 6)], [task("a", 4)])
    for name in our_method_names():
        trial = run_trial(world, load_method(name))
        assert trial.record.end.makespan == 8, name  # 2 steps, 4 away, 2 more
        assert judge(trial.record).findings == ()


def test_the_shared_plan_is_made_anew_when_a_robot_is_back() -> None:
    robots = [robot("a", 0), away("a", 0, 2, 4)]
    world = make(robots, [task("a", 9), task("a", 1)])
    plans = dict(trial_of(world, "plan").record.plans)
    assert {steps: plan.reasons for steps, plan in plans.items()} == {
        0: ("start",),
        2: ("robot lost",),
        4: ("robot back",),
    }


@pytest.mark.parametrize("is_plane", [False, True])
@pytest.mark.parametrize("method", ["join-fitting", "crews", "plan"])
@pytest.mark.thorough
def test_nothing_blocks_whoever_comes_back(method: str, is_plane: bool) -> None:
    rng, worlds = np.random.default_rng(11), []
    while len(worlds) < 12:
        world = random_world(rng, is_plane=is_plane)
        if any(away.back is not None for robot in world.robots for away in robot.absences):
            worlds.append(world)
    ends = []
    for world in worlds:
        trial = trial_of(world, method)
        assert judge(trial.record).findings == ()
        ends.append(trial.record.end.status)
    assert set(ends) <= {"completed", "infeasible"}
    assert ends.count("completed") >= 6


@pytest.mark.parametrize(
    ("absences", "said"),
    [
        ([(4, 4)], "robot 'r0' is lost at step 4 and back at step 4; it must be back later"),
        ([(4, 5.5)], "back at step 5.5; use a whole number"),
        ([(4, 6), (6, 9)], "is back at step 6 and lost at step 6; it must be lost later"),
        (
            [(4, None), (6, 9)],
            "robot 'r0' is lost at step 6, but was lost in step 4; write under back when it "
            "returns, or drop one of the two",
        ),
    ],
)
def test_absences_that_cannot_be(absences: list[tuple[int, int]], said: str) -> None:
    robots = (Robot("r0", (0, 0), {"a": 1}, absences=tuple(Absence(*steps) for steps in absences)),)
    good = make([robot("a", 0)], [task("a", 4)])
    with pytest.raises(MissionError) as caught:
        Mission("bad", good.world, good.capabilities, robots, good.tasks)
    assert said in str(caught.value)
