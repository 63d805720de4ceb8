"""Tasks whose starts are linked: times by hand and against a plain twin, small optima."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from random_coalitions import all_plans, is_able, random_problem
from teamformer.planning.continuous.linked.problem import (
    HOME,
    MAKESPAN,
    MAX_TARDINESS,
    TARDINESS,
    TRAVEL,
    Link,
    LinkedProblem,
    link_problem,
)
from teamformer.planning.continuous.linked.schedule import plan_of
from teamformer.planning.continuous.linked.search import LinkedSearch
from teamformer.planning.continuous.linked.solve import plan_linked, solve_linked
from teamformer.planning.continuous.problem import CoalitionProblem, pose_problem
from teamformer.planning.continuous.schedule import CoalitionPlan

SEEDS = range(4)
WEIGHTS = (3, 1, 2, 4, 5)


def random_linked(seed: int, tasks: int = 8, **sizes: int) -> LinkedProblem:
    """Draw a problem in which the last two tasks are linked, and the two before, too."""
    base = random_problem(seed, tasks=tasks, **({"robots": 12} | sizes))
    rng = np.random.default_rng(seed)
    before = np.full_like(base.before, -1)  # precedence among linked tasks might go in a circle
    base = base._replace(before=before, after=np.full_like(base.after, -1))
    least = int(rng.integers(0, 60))
    links = [Link(tasks - 1, tasks - 2, least, least + int(rng.integers(0, 40)))]
    if tasks > 4:
        links.append(Link(tasks - 3, tasks - 4, 0, 0))
    return link_problem(base, links, WEIGHTS)


def plain_cost(problem: LinkedProblem, plan: CoalitionPlan) -> tuple[int, dict[int, int]]:
    """Return what a plan costs and when tasks start: groups in their order, gaps kept last."""
    base = problem.base
    place, free = [int(origin) for origin in base.origin], [0] * len(base.origin)
    start: dict[int, int] = {}
    travel, late = 0, []
    order = plan.order.tolist()
    while order:
        tasks = [t for t in order if problem.group[t] == problem.group[order[0]]]
        assert order[: len(tasks)] == tasks, "linked tasks stand beside one another"
        order = order[len(tasks) :]
        crews = {t: plan.coalition[t, : plan.size[t]].tolist() for t in tasks}
        assert len({r for crew in crews.values() for r in crew}) == sum(map(len, crews.values()))
        ready = {}
        for task, crew in crews.items():
            ways = [int(base.ways[base.pace[r], place[r], task]) for r in crew]
            there = max(free[r] + way for r, way in zip(crew, ways, strict=True))
            travel += sum(ways)
            there += (
                int(base.forming[0]) if len({int(base.site[place[r]]) for r in crew}) > 1 else 0
            )
            before = [b for b in base.before[task].tolist() if b >= 0]
            ends = [start[b] + int(base.duration[b]) for b in before]
            ready[task] = max([there, int(base.release[task]), *ends])
        for task in tasks:  # the latest of those that it hangs on, each by the longest way
            start[task] = max(ready[o] + longest(problem, tasks, o, task) for o in tasks)
        for task, crew in crews.items():
            end = start[task] + int(base.duration[task])
            late.append(max(0, end - int(base.due[task])))
            for robot in crew:
                place[robot], free[robot] = task, end
    home = [int(base.home[k, p]) for k, p in zip(base.kind, place, strict=True)]
    back = [f + way for f, way in zip(free, home, strict=True)]
    parts = {
        MAKESPAN: max(back),
        HOME: sum(back),
        TRAVEL: travel + sum(home),
        TARDINESS: sum(late),
        MAX_TARDINESS: max(late),
    }
    return sum(int(problem.weight[part]) * value for part, value in parts.items()), start


def longest(problem: LinkedProblem, tasks: list[int], one: int, two: int) -> int:
    """Return how much later a task starts at least than another, by gaps: groups have two."""
    return 0 if one == two else int(problem.gap[one, two]) if two in tasks else -(2**40)


def corridor(links: list[Link]) -> CoalitionProblem | LinkedProblem:
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
    return link_problem(base, links, [0, 0, 1, 1, 1])


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
    assert isinstance(problem, LinkedProblem)
    search = LinkedSearch(problem, 0)
    assert search.begin_anew()
    schedule = search.best
    assert schedule.start.tolist() == starts
    assert schedule.cost[0] == 2 * 4 + 2 * 10 + 2 * late  # ways, tardiness and the largest


@pytest.mark.parametrize("seed", SEEDS)
def test_a_search_stands_at_a_plan_that_is_timed_as_its_twin_times_it(seed: int) -> None:
    problem = random_linked(seed)
    search = LinkedSearch(problem, seed)
    assert search.begin_anew()
    for turn in range(30):
        search.anneal(4000, 500, turn * 10, turn * 10 + 10, 300)
        for schedule in (search._now, search.best):
            plan = plan_of(problem, schedule)
            cost, start = plain_cost(problem, plan)
            assert is_able(problem.base, plan)
            assert schedule.start.tolist() == [start[task] for task in range(8)]
            assert schedule.cost[0] == cost
            assert schedule.rank[schedule.order].tolist() == list(range(len(schedule.order)))


@pytest.mark.parametrize("seed", SEEDS)
def test_precedence_holds(seed: int) -> None:
    base = random_problem(seed, tasks=10)
    problem = link_problem(base, [], WEIGHTS)
    search = LinkedSearch(problem, seed)
    assert search.begin_anew()
    search.anneal(4000, 500, 0, 3000, 3000)
    cost, start = plain_cost(problem, plan_of(problem, search.best))
    assert cost == search.cost
    for task, others in enumerate(base.before.tolist()):
        assert all(start[task] >= start[o] + base.duration[o] for o in others if o >= 0)


@pytest.mark.parametrize("seed", SEEDS)
def test_small_problems_are_solved(seed: int) -> None:
    problem = random_linked(seed, tasks=4, robots=4, caps=2)
    least = 2**60
    for plan in all_plans(problem.base):
        rank = plan.order.tolist()
        together = abs(rank.index(2) - rank.index(3)) == 1
        crews = [set(plan.coalition[t, : plan.size[t]].tolist()) for t in (2, 3)]
        if together and not crews[0] & crews[1]:
            least = min(least, plain_cost(problem, plan)[0])
    found = plan_linked(problem)
    if least == 2**60:
        assert found is None
    else:
        assert found is not None
        assert found.cost == least


def test_the_best_in_a_given_time_is_never_worse_than_it_was() -> None:
    problem = random_linked(3)
    found = solve_linked(problem, 0.3)
    assert found is not None
    costs = [cost for _, cost in found.curve]
    assert costs == sorted(costs, reverse=True)
    assert costs[-1] == found.cost == plain_cost(problem, found.plan)[0]


def test_linked_tasks_are_not_done_by_one_robot() -> None:
    base = pose_problem(
        [[[0, 1], [1, 0], [1, 1]]], [[1, 1, 0]], [0], [2], [[1]], [[1], [1]], [1, 1]
    )
    problem = link_problem(base, [Link(1, 0, 5, 9)], WEIGHTS)
    assert plan_linked(problem) is None
    assert solve_linked(problem, 0.1) is None


SCRIPT = """
from test_linked import random_linked
from teamformer.planning.continuous.linked.search import LinkedSearch
search = LinkedSearch(random_linked(1), 1)
search.begin_anew()
search.anneal(4000, 500, 0, 25, 25)
print(search.cost, search.best.order.tolist(), search.best.size.tolist())
"""


@pytest.mark.slow
def test_the_plan_is_the_same_without_compiled_code() -> None:
    def shown(**changed: str) -> str:
        paths = [os.path.dirname(__file__), *sys.path]
        env = {**os.environ, **changed, "PYTHONPATH": os.pathsep.join(paths)}
        words = [sys.executable, "-W", "ignore", "-c", SCRIPT]
        return subprocess.run(words, env=env, check=True, capture_output=True, text=True).stdout

    assert shown() == shown(NUMBA_DISABLE_JIT="1")
