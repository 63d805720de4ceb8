"""The paper's allocation, task by task."""

from __future__ import annotations

import numpy as np
import pytest

from small_worlds import (
    assignments,
    detour_on_the_way,
    done_at,
    make,
    order_of,
    places,
    play,
    robot,
    task,
    two_tasks_two_pairs,
)
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.parts.grid import Grid
from teamformer.world.env import Decision, TeamFormation
from teamformer.world.rules.constants import NOBODY


def test_the_first_task_in_the_order_that_one_can_contribute_to() -> None:
    tasks = [task("a", 3), task("bc", 6), task("c", 9)]
    env = TeamFormation([make([robot(can, 0) for can in "abc"], tasks)])
    assert order_of(env) == [0, 1, 2]
    play(env)
    assert assignments(env)[0] == 0
    assert assignments(env)[1] == 1


def test_a_team_that_nobody_needs_gets_nothing() -> None:
    env = TeamFormation([make([robot("a", 0), robot("b", 0)], [task("a", 3)])])
    play(env)
    assert assignments(env) == {0: 0, 1: None}


def test_a_task_that_nearer_sensed_teams_cover_is_skipped() -> None:
    env = TeamFormation([two_tasks_two_pairs()])
    play(env)
    assert assignments(env) == {0: 0, 1: 0, 2: 1, 3: 1}


def test_teams_that_are_not_sensed_cover_nothing() -> None:
    """
    a a a . . T        everybody is one cell from the next; sensing reaches just that far, or not
    """
    robots = [robot("a", 2), robot("a", 1), robot("a", 0)]
    tasks = [task("a", 5), task("a", 9)]
    env = TeamFormation([make(robots, tasks, sensing_radius=1)])
    play(env)
    assert assignments(env) == {0: 0, 1: 1, 2: 0}  # 2 senses 1 only, which heads for U
    env = TeamFormation([make(robots, tasks, sensing_radius=0.9)])
    play(env)
    assert assignments(env) == {0: 0, 1: 0, 2: 0}


def test_teams_that_are_farther_cover_nothing() -> None:
    """Slot 0 comes first but is farther from T; slot 1 goes there too."""
    env = TeamFormation([make([robot("a", 0), robot("a", 1)], [task("a", 5), task("a", 9)])])
    play(env)
    assert assignments(env) == {0: 0, 1: 0}


def test_counts_have_to_be_covered_too() -> None:
    tasks = [task("aa", 5), task("a", 9)]
    env = TeamFormation([make([robot("a", 0) for _ in range(3)], tasks)])
    play(env)
    assert assignments(env) == {0: 0, 1: 0, 2: 1}


def test_a_free_team_is_given_a_task_that_is_no_longer_covered() -> None:
    """2 has nothing to do while 0 and 1 cover T; 1 is lost, and everybody is allocated anew."""
    robots = [robot("a", 0), robot("b", 0, lost=2), robot("b", 0)]
    env = TeamFormation([make(robots, [task("ab", 9)])])
    play(env)
    assert assignments(env) == {0: 0, 1: 0, 2: None}
    play(env, 2)
    assert assignments(env) == {0: 0, 2: 0}


def test_a_task_beyond_a_wall_is_nobodys_on_this_side() -> None:
    world = Grid(7, 1, ("...@...",))
    robots, tasks = [robot("a", 0), robot("a", 6)], [task("a", 4), task("a", 2)]
    env = TeamFormation([make(robots, tasks, world)])
    play(env)
    assert assignments(env) == {0: 1, 1: 0}


def test_a_later_task_that_shortens_the_tour_is_done_first() -> None:
    """From 0: T, U is 5 + 2 long and U, T is 3 + 2."""
    env = TeamFormation([detour_on_the_way()])
    assert order_of(env) == [0, 1]
    play(env)
    assert assignments(env)[0] == 1
    assert bool(env.worlds.teams["is_detour"][0, 0])
    play(env, 4)
    assert done_at(env) == [5, 3]


def test_a_detour_must_be_done_alone() -> None:
    base = detour_on_the_way()
    env = TeamFormation([make(base.robots, [base.tasks[0], task("ab", 3)])])
    play(env)
    assert assignments(env)[0] == 0


@pytest.mark.parametrize(("place", "is_detour"), [(5, True), (6, False), (7, False)])
def test_a_detour_must_shorten_the_tour(place: int, is_detour: bool) -> None:
    """a at 6, order T (9), U (3): T first is 3 + 6, U first is 3 + 6 too; one to the left 2 + 6."""
    tasks = [task("a", 9), task("a", 3)]
    env = TeamFormation([make([robot("a", place), robot("b", 19)], tasks)])
    assert order_of(env) == [0, 1]
    play(env)
    assert assignments(env)[0] == int(is_detour)


def test_the_best_detour_is_taken() -> None:
    """Order T (9), U (6), V (3), from 0: U first is 6 + 3 + 6, V first 3 + 6 + 3, T first 15."""
    tasks = [task("a", 9), task("a", 6), task("a", 3)]
    env = TeamFormation([make([robot("a", 0), robot("b", 19)], tasks)])
    assert order_of(env) == [0, 1, 2]
    play(env)
    assert assignments(env)[0] == 2


def test_a_detour_that_others_cover_is_not_made() -> None:
    """0 does U on its way to T; 1 stands beside it, senses that and goes for T at once."""
    base = detour_on_the_way()
    robots = [base.robots[0], robot("a", 0), base.robots[1]]
    env = TeamFormation([make(robots, [task("aa", 5), task("a", 3)])])
    assert order_of(env) == [0, 1]
    play(env)
    assert assignments(env)[0] == 1
    assert assignments(env)[1] == 0


def test_an_assignment_is_kept_until_it_is_done() -> None:
    env = TeamFormation([two_tasks_two_pairs()])
    play(env)
    before = assignments(env)
    play(env, 3)
    assert assignments(env) == before
    assert places(env) == {0: 4, 1: 4, 2: 6, 3: 6}


def test_a_decision_may_name_the_task() -> None:
    env = TeamFormation([two_tasks_two_pairs()])
    view = env.view()
    env.step(Decision(view.counts.copy(), np.array([1, NOBODY, 0, NOBODY])))
    assert assignments(env) == {0: 1, 1: 0, 2: 0, 3: 1}
    view = env.view()
    env.step(Decision(view.counts.copy(), np.array([NOBODY, 1, 99, NOBODY])))
    assert assignments(env) == {0: 1, 1: 1, 2: 0, 3: 1}
    assert env.tally().illegal_decisions == 1


def test_a_serving_team_keeps_its_assignment_whatever_is_named() -> None:
    robots = [robot("a", 0)]
    env = TeamFormation([make(robots, [task("a", 1, duration=3), task("a", 5)])])
    play(env)
    env.step(Decision(env.view().counts.copy(), np.array([1])))
    assert assignments(env) == {0: 0}


def test_two_do_not_wait_for_each_other_at_different_tasks() -> None:
    """c has done U; b heads for V, which needs a too; a heads for T, which needs c too.

    If b and c, once joined, went on to V, they would wait there for a, and a at T for c.

    V . . . . a . . . . T        c and U are where b is
    . . . . b . . . . . .
    2       10          17
    """
    robots = [robot("c", 10, 1), robot("b", 10, 1, speed=0.1), robot("a", 11)]
    tasks = [task("c", 10, 1), task("ac", 17), task("ab", 2)]
    env, join_all = TeamFormation([make(robots, tasks, Grid(20, 2))]), JoinAll()
    assert order_of(env) == [0, 1, 2]  # from (10, 1): 0 + 8 + 15
    play(env)
    assert assignments(env) == {0: None, 1: 2, 2: 1}
    play(env, joins={1: 0})
    assert assignments(env) == {0: 1, 2: 1}
    while env.is_running[0]:
        env.step(join_all.decide(env.view()))
    assert env.tally().status == "completed"
