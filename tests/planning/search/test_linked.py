"""Tasks whose starts are linked: times by hand and against a plain twin, small optima."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import pytest

from random_coalitions import all_plans, is_able, random_problem
from teamformer.planning.continuous.solve import plan_together, solve
from teamformer.planning.graph.graph import read_off
from teamformer.planning.graph.ledger import NOW
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import CoalitionProblem, pose_problem
from teamformer.planning.problem.links import (
    COMPLETION,
    FREE,
    HOME,
    MAKESPAN,
    MAX_TARDINESS,
    TARDINESS,
    TRAVEL,
    Link,
    link_tasks,
)
from teamformer.planning.search.arc_search import ArcSearch

SEEDS = range(4)
WEIGHTS = {MAKESPAN: 3, TRAVEL: 2, TARDINESS: 4, MAX_TARDINESS: 5, COMPLETION: 1}


def lasting(seed: int, tasks: int, **sizes: int) -> CoalitionProblem:
    """Draw a problem in which everything takes time, as it does in a graph of arcs."""
    base = random_problem(seed, tasks=tasks, **sizes)
    return base._replace(duration=np.maximum(base.duration, 1))


def link_problem(
    base: CoalitionProblem,
    links: Sequence[Link],
    weight: Mapping[int, float],
    task_weight: npt.ArrayLike | None = None,
) -> CoalitionProblem:
    sizes = (len(base.needs), len(base.counts))
    return base._replace(links=link_tasks(*sizes, links, weight, task_weight))


def random_linked(seed: int, tasks: int = 8, **sizes: int) -> CoalitionProblem:
    """Draw a problem in which the last two tasks are linked, and the two before, too.

    For odd seeds all four are, in a row.
    """
    base = lasting(seed, tasks, **({"robots": 12} | sizes))
    rng = np.random.default_rng(seed)
    before = np.full_like(base.before, -1)  # precedence among linked tasks might go in a circle
    base = base._replace(before=before, after=np.full_like(base.after, -1))
    least = int(rng.integers(0, 60))
    links = [Link(tasks - 1, tasks - 2, least, least + int(rng.integers(0, 40)))]
    if tasks > 4:
        links.append(Link(tasks - 3, tasks - 4, 0, 0))
    if tasks > 4 and seed % 2:
        links.append(Link(tasks - 2, tasks - 3, 0, 400))
    return link_problem(base, links, WEIGHTS, rng.integers(1, 4, tasks))


def plain_cost(
    problem: CoalitionProblem, plan: CoalitionPlan
) -> tuple[int | None, dict[int, int], list[int]]:
    """Return what a plan costs, when tasks start, and its parts; no cost if some wait for ever.

    Whatever has to wait for something waits longer, again and again, until nothing changes.
    """
    base, tasks = problem, len(plan.order)
    at = [int(origin) for origin in base.origin]
    start = {task: int(base.release[task]) for task in range(tasks)}
    lags: list[tuple[int, int, int]] = []  # (one, two, lag): two starts so long after one does
    travel = 0
    for task in plan.order.tolist():
        crew = plan.coalition[task, : plan.size[task]].tolist()
        forms = len({int(base.site[at[r]]) for r in crew}) > 1
        for robot in crew:
            way = int(base.ways[base.pace[robot], at[robot], task])
            wait = way + int(base.forming[0]) * forms
            if at[robot] < tasks:
                lags.append((at[robot], task, wait + int(base.duration[at[robot]])))
            else:
                start[task] = max(start[task], wait)
            travel, at[robot] = travel + way, task
        lags += [(o, task, int(base.duration[o])) for o in base.before[task].tolist() if o >= 0]
    for one, two in np.argwhere(problem.links.gap > FREE).tolist():
        lags.append((one, two, int(problem.links.gap[one, two])))
    for _ in range(tasks + 1):
        was = dict(start)
        for one, two, lag in lags:
            start[two] = max(start[two], start[one] + lag)
        if start == was:
            break
    else:
        return None, start, []
    end = {task: start[task] + int(base.duration[task]) for task in range(tasks)} | {
        place: 0 for place in at if place >= tasks
    }
    late = [max(0, end[task] - int(base.due[task])) for task in range(tasks)]
    home = [int(base.home[k, p]) for k, p in zip(base.kind, at, strict=True)]
    back = [end[place] + way for place, way in zip(at, home, strict=True)]
    parts = {
        MAKESPAN: max(back),
        HOME: sum(back),
        TRAVEL: travel + sum(home),
        TARDINESS: sum(int(w) * by for w, by in zip(problem.links.task_weight, late, strict=True)),
        MAX_TARDINESS: max(late),
        COMPLETION: sum(int(problem.links.task_weight[task]) * end[task] for task in range(tasks)),
    }
    told = [parts[part] for part in range(len(parts))]
    cost = sum(int(problem.links.weight[part]) * by for part, by in parts.items() if part != HOME)
    return cost, start, told


def are_apart(problem: CoalitionProblem, plan: CoalitionPlan) -> bool:
    """Say whether no robot does two tasks that are linked directly."""
    crews = [set(row[:size].tolist()) for row, size in zip(plan.coalition, plan.size, strict=True)]
    return not any(crews[one] & crews[two] for one, two in np.argwhere(problem.links.gap > FREE))


def plan_at(search: ArcSearch) -> CoalitionPlan:
    """Return the plan that a search stands at."""
    plan = empty_plan(search.problem)
    read_off(search.arcs, search.graph, plan)
    plan.order[:] = np.argsort(search.graph.nodes.key[: len(plan.order)], kind="stable")
    return plan


def assert_consistent(search: ArcSearch) -> None:
    """Compare what is known of a graph with what its twin makes of the plan."""
    problem, plan, tasks = search.problem, plan_at(search), len(search.problem.links.group)
    cost, start, parts = plain_cost(problem, plan)
    nodes = search.graph.nodes[:tasks]
    assert is_able(problem, plan)
    assert are_apart(problem, plan)
    assert (nodes.end - nodes.duration).tolist() == [start[task] for task in range(tasks)]
    assert nodes.key.tolist() == [2 * start[task] + 1 for task in range(tasks)]
    assert search.state.ledger.part.tolist() == parts
    assert search.state.ledger.cost[NOW] == cost


def corridor(links: list[Link]) -> CoalitionProblem:
    """Pose two robots at 0 on a line with tasks at 4 and 10, for the one and for the other."""
    at = np.array([4, 10, 0])
    base = pose_problem(
        ways=[np.abs(at[:, None] - at[None, :2])],
        home=[at, at],
        pace=[0, 0],
        origin=[2, 2],
        counts=[[1, 0], [0, 1]],
        needs=[[1, 0], [0, 1]],
        duration=[3, 2],
        due=[8, 12],
    )
    return link_problem(base, links, {TRAVEL: 1, TARDINESS: 1, MAX_TARDINESS: 1})


@pytest.mark.parametrize(
    ("links", "starts", "late"),
    [
        ([], [4, 10], 0),
        ([Link(1, 0, 0, 0)], [10, 10], 10 + 3 - 8),  # the first waits for the second
        ([Link(0, 1, 0, 0)], [10, 10], 5),
        ([Link(1, 0, 8, 9)], [4, 12], 12 + 2 - 12),  # the second waits
        ([Link(1, 0, 2, 5)], [5, 10], 0),  # the first waits a little, and is in time
        ([Link(0, 1, 2, 5)], [12, 10], 12 + 3 - 8),
    ],
)
def test_times_are_those_worked_out_by_hand(
    links: list[Link], starts: list[int], late: int
) -> None:
    problem = corridor(links)
    search = ArcSearch(problem, 0)
    assert search.begin_anew()
    assert (search.graph.nodes.end - search.graph.nodes.duration)[:2].tolist() == starts
    assert search.rank[0] == 2 * 4 + 2 * 10 + 2 * late  # ways, tardiness and the largest


@pytest.mark.parametrize("seed", range(12))
def test_a_search_stands_at_a_plan_that_is_timed_as_its_twin_times_it(seed: int) -> None:
    search = ArcSearch(random_linked(seed, tasks=8 + seed), seed)
    assert search.begin_anew()
    assert_consistent(search)
    for turn in range(60):
        search.anneal(4000 - 60 * turn, 4000 - 60 * turn, 0, 5, 5)
        assert_consistent(search)
    search.begin_at(search.best)
    assert_consistent(search)
    assert search.state.ledger.cost[NOW] == search.rank[0]


@pytest.mark.parametrize("seed", SEEDS)
def test_precedence_holds(seed: int) -> None:
    base = lasting(seed, 10)
    search = ArcSearch(link_problem(base, [], WEIGHTS), seed)
    assert search.begin_anew()
    search.anneal(2000, 2000, 0, 3000, 3000)
    assert_consistent(search)
    cost, start, _ = plain_cost(search.problem, search.best)
    assert cost == search.rank[0]
    for task, others in enumerate(base.before.tolist()):
        assert all(start[task] >= start[o] + base.duration[o] for o in others if o >= 0)


@pytest.mark.parametrize("seed", SEEDS)
def test_small_problems_are_solved(seed: int) -> None:
    problem = random_linked(seed, tasks=4, robots=4, caps=2)
    costs = [
        cost
        for plan in all_plans(problem)
        if are_apart(problem, plan) and (cost := plain_cost(problem, plan)[0]) is not None
    ]
    found = plan_together(problem)
    if not costs:
        assert found is None
    else:
        assert found is not None
        assert found.worth == min(costs)


def test_a_task_may_be_done_between_two_that_are_linked_on_the_way_of_their_robots() -> None:
    """One starts 20 to 30 after the other; meanwhile both robots do a third one together."""
    base = pose_problem(
        ways=[np.ones((4, 3))],
        home=np.ones((2, 4)),
        pace=[0, 0],
        origin=[3, 3],
        counts=[[1, 0], [0, 1]],
        needs=[[1, 0], [0, 1], [1, 1]],
        duration=[4, 4, 5],
    )
    found = plan_together(link_problem(base, [Link(1, 0, 20, 30)], {MAKESPAN: 1}))
    assert found is not None
    assert found.worth == 1 + 20 + 4 + 1


def test_the_best_in_a_given_time_is_never_worse_than_it_was() -> None:
    problem = random_linked(3)
    found = solve(problem, 0.3)
    assert found is not None
    costs = [cost for _, cost in found.curve]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] == found.worth == plain_cost(problem, found.plan)[0]


def test_linked_tasks_are_not_done_by_one_robot() -> None:
    base = pose_problem(
        [[[0, 1], [1, 0], [1, 1]]], [[1, 1, 0]], [0], [2], [[1]], [[1], [1]], [1, 1]
    )
    problem = link_problem(base, [Link(1, 0, 5, 9)], WEIGHTS)
    assert plan_together(problem) is None
    assert solve(problem, 0.1) is None


UNDOING = """
import numpy as np
from test_linked import assert_consistent, random_linked
from teamformer.planning.graph.changes import (undo)
from teamformer.planning.graph.ledger import (
    accept_change, begin_change, sum_up_change, time_change
)
from teamformer.planning.operators.exchanges import exchange_rests
from teamformer.planning.operators.group_moves import move_group
from teamformer.planning.problem.coalition_problem import NEVER
from teamformer.planning.search.arc_search import ArcSearch

undone = {"exchange": 0, "move": 0}
for seed in range(4):
    search = ArcSearch(random_linked(seed, 12, robots=14), seed)
    assert search.begin_anew()
    arcs, state = search.arcs, search.state
    graph, trial, ledger = state.graph, state.trial, state.ledger
    for turn in range(50):
        before = [array.copy() for array in graph]
        begin_change(trial, ledger)
        parts = (arcs, state, turn % 12, 40, NEVER)
        what = "exchange" if turn % 2 else "move"
        is_able = exchange_rests(*parts) if turn % 2 else move_group(*parts)
        if is_able and turn % 3 < 2:
            is_able = time_change(arcs, graph, trial, ledger, NEVER, 1e18)
            sum_up_change(arcs, graph, trial, ledger)
            if is_able and turn % 3 == 1:
                accept_change(arcs, graph, trial, ledger)
                assert_consistent(search)
                continue
        undone[what] += trial.number[0] > 0
        undo(graph, trial)
        most, taken = arcs.most[0], before[0].taken[:12]
        own = [at * most + np.arange(n) for at, n in enumerate(taken)]
        in_use = np.concatenate([*own, np.arange(12 * most, len(before[1]))])
        assert (before[1][in_use] == graph.seats[in_use]).all()
        for old, new in zip((before[0], *before[2:]), (graph[0], *graph[2:]), strict=True):
            assert (old == new).all()
assert undone["exchange"] > 2 and undone["move"] > 30, undone
"""

SCRIPT = """
from test_linked import random_linked
from teamformer.planning.search.arc_search import ArcSearch
search = ArcSearch(random_linked(1), 1)
search.begin_anew()
search.anneal(4000, 4000, 0, 200, 200)
print(search.rank[0], search.best.order.tolist(), search.best.size.tolist())
"""


def run_script(script: str, **changed: str) -> str:
    paths = [os.path.dirname(__file__), *sys.path]
    env = {**os.environ, **changed, "PYTHONPATH": os.pathsep.join(paths)}
    words = [sys.executable, "-W", "ignore", "-c", script]
    return subprocess.run(words, env=env, check=True, capture_output=True, text=True).stdout


def test_a_change_that_is_refused_leaves_everything_as_it_was() -> None:
    run_script(UNDOING, NUMBA_DISABLE_JIT="1")


@pytest.mark.slow
def test_the_plan_is_the_same_without_compiled_code() -> None:
    assert run_script(SCRIPT) == run_script(SCRIPT, NUMBA_DISABLE_JIT="1")
