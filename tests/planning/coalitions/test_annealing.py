"""The search over coalitions: times by hand and against a plain twin, changes judged exactly."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from random_coalitions import is_able, plain_times, random_problem
from teamformer.planning.coalitions.problem import NOBODY, CoalitionProblem, pose_problem
from teamformer.planning.coalitions.reactive import react
from teamformer.planning.coalitions.search.annealing import CoalitionSearch, schedule_of
from teamformer.planning.coalitions.search.schedule import (
    BACK_SUM,
    COST,
    LATE,
    MAKESPAN,
    SPREAD,
    CoalitionPlan,
    Schedule,
    empty_plan,
)
from teamformer.planning.coalitions.solve import plan_together

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


def search_of(problem: CoalitionProblem, seed: int) -> CoalitionSearch:
    search = CoalitionSearch(problem, seed)
    assert search.begin_anew()
    return search


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
def test_a_search_stands_at_a_plan_that_is_timed_as_its_twin_times_it(seed: int) -> None:
    problem = random_problem(seed)
    search = search_of(problem, seed)
    for turn in range(40):
        search.anneal(60, 20, turn * 5, turn * 5 + 5, 200)
        assert_consistent(problem, search._schedule)
        assert is_able(problem, search._schedule.plan)


@pytest.mark.parametrize("seed", SEEDS)
def test_heads_and_tails_add_up_to_the_makespan(seed: int) -> None:
    problem = random_problem(seed, is_plain=True)
    search = search_of(problem, seed)
    search.anneal(60, 20, 0, 200, 200)
    schedule = search._schedule
    through = schedule.start + schedule.tail
    assert through.max() == schedule.total[MAKESPAN]
    critical = schedule.critical[: schedule.criticals[0]]
    assert sorted(critical.tolist()) == np.flatnonzero(through == through.max()).tolist()


@pytest.mark.parametrize("seed", SEEDS)
def test_precedence_holds(seed: int) -> None:
    problem = random_problem(seed, tasks=12)
    search = search_of(problem, seed)
    search.anneal(40, 4, 0, 3000, 3000)
    schedule = schedule_of(problem, search.best)
    for task in range(12):
        for other in problem.before[task][problem.before[task] != NOBODY]:
            assert schedule.start[task] >= schedule.start[other] + problem.duration[other]


@pytest.mark.parametrize("seed", SEEDS)
def test_searching_on_never_loses_the_best(seed: int) -> None:
    problem = random_problem(seed)
    search = search_of(problem, seed)
    first = search.cost
    search.anneal(60, 5, 0, 2000, 2000)
    assert search.cost <= first
    assert schedule_of(problem, search.best).total[COST] == search.cost


@pytest.mark.parametrize("seed", SEEDS)
def test_the_reactive_rule_makes_able_plans(seed: int) -> None:
    problem = random_problem(seed)
    solution = react(problem)
    assert solution is not None
    assert is_able(problem, solution.schedule.plan)
    assert_consistent(problem, solution.schedule)


def test_what_nobody_can_do_has_no_plan() -> None:
    parts = corridor()._asdict() | {"needs": np.array([[1], [3]], np.int32)}
    problem = CoalitionProblem(**parts)
    assert plan_together(problem) is None
    assert react(problem) is None


SCRIPT = """
from random_coalitions import random_problem
from teamformer.planning.coalitions.search.annealing import CoalitionSearch
for seed in range(3):
    search = CoalitionSearch(random_problem(seed), seed)
    search.begin_anew()
    search.anneal(60, 5, 0, 150, 150)
    print(search.cost, search.best.order.tolist(), search.best.size.tolist())
"""


def test_the_plan_is_the_same_without_compiled_code() -> None:
    def shown(**changed: str) -> str:
        env = {**os.environ, **changed, "PYTHONPATH": os.pathsep.join(sys.path)}
        words = [sys.executable, "-W", "ignore", "-c", SCRIPT]
        return subprocess.run(words, env=env, check=True, capture_output=True, text=True).stdout

    assert shown() == shown(NUMBA_DISABLE_JIT="1")
