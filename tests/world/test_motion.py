"""Walking: paces, ways around walls, and walls that are in nobody's way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from random_worlds import random_world
from small_worlds import done_at, make, places, play, robot, task, two_robots_one_task, walker
from teamformer.methods.scripted.heuristic import Heuristic
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.parts.grid import FREE, Grid
from teamformer.trials.trial import run_trial
from teamformer.world.env import TeamFormation


@pytest.mark.parametrize(
    ("speed", "cells"),
    [
        (1.0, [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]),
        (0.5, [0, 1, 1, 2, 2, 3, 3, 4, 4, 5]),
        (0.3, [0, 0, 0, 1, 1, 1, 2, 2, 2, 3]),  # 10 steps of 0.3 are 3 cells, not 2.999...
        (1.7, [1, 3, 5, 6, 8, 10]),
    ],
)
def test_a_step_is_worth_the_speed(speed: float, cells: list[int]) -> None:
    env = TeamFormation([walker(speed)])
    walked = []
    for _ in cells:
        play(env)
        walked.append(places(env)[0])
    assert walked == cells


@pytest.mark.parametrize(("speed", "step"), [(1.0, 10), (0.5, 20), (0.3, 34), (1.7, 6), (1000, 1)])
def test_a_walk_of_ten_cells_takes_ten_by_speed_rounded_up(speed: float, step: int) -> None:
    env = TeamFormation([walker(speed)])
    play(env, step)
    assert done_at(env) == [step]


def test_the_fraction_left_on_arrival_is_not_kept() -> None:
    """At 1.7 the first task, 2 away, takes 2 steps with 1.4 to spare; the next one 2 again."""
    env = TeamFormation([make([robot("a", 0, speed=1.7)], [task("a", 2), task("a", 4)])])
    play(env, 4)
    assert done_at(env) == [2, 4]


def test_a_team_walks_at_the_pace_of_its_slowest_robot() -> None:
    robots = [robot("a", 0, speed=2.0), robot("b", 0, speed=0.5)]
    env = TeamFormation([make(robots, [task("ab", 3)], teams=((0, 1),))])
    play(env, 6)
    assert done_at(env) == [6]
    env = TeamFormation([make(robots, [task("ab", 3)], teams=((0, 1),))])
    play(env)
    play(env, splits={0: [0]})
    play(env)
    assert places(env) == {0: 2, 1: 0}


def test_forming_begins_a_new_walk() -> None:
    """Half a cell walked before joining is forgotten: 2 cells take 4 steps after the join."""
    robots = [robot("a", 0, speed=0.5), robot("b", 0, speed=0.5)]
    env = TeamFormation([make(robots, [task("ab", 2)])])
    play(env)
    play(env, joins={0: 1})
    play(env, 4)
    assert done_at(env) == [6]


def path_of(world: Grid, start: tuple[int, int], goal: tuple[int, int]) -> list[tuple[int, int]]:
    env = TeamFormation([make([robot("a", *start)], [task("a", *goal)], world)])
    path = []
    while env.is_running[0]:
        play(env)
        team = env.worlds.teams[0, 0]
        path.append((int(team["x"]), int(team["y"])))
    return path


def test_the_axis_with_more_to_go_is_walked_first() -> None:
    path = path_of(Grid(9, 9), (0, 0), (3, 1))
    assert path == [(1, 0), (2, 0), (3, 0), (3, 1)]  # at (2, 0) both have 1 to go: x
    assert path_of(Grid(9, 9), (4, 4), (3, 2)) == [(4, 3), (3, 3), (3, 2)]


def test_walls_are_walked_around() -> None:
    """
    a @ T
    . @ .
    . . .
    """
    world = Grid(3, 3, (".@.", ".@.", "..."))
    assert path_of(world, (0, 0), (2, 0)) == [(0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0)]


def test_a_team_without_assignment_stays() -> None:
    env = TeamFormation([make([robot("a", 0), robot("b", 5)], [task("a", 9)])])
    play(env, 3)
    assert places(env) == {0: 3, 1: 5}


def test_who_is_at_the_task_waits_there() -> None:
    env = TeamFormation([two_robots_one_task()])
    play(env, 6)
    assert places(env) == {0: 3, 1: 3}
    assert done_at(env) == [None]


@pytest.mark.parametrize("policy", [JoinAll(), Heuristic()], ids=["join-all", "heuristic"])
def test_a_map_without_obstacles_is_an_open_grid(policy: JoinAll | Heuristic) -> None:
    """Distance fields and downhill walks give the record that coordinates give."""
    rng = np.random.default_rng(2)
    for _ in range(25):
        mission = random_world(rng)
        if mission.world.rows:
            continue
        width, height = mission.world.width, mission.world.height
        drawn = replace(mission, world=Grid(width, height, (FREE * width,) * height))
        drawn = replace(drawn, step_limit=mission.step_limit)
        one, other = (run_trial(s, policy).record for s in (mission, drawn))
        assert one.end == other.end
        assert one.orders == other.orders
        assert one.steps == other.steps
