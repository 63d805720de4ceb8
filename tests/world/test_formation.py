"""Splits, joins and losses: who forms with whom, and what it costs."""

from __future__ import annotations

import numpy as np
import pytest

from small_worlds import (
    assignments,
    done_at,
    make,
    places,
    play,
    robot,
    service,
    task,
    teams_of,
    two_apart,
    two_robots_one_task,
    two_tasks_two_pairs,
)
from teamformer.world.env import Decision, TeamFormation


def test_joining_costs_the_step() -> None:
    env = TeamFormation([two_robots_one_task()])
    play(env, joins={0: 1})
    assert teams_of(env) == {0: [0, 1]}
    assert places(env) == {0: 0}
    assert assignments(env) == {0: 0}
    play(env, 3)
    assert done_at(env) == [4]
    assert env.tally().joins == 1


def test_joining_is_free_with_no_forming_steps() -> None:
    env = TeamFormation([two_robots_one_task(forming_steps=0)])
    play(env, joins={0: 1})
    assert places(env) == {0: 1}
    play(env, 2)
    assert done_at(env) == [3]


@pytest.mark.parametrize(("forming_steps", "place"), [(0, 1), (1, 0)])
def test_splitting_costs_the_same(forming_steps: int, place: int) -> None:
    env = TeamFormation([two_robots_one_task(teams=((0, 1),), forming_steps=forming_steps)])
    play(env, splits={0: [1]})
    assert teams_of(env) == {0: [0], 1: [1]}
    assert places(env) == {0: place, 1: place}
    assert env.tally().splits == 1


def test_two_that_want_each_other_join_once() -> None:
    env = TeamFormation([two_robots_one_task()])
    play(env, joins={0: 1, 1: 0})
    assert (env.tally().joins, env.tally().illegal_decisions) == (1, 0)


def test_a_join_whose_partner_has_formed_becomes_maintain() -> None:
    """0 takes 1 in; 2 wanted 1 too and walks on alone, which is not illegal."""
    env = TeamFormation([make([robot(can, 0) for can in "abc"], [task("abc", 5)])])
    play(env, joins={0: 1, 2: 1})
    assert teams_of(env) == {0: [0, 1], 2: [2]}
    assert places(env) == {0: 0, 2: 1}
    assert (env.tally().joins, env.tally().illegal_decisions) == (1, 0)


def test_a_join_whose_partner_splits_becomes_maintain() -> None:
    robots = [robot(can, 0) for can in "abc"]
    env = TeamFormation([make(robots, [task("abc", 5)], teams=((1, 2),))])
    play(env, joins={0: 1}, splits={1: [1]})
    assert teams_of(env) == {0: [0], 1: [1], 2: [2]}
    assert places(env) == {0: 1, 1: 0, 2: 0}


@pytest.mark.parametrize(
    ("wanted", "stay"),
    [
        ([2, 0, 0], [0]),  # 0 takes all the room
        ([1, 0, 0], [1]),  # 0 is too much, 3 comes too late
        ([1, 1, 0], [1, 2]),
        ([3, 0, 0], [0, 1]),
        ([3, 1, 0], [0, 1, 2]),
        ([0, 1, 0], [2]),
    ],
)
def test_those_who_stay_are_taken_in_robot_order(wanted: list[int], stay: list[int]) -> None:
    robots = [robot(can, 0) for can in ("aa", "a", "b", "a")]
    env = TeamFormation([make(robots, [task("aaaab", 5)], teams=((0, 1, 2, 3),))])
    env.view()
    env.step(Decision(np.array([wanted])))
    leave = [r for r in range(4) if r not in stay]
    assert sorted(teams_of(env).values()) == sorted([stay, leave])
    assert env.worlds.robots["stays"][0].tolist() == [r in stay for r in range(4)]


@pytest.mark.parametrize(
    "wanted",
    [
        [0, 0, 0],  # nobody fits
        [2, 0, 0],  # more of one, less of another
        [1, 2, 0],  # nobody brings that
        [1, 1, 1],  # robot 2 does, but is not here
        [-1, 1, 0],
    ],
)
def test_what_is_illegal_counts_as_maintain(wanted: list[int]) -> None:
    robots = [robot("a", 0), robot("b", 0), robot("c", 2)]
    env = TeamFormation([make(robots, [task("abc", 5)], teams=((0, 1),))])
    env.view()
    env.step(Decision(np.array([wanted, [0, 0, 1]])))
    assert teams_of(env) == {0: [0, 1], 2: [2]}
    assert places(env) == {0: 1, 2: 3}
    assert env.tally().illegal_decisions == 1


def test_a_split_drops_the_assignment_and_both_are_allocated_anew() -> None:
    """On its way to T the pair parts; 1 alone can contribute to U only."""
    robots = [robot("a", 0), robot("b", 0)]
    env = TeamFormation([make(robots, [task("a", 5), task("b", 9)], teams=((0, 1),))])
    play(env)
    assert assignments(env) == {0: 0}
    play(env, splits={0: [0]})
    assert assignments(env) == {0: 0, 1: 1}


def test_the_same_assignment_is_joined_before_the_lower_slot() -> None:
    """0 and 2 have the same counts in the same place; 3 shares its task with 2."""
    env = TeamFormation([two_tasks_two_pairs(forming_steps=0)])
    play(env)
    assert assignments(env) == {0: 0, 1: 0, 2: 1, 3: 1}
    play(env, joins={3: 2})
    assert teams_of(env) == {0: [0], 1: [1], 2: [2, 3]}


def test_without_shared_assignment_the_lower_slot_is_joined() -> None:
    env = TeamFormation([make([robot(can, 0) for can in "bba"], [task("abb", 5)])])
    play(env, joins={2: 1})  # wants one b more: 0 has it too
    assert teams_of(env) == {0: [0, 2], 1: [1]}


def test_the_nearest_is_joined_before_the_lower_slot() -> None:
    robots = [robot("b", 2), robot("b", 1), robot("a", 1)]
    radii = {"sensing_radius": 2, "join_radius": 2}
    env = TeamFormation([make(robots, [task("abb", 9)], **radii)])
    play(env, joins={2: 0})
    assert teams_of(env) == {0: [0], 1: [1, 2]}


def test_a_joiner_walks_to_where_its_partner_goes() -> None:
    """b goes from 2 to 3 first, then a towards 3."""
    env = TeamFormation([two_apart()])
    play(env, joins={0: 1})
    assert places(env) == {0: 1, 1: 3}
    assert (env.tally().joins, env.tally().illegal_decisions) == (0, 0)


@pytest.mark.parametrize(("forming_steps", "count"), [(0, 1), (1, 2)])
def test_a_joiner_that_arrives_merges_at_once_only_if_that_is_free(
    forming_steps: int, count: int
) -> None:
    """b at half speed: after steps 1 to 3 it is at 2, 3, 3 and a at 1, 2, 3."""
    env = TeamFormation([two_apart(pace=0.5, forming_steps=forming_steps)])
    for expected in ({0: 1, 1: 2}, {0: 2, 1: 3}):
        play(env, joins={0: 1})
        assert places(env) == expected
    play(env, joins={0: 1})
    assert set(places(env).values()) == {3}
    assert len(teams_of(env)) == count
    if count == 2:
        play(env, joins={0: 1})
        assert teams_of(env) == {0: [0, 1]}
    assert env.tally().joins == 1


def test_a_joiner_follows_a_partner_that_has_become_part_of_another_team() -> None:
    """2 walks to robot 1, whose team is 0's by then: the partner has formed, so 2 maintains."""
    robots = [robot("a", 4), robot("b", 4), robot("c", 2)]
    radii = {"sensing_radius": 3, "join_radius": 3}
    env = TeamFormation([make(robots, [task("abc", 9)], **radii)])
    play(env, joins={0: 1, 2: 1})
    assert teams_of(env) == {0: [0, 1], 2: [2]}
    assert places(env) == {0: 4, 2: 3}


def test_two_that_walk_towards_each_other_meet() -> None:
    """a goes from 0 to 1, then b from 2 to where a is now."""
    env = TeamFormation([two_apart(forming_steps=0)])
    play(env, joins={0: 1, 1: 0})
    assert teams_of(env) == {0: [0, 1]}
    assert places(env) == {0: 1}
    assert env.tally().joins == 1


@pytest.mark.parametrize(("radius", "illegal"), [(2.0, 0), (1.99, 1)])
def test_the_join_radius_is_exact(radius: float, illegal: int) -> None:
    env = TeamFormation([two_apart(join_radius=radius)])
    play(env, joins={0: 1})
    assert env.tally().illegal_decisions == illegal


def test_a_serving_team_neither_forms_nor_is_joined() -> None:
    robots = [robot("a", 1), robot("b", 1), robot("c", 1)]
    tasks = [task("ab", 1, duration=5), task("c", 5)]
    env = TeamFormation([make(robots, tasks, teams=((0, 1),))])
    play(env)  # the service begins
    env.view()
    env.step(Decision(np.array([[1, 0, 0], [0, 0, 1]])))
    assert (env.tally().splits, env.tally().illegal_decisions) == (0, 1)
    mission = make(robots, [task("ab", 1, duration=5), task("abc", 1)], teams=((0, 1),))
    env = TeamFormation([mission])
    play(env)
    play(env, joins={2: 0, 0: 2})
    assert (env.tally().joins, env.tally().illegal_decisions) == (0, 2)


def test_the_union_keeps_the_earlier_assignment() -> None:
    """The b of the first pair joins the b of the second: T comes before U."""
    env = TeamFormation([two_tasks_two_pairs()])
    play(env)
    assert assignments(env) == {0: 0, 1: 0, 2: 1, 3: 1}
    play(env, joins={0: 2})
    assert assignments(env) == {0: 0, 1: 0, 3: 1}


def test_a_union_with_a_free_team_is_allocated_anew() -> None:
    """c has done U and is free; b heads for V. Their union can help with T, which comes first.

    a c
      b . . . . . T . V        U at 1 needs c, T a and c, V b; b is slow
    0 1           7   9
    """
    robots = [robot("c", 1), robot("b", 1, speed=0.1), robot("a", 0)]
    env = TeamFormation([make(robots, [task("c", 1), task("ac", 7), task("b", 9)])])
    play(env)
    assert done_at(env) == [1, None, None]
    assert assignments(env) == {0: None, 1: 2, 2: 1}
    play(env, joins={1: 0})
    assert assignments(env) == {0: 1, 2: 1}


def test_a_union_with_a_team_on_a_detour_is_allocated_anew() -> None:
    """a does U on the way to T and c heads for T. Together they do U on the way: not T at once.

    a
    c . . U . T . . . b        T needs a and c, U a; the tour begins with T
    0     3   5       19
    """
    robots = [robot("a", 0), robot("c", 0), robot("b", 19)]
    env = TeamFormation([make(robots, [task("ac", 5), task("a", 3)])])
    play(env)
    assert (assignments(env)[0], assignments(env)[1]) == (1, 0)
    play(env, joins={0: 1})
    assert assignments(env)[0] == 1
    assert bool(env.worlds.teams["is_detour"][0, 0])


def test_losing_the_lowest_robot_changes_the_slot_and_nothing_else() -> None:
    robots = [robot("a", 0, lost=2), robot("a", 0), robot("b", 0)]
    env = TeamFormation([make(robots, [task("ab", 9)], teams=((0, 1, 2),))])
    play(env, 2)
    assert teams_of(env) == {1: [1, 2]}
    assert places(env) == {1: 2}
    assert env.worlds.has[0, 1].tolist() == [1, 1, 0]
    assert env.worlds.has[0, 0].tolist() == [0, 0, 0]
    play(env, 7)
    assert done_at(env) == [9]


def test_a_lost_robot_counts_for_nothing_in_the_very_step() -> None:
    """The team arrives in step 3, in which b is lost: nothing is done."""
    robots = [robot("a", 0), robot("b", 0, lost=3), robot("b", 19)]
    env = TeamFormation([make(robots, [task("ab", 3)], teams=((0, 1),))])
    play(env, 3)
    assert (places(env)[0], done_at(env)) == (3, [None])
    robots[1] = robot("b", 0, lost=4)
    env = TeamFormation([make(robots, [task("ab", 3)], teams=((0, 1),))])
    play(env, 3)
    assert done_at(env) == [3]


def test_the_team_goes_on_at_the_pace_of_who_is_left() -> None:
    robots = [robot("a", 0), robot("b", 0, speed=0.5, lost=2)]
    env = TeamFormation([make(robots, [task("a", 9)], teams=((0, 1),))])
    play(env, 2)
    assert places(env)[0] == 1
    play(env)
    assert places(env)[0] == 2


def test_a_service_goes_on_in_the_new_slot() -> None:
    """0 is not needed; the team keeps its service when 0 is lost in its first step."""
    base = service(duration=3)
    robots = [robot("c", 0, lost=2), *base.robots]
    env = TeamFormation([make(robots, base.tasks, teams=((0, 1, 2),))])
    play(env)  # arrives: three steps of service begin
    assert int(env.worlds.teams["serves"][0, 0]) == 1
    play(env)
    assert int(env.worlds.teams["serves"][0, 1]) == 1
    play(env, 2)
    assert done_at(env) == [4]
