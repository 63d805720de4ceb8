"""Joining all, in small worlds."""

from __future__ import annotations

from small_worlds import (
    done_at,
    make,
    places,
    robot,
    task,
    teams_of,
    two_apart,
    two_robots_one_task,
)
from teamformer.methods.scripted.joining import JoinAll
from teamformer.world.env import TeamFormation
from teamformer.world.view import NEXT_TASKS

JOIN_ALL = JoinAll()


def step(env: TeamFormation, steps: int = 1) -> None:
    for _ in range(steps):
        env.step(JOIN_ALL.decide(env.view()))


def test_who_is_together_joins_at_once() -> None:
    env = TeamFormation([two_robots_one_task()])
    step(env)
    assert teams_of(env) == {0: [0, 1]}
    step(env, 3)
    assert done_at(env) == [4]


def test_who_lacks_nothing_joins_nobody() -> None:
    env = TeamFormation([make([robot("a", 0), robot("a", 0)], [task("a", 3)])])
    step(env, 3)
    assert done_at(env) == [3]
    assert env.tally().joins == 0


def test_counts_can_be_lacking_too() -> None:
    """One a lacks another; two of them lack nothing, but the third one does."""
    env = TeamFormation([make([robot("a", 0) for _ in range(3)], [task("aa", 3)])])
    step(env)
    assert teams_of(env) == {0: [0, 1], 2: [2]}
    assert JOIN_ALL.decide(env.view()).wanted.tolist() == [[2, 0, 0], [3, 0, 0]]


def test_it_helps_if_any_task_in_view_needs_it() -> None:
    """T needs a only; U, later in the order, needs b as well."""
    env = TeamFormation([make([robot("a", 0), robot("b", 0)], [task("a", 3), task("ab", 9)])])
    step(env)
    assert teams_of(env) == {0: [0, 1]}


def test_a_task_beyond_the_view_does_not_count() -> None:
    """b is needed by the 17th task only, which a cannot see."""
    tasks = [task("a", x) for x in range(1, NEXT_TASKS + 1)] + [task("b", 19)]
    env = TeamFormation([make([robot("a", 0), robot("a", 0)], tasks[:-1])])
    view = env.view()
    assert (JOIN_ALL.decide(view).wanted == view.counts).all()
    env = TeamFormation([make([robot("a", 0), robot("b", 0)], tasks)])
    wanted = JOIN_ALL.decide(env.view()).wanted.tolist()
    assert wanted == [[1, 0, 0], [1, 1, 0]]  # a lacks nothing it knows of; b lacks a


def test_one_side_that_finds_it_useful_is_enough() -> None:
    """ab finds nothing useful in a; a lacks b."""
    robots = [robot("ab", 0), robot("a", 0)]
    env = TeamFormation([make(robots, [task("ab", 3)])])
    assert JOIN_ALL.decide(env.view()).wanted.tolist() == [[1, 1, 0], [2, 1, 0]]
    step(env)
    assert teams_of(env) == {0: [0, 1]}


def test_teams_pair_off_by_slot() -> None:
    env = TeamFormation([make([robot(can, 0) for can in "abca"], [task("aabc", 5)])])
    assert JOIN_ALL.decide(env.view()).wanted.tolist() == [
        [1, 1, 0],
        [1, 1, 0],
        [1, 0, 1],
        [1, 0, 1],
    ]
    step(env)
    assert teams_of(env) == {0: [0, 1], 2: [2, 3]}
    step(env)
    assert teams_of(env) == {0: [0, 1, 2, 3]}


def test_a_pair_that_is_of_no_use_is_passed_over() -> None:
    """0 and 1 both bring a, of which one is enough: 0 takes the b of 2 instead."""
    env = TeamFormation([make([robot(can, 0) for can in "aab"], [task("ab", 5)])])
    step(env)
    assert teams_of(env) == {0: [0, 2], 1: [1]}


def test_it_joins_only_who_is_here() -> None:
    """b is within the join radius, but elsewhere."""
    env = TeamFormation([two_apart()])
    step(env)
    assert places(env) == {0: 1, 1: 3}


def test_it_never_splits() -> None:
    """After the joint task each could go its own way; it does not."""
    robots = [robot("a", 10), robot("b", 10)]
    tasks = [task("ab", 10), task("a", 5), task("b", 15)]
    env = TeamFormation([make(robots, tasks)])
    while env.is_running[0]:
        step(env)
    assert (env.tally().joins, env.tally().splits) == (1, 0)
    assert env.tally().steps == 1 + 5 + 10
