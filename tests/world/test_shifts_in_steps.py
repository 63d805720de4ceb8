"""Robots that work in shifts in missions in steps: by hand, and kernels beside plain rules."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import random_decision, random_world, with_loads, with_shifts, with_surprises
from small_worlds import at_work, done_at, make, places, play, robot, service, task
from teamformer.base.errors import MissionError
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Delays, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.truth import draw_truth
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation
from twins import Twin


def walked(mission: Mission, steps: int) -> list[int]:
    """Return where the team of the first robot is after each step."""
    env, seen = TeamFormation([mission]), []
    for _ in range(steps):
        play(env)
        seen.append(places(env)[0])
    return seen


def test_a_walk_pauses_between_shifts() -> None:
    """It works in steps 3, 4 and 5, and again in 8, 9 and 10; at half a cell a step it saves."""
    way = make([robot("a", 0)], [task("a", 10)])
    assert walked(at_work(way, ((2, 5), (7, 10), (50, 90))), 11) == [
        0,
        0,
        1,
        2,
        3,
        3,
        3,
        4,
        5,
        6,
        6,
    ]
    assert walked(at_work(way, ((2, 5),), every=5), 11) == [0, 0, 1, 2, 3, 3, 3, 4, 5, 6, 6]
    slow = make([robot("a", 0, speed=0.5)], [task("a", 10)])
    assert walked(at_work(slow, ((2, 5), (7, 10), (50, 90))), 11) == [
        0,
        0,
        0,
        1,
        1,
        1,
        1,
        2,
        2,
        3,
        3,
    ]


def test_a_team_walks_while_all_its_robots_work() -> None:
    way = make([robot("a", 0), robot("a", 0)], [task("a", 10)], teams=((0, 1),))
    assert walked(at_work(way, ((0, 4), (6, 9), (50, 90)), ((2, 8), (50, 90))), 9) == [
        0,
        0,
        1,
        2,
        2,
        2,
        3,
        4,
        4,
    ]
    assert walked(at_work(way, ((0, 2), (2, 4), (50, 90)), ()), 5) == [
        1,
        2,
        3,
        4,
        4,
    ]  # over a border


def test_a_task_begins_if_it_fits_into_a_shift_of_each() -> None:
    """They are there after a step; three steps of service fit from 5 on, when both work."""
    mission = at_work(service(3), ((0, 3), (5, 8)), ())
    env = TeamFormation([mission])
    play(env, 8)
    assert done_at(env) == [8]
    just = TeamFormation([at_work(service(3), ((0, 4),), ())])
    play(just, 4)
    assert done_at(just) == [4]


def test_what_takes_no_time_is_done_as_a_shift_ends() -> None:
    env = TeamFormation([at_work(make([robot("a", 0)], [task("a", 3)]), ((0, 3),))])
    play(env, 3)
    assert done_at(env) == [3]


def test_a_service_that_lasts_longer_than_believed_breaks_off_as_a_shift_ends() -> None:
    """It is believed to take two steps and takes four: from 1 on, broken off in step 5 after four.

    From 10 on it is done at 14. Shifts that touch are two.
    """
    mission = service(2)
    unsure = replace(mission, tasks=(replace(mission.tasks[0], lasts=(1, 4)),))
    for first in (((0, 4), (10, 20)), ((0, 4), (4, 5), (10, 20))):
        known = at_work(unsure, first, ())
        truth = replace(known, tasks=(replace(known.tasks[0], lasts=None, duration=4),))
        env = TeamFormation([known], truths=[truth])
        play(env, 4)
        assert env.worlds.teams["serves"][0, 0] == 1
        play(env)
        assert env.worlds.teams["serves"][0, 0] == 0
        play(env, 9)
        assert done_at(env) == [14]


def test_a_load_is_taken_up_if_it_can_be_brought_in_one_shift() -> None:
    """Two steps to take it up, four to carry it, one to unload: 7 from step 8 on."""
    load = Task("load", (2, 0), {"a": 1}, duration=2, to=(6, 0), unload=1)
    mission = Mission("load", Grid(9, 1), ("a",), (Robot("r", (2, 0), {"a": 1}),), (load,))
    env = TeamFormation([at_work(mission, ((0, 7), (8, 15)))], coordinator=SharedPlan())
    for _ in range(15):
        env.step(env.planned_decision(env.view()))
    assert done_at(env) == [15]


def test_robots_join_while_both_work_and_part_at_any_time() -> None:
    both = make([robot("a", 3), robot("b", 3)], [task("ab", 3)])
    mission = at_work(both, ((0, 4),), ((2, 9),))
    env = TeamFormation([mission])
    assert not env.view().can_join.any()
    play(env, joins={1: 0})
    assert env.tally().illegal_decisions == 1
    play(env)
    assert env.view().can_join.any()
    together = at_work(service(1), ((5, 9),), ((5, 9),))
    apart = TeamFormation([together])
    play(apart, splits={0: [0]})
    assert apart.tally().splits == 1


def test_nothing_is_possible_when_the_last_shift_is_over() -> None:
    """Three steps to each task, of six in all: there is no time for both."""
    mission = make([robot("a", 3)], [task("a", 0), task("a", 6)])
    env = TeamFormation([at_work(mission, ((1, 4), (5, 8)))])
    play(env, 7)
    assert env.is_running[0]
    play(env)
    assert env.tally().status == "infeasible"


def test_a_mission_is_played_whose_robots_are_believed_to_be_too_slow_for_their_shifts() -> None:
    """At full speed it gets everywhere; as it is held up nine times in ten, nobody believes it."""
    way = make([robot("a", 3)], [task("a", 0), task("a", 6)])
    first, second = way.tasks
    held_up = replace(way.robots[0], delays=Delays(0.9), shifts=((0, 12),))
    second = replace(second, after=(first.name,))
    mission = replace(way, robots=(held_up,), tasks=(first, second), step_limit=0)
    record = run_trial(mission, SharedPlan()).record
    assert record.end.status == "infeasible"
    assert record.end.steps == 12
    assert judge(record).findings == ()


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
def test_step_with_shifts_is_what_the_plain_twin_does(is_plane: bool) -> None:
    rng = np.random.default_rng(17 + is_plane)
    stood = broken = done = 0
    for number in range(150):
        mission = random_world(rng, is_plane=is_plane)
        if number % 2:
            mission = with_surprises(mission, rng)
        if number % 3 == 0:
            mission = with_loads(mission, rng)
        try:
            mission = with_shifts(mission, rng)
        except MissionError:  # no common shift is long enough for some task
            continue
        coordinator = [None, RandomPlans(number), RandomPlans(number), SharedPlan()][number % 4]
        env = TeamFormation(
            [mission], truths=[draw_truth(mission, number)], coordinator=coordinator
        )
        twin = Twin(env)
        while env.is_running[0] and env.tally().steps < 60:
            view = env.view()
            is_planned = coordinator is not None and rng.random() < 0.8
            decision = env.planned_decision(view) if is_planned else random_decision(view, rng)
            twin.step(view, decision)
            teams = env.worlds.teams[0]
            stood += int(teams["is_delayed"][teams["size"] > 0].sum())
            broken += twin.world.happened.any_broken_off
        done += env.tally().tasks_done
    assert min(stood, done) > 100
    assert broken > 3
