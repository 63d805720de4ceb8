"""The lower bound against every schedule there is, and against trials under the step rules."""

from __future__ import annotations

import numpy as np
import pytest

from plain_plans import fastest_makespan, tiny_world
from random_worlds import random_world
from small_worlds import make, robot, task
from teamformer.methods.by_name import load_method
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.methods.seam.protocol import Policy
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.bounds.makespan import bound_makespan, lower_bound
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.planning.relaxation.solve import solve
from teamformer.trials.trial import run_trial, run_trials


def walking_bound(mission: Mission) -> int:
    """Return the bound that holds if forming is free, too."""
    return bound_makespan(relax(mission))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.thorough
def test_no_schedule_is_faster(seed: int) -> None:
    rng = np.random.default_rng(seed)
    gaps = []
    for _ in range(400):
        mission = tiny_world(rng)
        fastest = fastest_makespan(mission)
        assert fastest is not None
        gaps.append(fastest - walking_bound(mission))
    assert min(gaps) == 0
    assert np.mean(gaps) < 0.5


@pytest.mark.parametrize("policy", [JoinAll(), Heuristic()])
@pytest.mark.thorough
def test_no_trial_is_faster(policy: Policy) -> None:
    """At uneven speeds too, where a team does tasks in passing, and with robots that are lost."""
    rng = np.random.default_rng(0)
    missions = [random_world(rng) for _ in range(400)]
    tallies = run_trials(missions, policy)
    completed = [
        (lower_bound(mission), tally.steps)
        for mission, tally in zip(missions, tallies, strict=True)
        if tally.status == "completed"
    ]
    assert len(completed) > 300
    assert all(bound <= steps for bound, steps in completed)
    assert any(bound == steps for bound, steps in completed)


def test_waits_for_the_last_that_is_needed() -> None:
    """Two of three a's and the b must come: the second a after 4 steps, b after 6.

    a a . . . T . . . . . b        appears after 8 steps: 9, and stays 2: 11
    """
    robots = [robot("a", 0), robot("a", 1), robot("a", 19), robot("b", 11)]
    assert walking_bound(make(robots, [task("a", 5)])) == 4
    assert walking_bound(make(robots, [task("aa", 5)])) == 5
    assert walking_bound(make(robots, [task("aab", 5)])) == 6
    assert walking_bound(make(robots, [task("aaa", 5)])) == 14
    assert walking_bound(make(robots, [task("aab", 5, duration=2, appears=8)])) == 11


def test_one_robot_walks_to_all_its_tasks() -> None:
    """T . . a . . . . U: first the nearer end, then back: 3 + 8."""
    assert walking_bound(make([robot("a", 3)], [task("a", 0), task("a", 8)])) == 11


def test_two_robots_share_what_they_have_to_walk() -> None:
    """Each end needs both: whichever comes first, 3 + 8 for each, and they cannot share."""
    robots = [robot("a", 3), robot("a", 3)]
    tasks = [task("a", 0), task("a", 8)]
    assert walking_bound(make(robots, tasks)) == 5
    assert walking_bound(make(robots, [task("aa", 0), task("aa", 8)])) >= 8


def test_slow_robots_do_tasks_in_passing() -> None:
    """At 0.8 cells a step two cells take 3 steps, although two legs of one take 2 + 2."""
    tasks = [task("a", 1), task("a", 2)]
    assert walking_bound(make([robot("a", 0, speed=0.8)], tasks)) <= 3
    assert walking_bound(make([robot("a", 0)], tasks)) == 2


def test_a_task_beyond_all_robots_bounds_nothing() -> None:
    mission = make([robot("a", 0, lost=3), robot("b", 0)], [task("a", 9), task("b", 4)])
    assert walking_bound(mission) == 4


def test_a_load_that_is_set_down_is_brought_by_several_teams_and_bounded_all_the_same() -> None:
    """a and b have it up at x = 1 in step 2, and b is lost at x = 9 in step 10; c waits at 10.

    c joins a there and they go on: much sooner than if c had come all the way to fetch it, which
    takes its 9 steps to x = 1, one to join and 10 with the load.
    """
    robots = (
        Robot("a", (0, 0), {"lift": 1}),
        Robot("b", (0, 0), {"lift": 1}, absences=(Absence(10),)),
        Robot("c", (10, 0), {"lift": 1}),
    )
    crate = Task("crate", (1, 0), {"lift": 2}, to=(11, 0))
    mission = Mission("relay", Grid(12, 1), ("lift",), robots, (crate,))
    makespan = run_trial(mission, load_method("plan"), 0).record.end.makespan
    assert makespan is not None
    assert lower_bound(mission) <= makespan < 9 + 1 + 10
    assert lower_bound(mission) == 2 + 10  # one step to join, one to walk, and ten with the crate
    assert solve(mission, 0.5).bound <= makespan
