"""Completion: durations, several tasks in one place, losses, arrivals and how a trial ends."""

from __future__ import annotations

import numpy as np
import pytest

from small_worlds import (
    assignments,
    done_at,
    late_task,
    make,
    places,
    play,
    robot,
    service,
    task,
    teams_of,
    two_robots_one_task,
    walker,
)
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.parts.grid import Grid
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation


@pytest.mark.parametrize("duration", [0, 1, 3])
def test_a_task_is_done_its_duration_after_the_arrival(duration: int) -> None:
    env = TeamFormation([service(duration)])
    play(env, 1 + duration)
    assert done_at(env) == [1 + duration]
    assert env.tally().steps == 1 + duration
    assert env.tally().status == "completed"


def test_two_teams_in_one_place_do_not_add_up() -> None:
    env = TeamFormation([two_robots_one_task()])
    play(env, 5)
    assert done_at(env) == [None]
    play(env, joins={1: 0})
    assert done_at(env) == [6]


def test_tasks_in_one_place_are_done_side_by_side() -> None:
    """Durations 2 and 4 begin in step 1 together, and the third one takes no time."""
    tasks = [task("a", 1, duration=2), task("a", 1, duration=4), task("a", 1)]
    env = TeamFormation([make([robot("a", 0)], tasks)])
    play(env)
    assert int(env.worlds.teams["serves"][0, 0]) == 2
    play(env, 4)
    assert done_at(env) == [3, 5, 1]
    assert env.tally().status == "completed"


def test_of_two_able_teams_the_lower_slot_serves() -> None:
    robots = [robot("a", 0), robot("a", 0)]
    env = TeamFormation([make(robots, [task("a", 1, duration=2)], sensing_radius=0)])
    play(env, 3)
    assert env.worlds.tasks["done_by"][0].tolist() == [0]


def test_a_task_on_the_way_is_done_in_passing() -> None:
    """a heads for T and passes U; V is not for a alone, so that no detour is shorter.

    a V . U . T . . . b        the tour from the centroid, 10, is T, U, V
    0 1   3   5       19
    """
    tasks = [task("a", 5), task("a", 3), task("ab", 1)]
    env = TeamFormation([make([robot("a", 0), robot("b", 19)], tasks)])
    play(env, 3)
    assert done_at(env) == [None, 3, None]
    assert assignments(env)[0] == 0
    play(env, 2)
    assert done_at(env) == [5, 3, None]


def test_a_service_in_passing_holds_the_team() -> None:
    tasks = [task("a", 5), task("a", 3, duration=2), task("ab", 1)]
    env = TeamFormation([make([robot("a", 0), robot("b", 19)], tasks)])
    play(env, 5)
    assert done_at(env) == [None, 5, None]
    assert places(env)[0] == 3
    play(env, 2)
    assert done_at(env) == [7, 5, None]


def test_everybody_assigned_to_a_done_task_is_free() -> None:
    """The far one is on its way to T, which the near one does."""
    env = TeamFormation([make([robot("a", 0), robot("a", 9)], [task("a", 7)])])
    play(env)
    assert assignments(env) == {0: 0, 1: 0}
    play(env)
    assert done_at(env) == [2]
    assert assignments(env) == {0: None, 1: None}
    assert env.worlds.tasks["done_by"][0].tolist() == [1]


def test_a_service_breaks_off_with_a_loss_and_begins_anew() -> None:
    """b is lost in the second step of three; the other b comes and all three are served again."""
    robots = [robot("a", 0), robot("b", 0, lost=3), robot("b", 5)]
    tasks = [task("ab", 1, duration=3)]
    env = TeamFormation([make(robots, tasks, teams=((0, 1),), sensing_radius=0)])
    play(env, 3)  # arrival, one step of service, loss
    assert teams_of(env) == {0: [0], 2: [2]}
    assert int(env.worlds.teams["serves"][0, 0]) == 0
    play(env, 1)  # b walks from 5 to 1 in steps 1 to 4
    assert places(env) == {0: 1, 2: 1}
    play(env, joins={0: 2})  # step 5: the service begins in the step of the join
    play(env, 3)
    assert done_at(env) == [8]


def test_a_loss_that_the_team_can_bear_breaks_nothing_off() -> None:
    robots = [robot("a", 0), robot("b", 0), robot("c", 0, lost=2)]
    env = TeamFormation([make(robots, [task("ab", 1, duration=3)], teams=((0, 1, 2),))])
    play(env, 4)
    assert done_at(env) == [4]


def test_arrivals_free_every_team_but_those_serving_their_assignment() -> None:
    """When V appears, 0 serves T and keeps it, 1 on its way to U drops it and is allocated anew."""
    robots = [robot("a", 0), robot("b", 9)]
    tasks = [task("a", 1, duration=5), task("b", 15), task("c", 0, appears=3)]
    robots.append(robot("c", 19))
    env = TeamFormation([make(robots, tasks)])
    play(env, 2)
    assert assignments(env) == {0: 0, 1: 1, 2: None}
    play(env)
    assert assignments(env) == {0: 0, 1: None, 2: None}
    play(env)
    assert assignments(env) == {0: 0, 1: 1, 2: 2}


def test_a_service_in_passing_does_not_keep_the_assignment() -> None:
    tasks = [task("a", 5), task("a", 3, duration=4), task("ab", 1), task("b", 18, appears=4)]
    env = TeamFormation([make([robot("a", 0), robot("b", 19)], tasks)])
    play(env, 3)
    assert assignments(env)[0] == 0
    play(env)
    assert assignments(env)[0] is None
    assert int(env.worlds.teams["serves"][0, 0]) == 1


def test_a_late_task_can_turn_a_team_around() -> None:
    """After 2 steps a is at 5 on its way to T; U appears at 0 and comes first on the new tour.

    U . . a . . . . T        T needs a and b, U needs a; b is at 0 and very slow
    """
    robots = [robot("a", 3), robot("b", 0, speed=0.1)]
    env = TeamFormation([make(robots, [task("ab", 8), task("a", 0, appears=2)])])
    play(env, 2)
    assert (places(env)[0], assignments(env)[0]) == (5, None)
    play(env)
    assert (places(env)[0], assignments(env)[0]) == (4, 1)


def test_a_late_task_need_not_turn_a_team_around() -> None:
    """The same, but a can do T alone: from 5, T first is 3 + 8, U first 5 + 8."""
    env = TeamFormation([late_task()])
    play(env, 3)
    assert (places(env)[0], assignments(env)[0]) == (6, 0)
    assert bool(env.worlds.teams["is_detour"][0, 0])


def test_losses_free_every_team() -> None:
    robots = [robot("a", 0), robot("b", 0), robot("b", 4, lost=2)]
    env = TeamFormation([make(robots, [task("a", 9), task("b", 9)])])
    play(env)
    assert assignments(env) == {0: 0, 1: 1, 2: 1}
    play(env)
    assert assignments(env) == {0: None, 1: None}


@pytest.mark.parametrize(("limit", "status"), [(10, "completed"), (9, "step limit")])
def test_the_step_limit_is_exact(limit: int, status: str) -> None:
    mission = walker(1.0)
    env = TeamFormation([make(mission.robots, mission.tasks, step_limit=limit)])
    while env.is_running[0]:
        play(env)
    assert env.tally().status == status
    assert env.tally().steps == limit


def test_a_world_without_tasks_left_that_can_be_done_names_those_that_cannot() -> None:
    """b is lost; t1 and t2 need it, t0 does not, t3 is done before."""
    robots = [robot("a", 0), robot("b", 0, lost=4)]
    tasks = [task("a", 9), task("ab", 8), task("b", 7, appears=50), task("b", 1)]
    record = run_trial(make(robots, tasks), JoinAll()).record
    assert record.end.status == "infeasible"
    assert record.end.blocked_tasks == ("t1", "t2")
    assert (record.end.steps, record.end.makespan, record.end.tasks_done) == (4, None, 1)


def test_a_loss_on_the_other_side_of_a_wall_can_block_too() -> None:
    """
    a b @ b T        the left b cannot reach T
    """
    robots = [robot("b", 1), robot("b", 3, lost=1)]
    mission = make(robots, [task("b", 4), task("b", 0)], Grid(5, 1, ("..@..",)))
    record = run_trial(mission, JoinAll()).record
    assert (record.end.status, record.end.blocked_tasks) == ("infeasible", ("t0",))


def test_a_task_done_in_the_step_of_the_last_loss_counts() -> None:
    robots = [robot("a", 0), robot("b", 0, lost=3)]
    env = TeamFormation([make(robots, [task("a", 3), task("b", 2)], sensing_radius=0)])
    play(env, 3)
    assert done_at(env) == [3, 2]
    assert env.tally().status == "completed"


def test_demand_counts_the_open_tasks() -> None:
    """It spares teams that nobody needs the search for a task."""
    env = TeamFormation([make([robot("a", 0), robot("b", 0)], [task("ab", 3), task("b", 1)])])
    assert env.worlds.demand[0].tolist() == [1, 2, 0]
    play(env)
    assert np.array_equal(env.worlds.demand[0], [1, 1, 0])
