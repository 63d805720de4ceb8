"""The graph of arcs: times and tails against plain recomputation, changes that are undone."""

from __future__ import annotations

import itertools
import os
import subprocess
import sys

import numpy as np
import pytest

from random_coalitions import drawn_plan, is_able, least_coalitions, plain_times, random_problem
from teamformer.planning.graph.arc_problem import different_needs, pose_arcs
from teamformer.planning.graph.graph import AIM, BACK_SUM, COST, MAKESPAN, read_off
from teamformer.planning.problem import schedule as by_schedule
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import (
    NEVER,
    NOBODY,
    CoalitionProblem,
    pose_problem,
)
from teamformer.planning.problem.schedule import schedule_of
from teamformer.planning.search.arc_search import ArcSearch

SEEDS = range(12)


def lasting(
    seed: int, tasks: int = 12, robots: int = 6, is_plain: bool = False
) -> CoalitionProblem:
    """Draw a problem as a graph of arcs has it: everything takes time, and nothing is ever late."""
    problem = random_problem(seed, tasks, robots, is_plain=is_plain)
    due = np.full_like(problem.due, NEVER)
    return problem._replace(duration=np.maximum(problem.duration, 1), due=due)


def rank_of(problem: CoalitionProblem, plan: CoalitionPlan) -> tuple[int, int]:
    """Return what a plan is compared by, by the other schedule."""
    total = schedule_of(problem, plan).total
    return int(total[by_schedule.MAKESPAN]), int(total[by_schedule.COST])


def plan_at(search: ArcSearch) -> CoalitionPlan:
    """Return the plan that a search stands at."""
    plan = empty_plan(search.problem)
    read_off(search.arcs, search.graph, plan)
    plan.order[:] = np.argsort(search.graph.nodes.key[: len(plan.order)], kind="stable")
    return plan


def plain_tails(problem: CoalitionProblem, plan: CoalitionPlan) -> list[int]:
    """Return the longest chain from the start of each task to the end, worked out backwards."""
    tail = [0] * len(plan.order)
    next_of: dict[int, int] = {}
    for task in reversed(plan.order.tolist()):
        longest = 0
        for robot in plan.coalition[task, : plan.size[task]].tolist():
            if robot in next_of:
                way = problem.ways[problem.pace[robot], task, next_of[robot]]
                longest = max(longest, int(way) + tail[next_of[robot]])
            else:
                longest = max(longest, int(problem.home[problem.kind[robot], task]))
            next_of[robot] = task
        longest = max([longest, *(tail[o] for o in problem.after[task] if o != NOBODY)])
        tail[task] = int(problem.duration[task]) + longest
    return tail


def assert_consistent(problem: CoalitionProblem, search: ArcSearch) -> None:
    """Compare all that is known of the graph with its plain twin, and with the other schedule."""
    plan, graph, tasks = plan_at(search), search.graph, len(problem.needs)
    makespan, back_sum, _, start = plain_times(problem, plan)
    nodes = graph.nodes[:tasks]
    assert is_able(problem, plan)
    assert (nodes.end - nodes.duration).tolist() == [start[task] for task in range(tasks)]
    assert nodes.key.tolist() == [2 * start[task] + 1 for task in range(tasks)]
    assert nodes.tail.tolist() == plain_tails(problem, plan)
    assert graph.total[[MAKESPAN, BACK_SUM, AIM]].tolist() == [makespan, back_sum, makespan]
    assert schedule_of(problem, plan).total[COST] == graph.total[COST]


@pytest.mark.parametrize("is_plain", [True, False])
@pytest.mark.parametrize("seed", SEEDS)
def test_a_plan_that_is_laid_out_is_read_off_again(seed: int, is_plain: bool) -> None:
    problem = lasting(seed, is_plain=is_plain)
    plan, search = drawn_plan(problem, seed), ArcSearch(problem, seed)
    search.begin_at(plan)
    assert_consistent(problem, search)
    assert search.rank == rank_of(problem, plan)


@pytest.mark.parametrize("is_plain", [True, False])
@pytest.mark.parametrize("seed", SEEDS)
def test_times_that_are_worked_out_as_they_change_are_those_of_the_whole_plan(
    seed: int, is_plain: bool
) -> None:
    problem = lasting(seed, is_plain=is_plain)
    search = ArcSearch(problem, seed)
    search.begin_at(drawn_plan(problem, seed))
    for turn in range(60):
        search.anneal(90, 30, turn * 5, turn * 5 + 5, 300)
        assert_consistent(problem, search)


@pytest.mark.parametrize("seed", SEEDS)
def test_searching_on_never_loses_the_best(seed: int) -> None:
    problem = lasting(seed)
    search = ArcSearch(problem, seed)
    assert search.begin_anew()
    first = search.rank
    search.anneal(60, 5, 0, 3000, 3000)
    assert search.rank <= first
    assert rank_of(problem, search.best) == search.rank
    search.begin_at_best()
    assert_consistent(problem, search)


@pytest.mark.parametrize("seed", SEEDS)
def test_what_takes_no_time_is_planned_too(seed: int) -> None:
    problem = lasting(seed, 20, 5)._replace(duration=np.zeros(20, np.int64))
    search = ArcSearch(problem, seed)
    assert search.begin_anew()
    search.anneal(60, 5, 0, 2000, 2000)
    schedule = schedule_of(problem, search.best)
    assert is_able(problem, search.best)
    assert rank_of(problem, search.best) <= search.rank
    for task in range(20):
        for other in problem.before[task][problem.before[task] != NOBODY]:
            assert schedule.start[task] >= schedule.start[other]


def all_different(seed: int, robots: int, tasks: int) -> CoalitionProblem:
    """Draw a problem in which no two robots bring the same."""
    rng = np.random.default_rng(seed)
    at = rng.integers(0, 100, (tasks + 1, 2))
    ways = np.rint(np.linalg.norm(at[:, None] - at[None, :tasks], axis=2))
    return pose_problem(
        ways=[ways],
        home=np.zeros((robots, tasks + 1)),
        pace=np.zeros(robots),
        origin=np.full(robots, tasks),
        counts=1 + np.arange(3 * robots).reshape(robots, 3) * np.array([1, 7, 3]) % 97,
        needs=rng.integers(0, 200, (tasks, 3)),
        duration=rng.integers(1, 60, tasks),
    )


def test_robots_that_are_all_different_are_chosen_one_after_the_other() -> None:
    problem = all_different(0, robots=60, tasks=40)
    search = ArcSearch(problem, 0)
    assert not search.arcs.listed.any()
    assert search.begin_anew()
    first = search.rank
    search.anneal(60, 5, 0, 5000, 5000)
    assert search.rank < first
    assert is_able(problem, search.best)
    assert rank_of(problem, search.best) == search.rank


@pytest.mark.parametrize("seed", SEEDS)
def test_covers_are_all_coalitions_with_nobody_to_spare(seed: int) -> None:
    problem = random_problem(seed, robots=7)
    problem = problem._replace(needs=problem.needs + (problem.needs > 0) * (seed % 2))
    arcs = pose_arcs(problem)
    type_of = arcs.kinds.type[problem.kind]
    number = [np.flatnonzero(type_of == which) for which in range(len(arcs.counts))]
    _, need_of = different_needs(problem)
    for task, need in enumerate(need_of):
        listed = set()
        for cover in arcs.covers[need, : arcs.listed[need]]:
            parts = [(which, count) for which, count in cover.tolist() if which != NOBODY]
            choices = [itertools.combinations(number[w].tolist(), c) for w, c in parts]
            for picked in itertools.product(*choices):
                listed.add(tuple(sorted(itertools.chain(*picked))))
        assert listed == set(least_coalitions(problem, task))


UNDOING = """
import numpy as np
from random_coalitions import drawn_plan
from test_arcs import assert_consistent, lasting
from teamformer.planning.graph.arc_problem import most_seats
from teamformer.planning.graph.graph import COST
from teamformer.planning.graph.changes import (undo)
from teamformer.planning.graph.judging import (propagate)
from teamformer.planning.graph.ledger import accept_change, begin_change, sum_up_change
from teamformer.planning.operators.draws import draw_task
from teamformer.planning.operators.exchanges import exchange_rests
from teamformer.planning.operators.task_moves import move_task
from teamformer.planning.search.arc_search import ArcSearch

changed = {"swap": 0, "move": 0}
for seed in range(6):
    problem = lasting(seed, robots=12, is_plain=seed % 3 > 0)
    search = ArcSearch(problem, seed)
    search.begin_at(drawn_plan(problem, seed))
    arcs, state = search.arcs, search.state
    graph, trial, ledger = state.graph, state.trial, state.ledger
    for turn in range(200):
        before = [array.copy() for array in graph]
        limit = graph.total[COST] // (1 + turn % 3 // 2) + 100 * (turn % 3)
        task = draw_task(arcs, state)
        what = "swap" if turn % 2 else "move"
        begin_change(trial, ledger)
        change = exchange_rests if what == "swap" else move_task
        is_short = change(arcs, state, task, 40, limit)
        is_short = is_short and propagate(arcs, graph, trial, limit)
        if is_short:
            sum_up_change(arcs, graph, trial, ledger)
        if is_short and turn % 5 == 0:
            accept_change(arcs, graph, trial, ledger)
            assert_consistent(problem, search)
            continue
        changed[what] += trial.number[0] > 0
        undo(graph, trial)
        most = most_seats(problem)
        taken = [at * most + np.arange(n) for at, n in enumerate(before[0].taken[:12])]
        depots_and_homes = np.arange(12 * most, len(before[1]))
        in_use = np.concatenate([*taken, depots_and_homes])
        assert (before[1][in_use] == graph.seats[in_use]).all()
        for old, new in zip((before[0], *before[2:]), (graph[0], *graph[2:]), strict=True):
            assert (old == new).all()
assert changed["swap"] > 20, changed
assert changed["move"] > 100, changed
"""

SEARCHING = """
from random_coalitions import drawn_plan, random_problem
from teamformer.planning.search.arc_search import ArcSearch
for seed in range(3):
    problem = random_problem(seed, 20)
    print(drawn_plan(problem, seed).order.tolist())
    search = ArcSearch(problem, seed)
    search.begin_anew()
    search.anneal(60, 5, 0, 300, 300)
    print(search.rank, search.best.order.tolist(), search.best.size.tolist())
"""


def run_script(script: str, **changed: str) -> str:
    path = os.pathsep.join([*sys.path, os.path.dirname(__file__)])
    env = {**os.environ, **changed, "PYTHONPATH": path}
    words = [sys.executable, "-W", "ignore", "-c", script]
    return subprocess.run(words, env=env, check=True, capture_output=True, text=True).stdout


@pytest.mark.thorough
def test_a_change_that_is_refused_leaves_everything_as_it_was() -> None:
    run_script(UNDOING, NUMBA_DISABLE_JIT="1")


@pytest.mark.thorough
def test_the_plan_is_the_same_without_compiled_code() -> None:
    assert run_script(SEARCHING) == run_script(SEARCHING, NUMBA_DISABLE_JIT="1")
