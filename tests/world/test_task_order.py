"""The shared order: where its tour begins, and what new tasks do to it."""

from __future__ import annotations

import numpy as np
import pytest

from small_worlds import done_at, late_task, make, order_of, play, robot, task
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import TeamFormation


def test_tour_begins_at_the_centroid_of_the_robots() -> None:
    """a . . . T . . . . U . a: the centroid is 5.5, so cell 6; T is 2 away and U 3."""
    robots = [robot("a", 0), robot("a", 11)]
    tasks = [task("a", 9), task("a", 4)]
    assert order_of(TeamFormation([make(robots, tasks)])) == [1, 0]  # 2 + 5 < 3 + 5


def test_tour_begins_at_the_nearest_robot_where_the_centroid_is_blocked() -> None:
    """
    a . . . . . T
    . @ @ @ @ @ .
    U . . a . . a      centroid (3, 1.33) is a wall; the robot at (3, 2) is the nearest
    """
    rows = (".......", ".@@@@@.", ".......")
    robots = [robot("a", 0, 0), robot("a", 6, 2), robot("a", 3, 2)]
    tasks = [task("a", 6, 0), task("a", 0, 2)]
    env = TeamFormation([make(robots, tasks, Grid(7, 3, rows))])
    assert (env.worlds.rules["start_x"][0], env.worlds.rules["start_y"][0]) == (3, 2)
    assert order_of(env) == [1, 0]  # 3 + 8 < 5 + 8


def test_walls_count() -> None:
    """
    a @ U . .
    . @ . . .
    . . T . .      around the wall T is 4 away and U 6; as the crow flies U is nearer, 2
    """
    rows = (".@...", ".@...", ".....")
    robots, tasks = [robot("a", 0, 0)], [task("a", 2, 2), task("a", 2, 0)]
    assert order_of(TeamFormation([make(robots, tasks, Grid(5, 3, rows))])) == [0, 1]
    assert order_of(TeamFormation([make(robots, tasks, Grid(5, 3))])) == [1, 0]


def test_new_tasks_are_toured_from_the_start_where_nothing_is_done() -> None:
    """a starts at 3; U at 0 appears after 2 steps; the tour from 3 is then U (3), T (8)."""
    env = TeamFormation([late_task()])
    assert order_of(env) == [0]
    play(env, 2)
    assert order_of(env) == [1, 0]  # 3 + 8 < 5 + 8
    assert env.worlds.tasks["rank"][0].tolist() == [1, 0]


def test_new_tasks_are_toured_from_the_latest_task_done() -> None:
    """T is done at 8 in step 5; then U at 0 and V at 10 appear: from 8, V is first."""
    tasks = [task("a", 8), task("a", 0, appears=6), task("a", 10, appears=6)]
    env = TeamFormation([make([robot("a", 3)], tasks)])
    play(env, 6)
    assert done_at(env) == [5, None, None]
    assert order_of(env) == [2, 1]  # 2 + 10 < 8 + 10; from 3 it would be 3 + 10 < 7 + 10


@pytest.mark.parametrize(
    ("rule", "expected"), [("resolve", [3, 0, 1, 2]), ("nearest", [0, 3, 1, 2])]
)
def test_a_new_task_is_toured_or_comes_after_its_nearest(rule: str, expected: list[int]) -> None:
    """a at 0; T, U, V at 5, 10, 15; a new one at 4 is nearest to T, and before it on the tour."""
    places = [(5, 0), (10, 0), (15, 0), (4, 1)]
    tasks = [task("b", x, appears=appears) for x, appears in places]
    env = TeamFormation([make([robot("a", 0), robot("b", 0, speed=0.1)], tasks)], new_tasks=rule)
    assert order_of(env) == [0, 1, 2]
    play(env)
    assert order_of(env) == expected
    assert [int(env.worlds.tasks["rank"][0, k]) for k in expected] == [0, 1, 2, 3]


def test_new_tasks_are_inserted_one_after_the_other() -> None:
    """The second new one, at 6, is as near to T at 7 as to the first new one, at 5."""
    tasks = [task("b", 7), task("b", 15), task("b", 5, appears=1), task("b", 6, appears=1)]
    robots = [robot("b", 0, speed=0.1)]
    env = TeamFormation([make(robots, tasks)], new_tasks="nearest")
    play(env)
    assert order_of(env) == [0, 3, 2, 1]  # 5 after 7; then 6 after 7, the first of equals


def test_nearest_needs_an_order_to_insert_into() -> None:
    """Nothing is open when two tasks appear, so they are toured."""
    tasks = [task("a", 1), task("a", 0, appears=3), task("a", 5, appears=3)]
    env = TeamFormation([make([robot("a", 0)], tasks)], new_tasks="nearest")
    play(env, 3)
    assert order_of(env) == [1, 2]  # from 1: 1 + 5 < 4 + 5


def test_order_closes_up_when_a_task_is_done() -> None:
    robots = [robot("a", 0), robot("b", 0, speed=0.5)]
    env = TeamFormation([make(robots, [task("b", 1), task("a", 2), task("b", 9)])])
    assert order_of(env) == [0, 1, 2]
    play(env, 2)
    assert done_at(env) == [2, 2, None]
    assert order_of(env) == [2]
    assert int(env.worlds.tasks["rank"][0, 2]) == 0
    assert np.array_equal(env.worlds.demand[0], [0, 1, 0])


def test_a_world_is_ordered_by_its_own_rules_beside_others() -> None:
    missions, coordinators = [late_task()] * 3, [None, Crews(), SharedPlan()]
    together = TeamFormation(missions, coordinator=coordinators)
    alone = [
        TeamFormation([mission], coordinator=coordinator)
        for mission, coordinator in zip(missions, coordinators, strict=True)
    ]
    for _ in range(3):
        for number, env in enumerate(alone):
            for field in ("order", "tasks", "robots", "count"):
                theirs = getattr(together.worlds, field)[number]
                assert (theirs == getattr(env.worlds, field)[0]).all(), field
            play(env, 1)
        play(together, 1)
    assert (together.worlds.count["orders"] == [2, 2, 2]).all()  # at the start, for the late one
