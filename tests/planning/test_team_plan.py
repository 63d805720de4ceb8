"""Plans with forming counted: their times by hand, and against a slow twin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from plain_teams import slow_ends
from random_worlds import random_world, with_precedence_and_windows
from teamformer.files.drawn.generate import Spec, generate
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.planning.problem.coalition_plan import keep_order, plan_of_lists, routes_of
from teamformer.planning.step_times.crossings import no_crossings
from teamformer.planning.step_times.groups import Groups, empty_groups
from teamformer.planning.step_times.timing import LATE, STEP, STEP_OF_END, STEP_WALKED, time_plan
from teamformer.planning.steps.situation import situation_in_hindsight
from teamformer.planning.steps.timed_plan import time_team_plan


def corridor(places: list[int], tasks: list[Task], forming_steps: int = 1) -> Mission:
    """Draw robots, each able to do "a", in a corridor."""
    robots = tuple(Robot(f"r{n}", (x, 0), {"a": 1}) for n, x in enumerate(places))
    return Mission(
        "corridor", Grid(30, 1), ("a",), robots, tuple(tasks), forming_steps=forming_steps
    )


def task(x: int, count: int, duration: int = 0) -> Task:
    return Task(f"t{x}", (x, 0), {"a": count}, duration=duration)


def timed(mission: Mission, order: list[int], crews: list[list[int]]) -> tuple[int, int, Groups]:
    """Return cost, lead and what timing a plan left, nothing being done on the way."""
    situation = situation_in_hindsight(mission)
    groups = empty_groups(situation.problem, situation.company, mission.forming_steps)
    plan = plan_of_lists(order, crews)
    cost, lead = time_plan(situation.problem, no_crossings(), plan, groups)
    return int(cost), int(lead), groups


def ends(mission: Mission, order: list[int], crews: list[list[int]]) -> list[int]:
    """Return the step in which each task is done, by number."""
    _, _, groups = timed(mission, order, crews)
    return groups.end[: len(order)].tolist()


def test_a_lone_robot_pays_nothing() -> None:
    assert ends(corridor([0], [task(5, 1), task(2, 1)]), [1, 0], [[0], [0]]) == [5, 2]


@pytest.mark.parametrize(("robots", "steps"), [(2, 1), (3, 2), (4, 2), (5, 3), (8, 3), (9, 4)])
def test_robots_that_meet_pair_up(robots: int, steps: int) -> None:
    mission = corridor([0] * robots, [task(4, robots)])
    assert ends(mission, [0], [list(range(robots))]) == [4 + steps]


def test_those_that_came_earlier_have_joined_already() -> None:
    # three are there after 2 steps, two of them join in step 3, the third in 4, the last in 10
    assert ends(corridor([2, 2, 2, 13], [task(4, 4)]), [0], [[0, 1, 2, 3]]) == [10]


def test_going_on_together_is_free_and_parting_is_not() -> None:
    tasks = [task(4, 2), task(8, 1), task(1, 1)]
    mission = corridor([4, 4], tasks)
    assert ends(mission, [0, 1, 2], [[0, 1], [0, 1], [0, 1]]) == [1, 5, 12]
    assert ends(mission, [0, 1, 2], [[0, 1], [0], [1]]) == [1, 6, 5]
    assert ends(corridor([4, 4], tasks, 0), [0, 1, 2], [[0, 1], [0], [1]]) == [1, 5, 4]


def test_who_has_nothing_left_to_do_is_left_behind_at_the_cost_of_a_split() -> None:
    mission = corridor([4, 4], [task(4, 2), task(8, 1)])
    assert ends(mission, [0, 1], [[0, 1], [0]]) == [1, 6]


def test_the_cost_is_of_the_makespan_and_ends_and_steps_walked_only_lead_the_search() -> None:
    # five cells for one robot; ends at 2 and 5
    cost, lead, _ = timed(corridor([0], [task(5, 1), task(2, 1)]), [1, 0], [[0], [0]])
    assert (cost, lead - cost) == (STEP * 2 * 5, STEP_OF_END * (2 + 5) + STEP_WALKED * 5)


@pytest.mark.parametrize(("lost", "late"), [(5, 1), (6, 0)])
def test_robots_that_are_lost_before_they_are_done_cost_much(lost: int, late: int) -> None:
    mission = corridor([0], [task(5, 1)])
    robot = replace(mission.robots[0], absences=(Absence(lost),))
    cost, _, _ = timed(replace(mission, robots=(robot,)), [0], [[0]])
    assert cost == STEP * (5 + LATE * late)


def test_three_ways_take_two_splits_the_last_two_at_once() -> None:
    tasks = [task(10, 3), task(8, 1), task(12, 1), task(15, 1)]
    # together after 2 joining steps; the first way leaves after step 3, the others after step 4
    found = ends(corridor([10, 10, 10], tasks), [0, 1, 2, 3], [[0, 1, 2], [0], [1], [2]])
    assert found == [2, 3 + 2, 4 + 2, 4 + 5]


def test_a_crew_stays_for_the_duration() -> None:
    mission = corridor([0], [task(3, 1, duration=4), task(5, 1)])
    assert ends(mission, [0, 1], [[0], [0]]) == [7, 9]


def test_a_task_starts_in_the_step_after_those_before_it_are_done() -> None:
    """The first two steps to `t2` and three of service; the other is at `t4` long before."""
    after = replace(task(4, 1), after=("t2",))
    mission = corridor([0, 4], [after, task(2, 1, duration=3)])
    assert ends(mission, [1, 0], [[1], [0]]) == [6, 5]


def test_what_comes_after_others_is_not_done_in_passing_before_these() -> None:
    """On its way to `t9` the robot passes `t4`, which comes after `t9`."""
    mission = corridor([0], [replace(task(4, 1), after=("t9",)), task(9, 1)])
    timed_plan = time_team_plan(situation_in_hindsight(mission), plan_of_lists([0, 1], [[0], [0]]))
    assert timed_plan.plan.order.tolist() == [1, 0]
    assert timed_plan.ends.tolist() == [14, 9]
    free = corridor([0], [task(4, 1), task(9, 1)])
    timed_plan = time_team_plan(situation_in_hindsight(free), plan_of_lists([1, 0], [[0], [0]]))
    assert timed_plan.ends.tolist() == [4, 9]


def test_routes_follow_the_order() -> None:
    assert routes_of(plan_of_lists([2, 0, 1], [[0], [1, 0], [1]]), 2) == [[0, 1], [2, 1]]


@pytest.mark.parametrize("seed", range(40))
def test_times_are_those_of_a_slow_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mission = random_world(rng, with_losses=False) if seed % 2 else generate(Spec(6, 9, 3), rng)
    if seed % 3 == 0:
        mission = with_precedence_and_windows(mission, rng, windows=0)
    problem = situation_in_hindsight(mission).problem
    robots, tasks = len(mission.robots), len(mission.tasks)
    crews = [rng.permutation(robots)[: rng.integers(1, robots + 1)].tolist() for _ in range(tasks)]
    order = keep_order(problem.before, rng.permutation(tasks).tolist())
    cost, _, groups = timed(mission, order, crews)
    slow = slow_ends(mission, problem, plan_of_lists(order, crews))
    assert groups.end[:tasks].tolist() == slow
    assert cost == STEP * tasks * max(slow)
