"""Bounds and proofs, against all plans of tiny problems."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from random_coalitions import all_plans, plain_times, random_problem
from teamformer.planning.coalitions.bounds import bound_makespan, count_tours
from teamformer.planning.coalitions.cp_sat import solve_exactly
from teamformer.planning.coalitions.problem import CoalitionProblem, Ticks
from teamformer.planning.coalitions.solve import plan_together, solve

TINY = [random_problem(seed, tasks=4, robots=3, caps=2, is_plain=True) for seed in range(10)]


def best_of_all(problem: CoalitionProblem) -> int:
    return min(plain_times(problem, plan)[0] for plan in all_plans(problem))


@pytest.mark.parametrize("problem", TINY)
def test_bounds_proofs_and_searches_agree_with_trying_all_plans(problem: CoalitionProblem) -> None:
    best, shared = best_of_all(problem), plan_together(problem)
    assert shared is not None
    assert bound_makespan(problem, shared.makespan) <= best <= shared.makespan
    proof = solve_exactly(problem, shared.schedule.plan, 0, 20.0)
    assert proof.bound == best
    assert proof.plan is not None
    assert plain_times(problem, proof.plan)[0] == best
    solution = solve(problem, 20.0)
    assert solution is not None
    assert (solution.makespan, solution.bound, solution.is_proven) == (best, best, True)


def test_precedence_raises_the_bound() -> None:
    problem = random_problem(1, tasks=6, is_plain=True)
    chain = [list(range(k, k + 1)) for k in range(5)]
    before = np.array([[-1, -1], *([*row, -1] for row in chain)], np.int32)
    after = np.array([*([k + 1, -1] for k in range(5)), [-1, -1]], np.int32)
    linked = CoalitionProblem(**(problem._asdict() | {"before": before, "after": after}))
    assert bound_makespan(linked, 10**6) >= problem.duration.sum()
    assert bound_makespan(linked, 10**6) > bound_makespan(problem, 10**6)


def least_tours(between: Ticks, duration: Ticks, head: Ticks, latest: Ticks) -> int:
    """Return the fewest robots by trying every way to deal the tasks out, and every order."""
    tasks = range(len(duration))

    def is_possible(tour: tuple[int, ...]) -> bool:
        for order in itertools.permutations(tour):
            time, last = 0, None
            for task in order:
                time = max(head[task], time + (0 if last is None else between[last, task]))
                time, last = time + duration[task], task
                if time > latest[task]:
                    break
            else:
                return True
        return False

    for robots in range(1, len(duration) + 1):
        for dealt in itertools.product(range(robots), repeat=len(duration)):
            tours = [tuple(t for t in tasks if dealt[t] == r) for r in range(robots)]
            if all(is_possible(tour) for tour in tours):
                return robots
    return 127


@pytest.mark.parametrize("seed", range(8))
def test_tours_are_counted_as_by_trying_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 50, size=(5, 2))
    between = np.ceil(np.linalg.norm(points[:, None] - points[None], axis=2)).astype(np.int64)
    duration, head = rng.integers(1, 20, size=5), rng.integers(0, 40, size=5)
    latest = head + duration + rng.integers(0, 60, size=5)
    ends, tours = np.zeros((32, 5), np.int64), np.zeros(32, np.int8)
    counted = count_tours(between, duration, head, latest, ends, tours)
    assert counted == least_tours(between, duration, head, latest)
