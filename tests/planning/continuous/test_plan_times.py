"""When plans do what: times by hand and against a plain twin."""

from __future__ import annotations

import numpy as np
import pytest

from random_coalitions import drawn_plan, is_able, plain_times, random_problem
from teamformer.planning.continuous.reactive import react
from teamformer.planning.continuous.solve import plan_together, solve
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import CoalitionProblem, pose_problem
from teamformer.planning.problem.constants import SPREAD
from teamformer.planning.problem.links import MAKESPAN as MAKESPAN_PART
from teamformer.planning.problem.links import link_tasks
from teamformer.planning.problem.schedule import (
    BACK_SUM,
    COST,
    LATE,
    MAKESPAN,
    Schedule,
    schedule_of,
)

SEEDS = range(12)


def corridor(forming: int = 0) -> CoalitionProblem:
    """Pose two robots at 0 on a line, and tasks at 4 (one robot, 3 ticks) and 10 (both, 2)."""
    at = np.array([4, 10, 0])
    ways = np.abs(at[:, None] - at[None, :2])
    return pose_problem(
        ways=[ways],
        home=[at, at],
        pace=[0, 0],
        origin=[2, 2],
        counts=[[1], [1]],
        needs=[[1], [2]],
        duration=[3, 2],
        forming=forming,
    )


def plan_of(
    problem: CoalitionProblem, order: list[int], coalitions: list[list[int]]
) -> CoalitionPlan:
    plan = empty_plan(problem)
    plan.order[:] = order
    for task, coalition in enumerate(coalitions):
        plan.size[task], plan.coalition[task, : len(coalition)] = len(coalition), coalition
    return plan


@pytest.mark.parametrize(
    ("order", "makespan", "starts"),
    [
        ([0, 1], 25, [4, 13]),  # 4 + 3, 6 on, 2 there, 10 home
        ([1, 0], 25, [18, 10]),  # 10 + 2, 6 back, 3 there, 4 home
    ],
)
def test_times_are_those_worked_out_by_hand(
    order: list[int], makespan: int, starts: list[int]
) -> None:
    schedule = schedule_of(corridor(), plan_of(corridor(), order, [[0], [0, 1]]))
    assert schedule.total[MAKESPAN] == makespan
    assert schedule.start.tolist() == starts


def test_who_comes_from_different_places_forms_first() -> None:
    problem = corridor(forming=5)
    assert schedule_of(problem, plan_of(problem, [0, 1], [[0], [0, 1]])).start.tolist() == [4, 18]
    together = plan_of(problem, [0, 1], [[0, 1], [0, 1]])
    assert schedule_of(problem, together).start.tolist() == [4, 13]


def assert_consistent(problem: CoalitionProblem, schedule: Schedule) -> None:
    """Compare all that is known of a plan with the plain twin."""
    makespan, back_sum, late, start = plain_times(problem, schedule.plan)
    assert schedule.start.tolist() == [start[task] for task in range(len(start))]
    assert schedule.total[MAKESPAN] == makespan
    assert schedule.total[BACK_SUM] == back_sum
    assert schedule.total[LATE] == late
    robots = len(problem.origin)
    assert schedule.total[COST] == makespan + back_sum // (SPREAD * robots) + 2 * late


@pytest.mark.parametrize("seed", SEEDS)
def test_a_plan_in_a_random_order_is_able_and_timed_as_its_twin_times_it(seed: int) -> None:
    problem = random_problem(seed, tasks=12)
    for draw in range(5):
        plan = drawn_plan(problem, draw)
        assert is_able(problem, plan)
        assert_consistent(problem, schedule_of(problem, plan))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_reactive_rule_makes_able_plans(seed: int) -> None:
    problem = random_problem(seed)
    solution = react(problem)
    assert solution is not None
    assert is_able(problem, solution.plan)
    assert_consistent(problem, schedule_of(problem, solution.plan))


def test_what_nobody_can_do_has_no_plan() -> None:
    parts = corridor()._asdict() | {"needs": np.array([[1], [3]], np.int32)}
    problem = CoalitionProblem(**parts)
    assert plan_together(problem) is None
    assert react(problem) is None


def test_the_only_task_is_done_by_who_is_home_first() -> None:
    """The fast robot is there after 3 ticks and home after 20 more; the slow one after 8 and 9."""
    problem = pose_problem(
        ways=[[[0], [3], [2]], [[0], [6], [8]]],
        home=[[20, 0, 0], [9, 0, 0]],
        pace=[0, 1],
        origin=[1, 2],
        counts=[[1], [1]],
        needs=[[1]],
        duration=[5],
    )
    solution = plan_together(problem)
    assert solution is not None
    assert solution.worth == 8 + 5 + 9


def one_is_busy() -> CoalitionProblem:
    """Pose a robot near to two tasks that is free after 10 ticks, and a free one farther away.

    The near one would be at the first task 3 ticks later. So the far one does that from 8 on, and
    the near one does the other from 10 + 1 on.
    """
    return pose_problem(
        ways=[[[0, 9], [9, 0], [3, 1], [8, 20]]],
        home=[[0, 0, 0, 0]] * 2,
        pace=[0, 0],
        origin=[2, 3],
        counts=[[1], [1]],
        needs=[[1], [1]],
        duration=[5, 5],
        ready=[10, 0],
    )


@pytest.mark.parametrize("cost", [None, {MAKESPAN_PART: 1.0}])
def test_robots_are_sent_from_when_they_are_free(cost: dict[int, float] | None) -> None:
    problem = one_is_busy()
    if cost is not None:
        problem = problem._replace(links=link_tasks(2, 2, (), cost))
    for solution in (plan_together(problem), react(problem)):
        assert solution is not None
        assert solution.worth == 10 + 1 + 5
        assert schedule_of(problem, solution.plan).start.tolist() == [8, 11]


def test_bounds_know_when_robots_are_free() -> None:
    problem = one_is_busy()._replace(ready=np.array([10, 9]))
    solution = solve(problem, 8.0)
    assert solution is not None
    assert (solution.worth, solution.bound, solution.is_proven) == (22, 22, True)
    # the second is there from 9 + 8 on
