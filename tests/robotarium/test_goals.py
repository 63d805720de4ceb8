"""Slots, detours and places, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from teamformer.robotarium.control.detours import AMPLE, BERTH, BEYOND, way_point
from teamformer.robotarium.control.goals import (
    FARTHER,
    GIVES_UP,
    LATTICE,
    Goals,
    Work,
    choose_goals,
    choose_needed,
)
from teamformer.robotarium.control.ring_slots import SPACING, ring_radius, slots_around
from teamformer.robotarium.control.teams import RobotTeam, distance
from teamformer.robotarium.places import team_places

MIDDLE = np.array([1.6, 1.0])


def goals_at(places: list[list[float]], has_slot: list[bool]) -> Goals:
    """Everybody's goal and whether it is a slot."""
    array = np.array(places)
    slots = np.array(has_slot)
    return Goals(array, array, slots, ~slots, ~slots)


@pytest.mark.parametrize("robots", [2, 3, 5, 12])
def test_neighbours_on_a_ring_are_a_spacing_apart(robots: int) -> None:
    slots = slots_around(np.array([0.3, 0.2]), robots)
    apart = np.linalg.norm(slots - np.roll(slots, 1, axis=0), axis=1)
    np.testing.assert_allclose(apart, SPACING)
    away = np.linalg.norm(slots - [0.3, 0.2], axis=1)
    np.testing.assert_allclose(away, ring_radius(robots))


def test_one_robot_stands_on_its_task() -> None:
    np.testing.assert_array_equal(slots_around(np.array([0.3, 0.2]), 1), [[0.3, 0.2]])


def test_a_task_gets_no_more_robots_than_it_needs() -> None:
    """It needs a and b; a team has both and a spare a; a single b is nearer, but not needed."""
    robots = np.array([[0.5, 0.0], [0.4, 0.0], [0.6, 0.0], [0.1, 0.0]])
    brings = np.array([[1, 0], [0, 1], [1, 0], [0, 1]])
    work = Work(np.zeros((1, 2)), np.array([[1, 1]]), brings)
    teams = [RobotTeam(0, (0, 1, 2), 0, None), RobotTeam(3, (3,), 0, None)]
    assert choose_needed(teams, robots, work, 0) == [1, 0]
    assert choose_needed(teams[1:], robots, work, 0) == [3]


def test_who_is_not_needed_keeps_clear_and_a_joiner_seeks_its_partner() -> None:
    robots = np.array([[0.5, 0.0], [0.1, 0.0], [-1.0, 0.5]])
    work = Work(np.zeros((1, 2)), np.array([[1]]), np.ones((3, 1), dtype=int))
    teams = [
        RobotTeam(0, (0,), 0, None),
        RobotTeam(1, (1,), None, None),
        RobotTeam(2, (2,), None, 0),
    ]
    goals = choose_goals(teams, robots, work, np.array([True]), np.zeros(3))
    np.testing.assert_array_equal(goals.places[0], [0.0, 0.0])
    assert np.linalg.norm(goals.places[1]) >= 0.3  # outside the clearance, and near
    assert np.linalg.norm(goals.places[1] - robots[1]) < 0.4
    np.testing.assert_array_equal(goals.places[2], robots[0])
    assert goals.has_slot.tolist() == [True, False, False]
    assert goals.is_idle.tolist() == [False, False, False]
    assert goals.keeps_clear.tolist() == [False, True, False]


def test_who_does_not_get_clear_looks_farther_off() -> None:
    robots = np.array([[0.1, 0.0], [0.6, 0.0]])
    work = Work(np.zeros((1, 2)), np.array([[1]]), np.ones((2, 1), dtype=int))
    teams = [RobotTeam(0, (0,), None, None), RobotTeam(1, (1,), None, None)]
    is_open = np.array([True])
    away = []
    for decisions in (0, GIVES_UP - 1, GIVES_UP, 2 * GIVES_UP):
        goals = choose_goals(teams, robots, work, is_open, np.array([decisions, 0]))
        away.append(np.linalg.norm(goals.places[0] - robots[0]))
        assert goals.is_idle.tolist() == [False, True]  # the other is clear of the ring
    assert away[0] == away[1] < FARTHER
    np.testing.assert_allclose(away[2:], [FARTHER, 2 * FARTHER], atol=LATTICE / 2)


def test_a_way_leads_around_a_ring() -> None:
    centres, radii = np.array([[0.0, 0.05]]), np.array([0.1])
    at, goal = np.array([-1.0, 0.0]), np.array([1.0, 0.0])
    beside = way_point(at, goal, centres, radii)  # the ring is to the left: pass on the right
    np.testing.assert_allclose(beside, [0.0, 0.05 - AMPLE * (0.1 + BERTH)])
    np.testing.assert_array_equal(way_point(beside, goal, centres, radii), goal)
    np.testing.assert_array_equal(way_point(at, goal, centres + np.array([0.0, 0.5]), radii), goal)
    np.testing.assert_array_equal(way_point(at, centres[0], centres, radii), centres[0])


def test_a_way_leads_midway_between_two_rings_or_around_both() -> None:
    """Rings of 0.2 m, 0.8 m apart: the gap is 0.4 m. In the middle the robot goes straight on."""
    centres, radii = np.array([[0.0, 0.4], [0.0, -0.4]]), np.array([0.2, 0.2])
    at, goal = np.array([-0.6, 0.05]), np.array([0.6, 0.05])
    np.testing.assert_allclose(way_point(at, goal, centres, radii), [BEYOND, 0.0], atol=1e-12)
    for y in (-0.03, 0.0, 0.03):  # no going to and fro, wherever it is in the gap
        heading = way_point(np.array([-0.01, y]), goal, centres, radii)
        np.testing.assert_allclose(heading, [BEYOND, 0.0], atol=1e-12)
    nearer = np.array([[0.0, 0.3], [0.0, -0.3]])  # a gap of 0.2 m: nobody passes
    around = way_point(at, goal, nearer, radii)
    assert around[1] > 0.3 + 0.2


def test_a_team_is_at_its_task_when_all_its_slots_are_filled() -> None:
    tasks, team = np.array([[2.0, 1.0]]), [RobotTeam(0, (0, 1), 0, None)]
    slots = [[0.3, 0.0], [0.5, 0.0]]
    goals = goals_at(slots, [True, True])
    filled = np.array(slots) + np.array([[0.04, 0.0], [0.0, -0.04]])
    place = team_places(team, filled, goals, tasks, 0.05)[0]
    assert np.linalg.norm(place - tasks[0]) < 0.05
    nearly = np.array(slots) + np.array([[0.06, 0.0], [-0.06, 0.0]])
    place = team_places(team, nearly, goals, tasks, 0.05)[0]
    assert np.linalg.norm(place - tasks[0]) > 0.05  # though the two are at it on average


def test_contact_makes_one_place_of_two_but_not_of_both_a_worker() -> None:
    """A second team within 0.4 m of one at the task may join it, but does not do the task."""
    tasks = np.array([[2.0, 1.0]])
    teams = [RobotTeam(0, (0,), 0, None), RobotTeam(1, (1,), 0, None)]
    goals = goals_at([[0.4, 0.0], [0.4, 0.0]], [True, False])
    for away, same in ((0.39, True), (0.41, False)):
        robots = np.array([[0.4, 0.0], [0.4 + away, 0.0]])
        first, second = team_places(teams, robots, goals, tasks, 0.05)
        assert np.linalg.norm(first - tasks[0]) <= 0.05 < np.linalg.norm(second - tasks[0])
        assert (np.linalg.norm(first - second) <= 0.05) == same


def test_teams_with_other_tasks_do_not_meet() -> None:
    tasks = np.array([[2.0, 1.0], [1.0, 1.0]])
    teams = [RobotTeam(0, (0,), 0, None), RobotTeam(1, (1,), 1, None)]
    robots = np.array([[0.0, 0.0], [0.2, 0.0]])
    first, second = team_places(teams, robots, goals_at([[1, 1], [1, 1]], [True] * 2), tasks, 0.05)
    np.testing.assert_allclose([first, second], robots + MIDDLE)


def test_teams_are_as_far_apart_as_their_nearest_robots() -> None:
    robots = np.array([[0.0, 0.0], [1.0, 0.0], [1.3, 0.4], [9.0, 9.0]])
    assert (
        distance(RobotTeam(0, (0, 1), None, None), RobotTeam(2, (2, 3), None, None), robots) == 0.5
    )
