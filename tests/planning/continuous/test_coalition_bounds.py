"""Bounds and proofs, against all plans of tiny problems."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from random_coalitions import all_plans, plain_times, random_problem
from teamformer.base.array_types import Ints
from teamformer.planning.bounds.tours import empty_tables, narrow_starts
from teamformer.planning.continuous.solve import plan_together, solve
from teamformer.planning.continuous_bounds.makespan import (
    grain_of,
    improving_bounds,
    refuter_of,
)
from teamformer.planning.continuous_bounds.relaxations import bound_by_chains_and_work, relax
from teamformer.planning.continuous_bounds.routes import COARSE, FINE, raise_by_routes
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem, pose_problem


def raised(problem: CoalitionProblem, upper: int, count: int) -> list[int]:
    """Return the first bounds that are proven, from chains and work on."""
    relaxation = relax(problem)
    bound = bound_by_chains_and_work(problem, relaxation)
    return list(
        itertools.islice(improving_bounds(problem, relaxation, bound, lambda: upper), count)
    )


TINY = [random_problem(seed, tasks=4, robots=3, caps=2, is_plain=True) for seed in range(10)]


def best_of_all(problem: CoalitionProblem) -> int:
    plans = (plan for plan in all_plans(problem) if is_in_order(problem, plan.order.tolist()))
    return min(plain_times(problem, plan)[0] for plan in plans)


def is_in_order(problem: CoalitionProblem, order: list[int]) -> bool:
    """Say whether all tasks come after those that they have to."""
    return all(
        other in order[:place]
        for place, task in enumerate(order)
        for other in problem.before[task].tolist()
        if other != NOBODY
    )


@pytest.mark.parametrize("problem", TINY)
def test_bounds_and_searches_agree_with_trying_all_plans(problem: CoalitionProblem) -> None:
    best, shared = best_of_all(problem), plan_together(problem)
    assert shared is not None
    assert bound_by_chains_and_work(problem, relax(problem)) <= best <= shared.worth
    solution = solve(problem, 20.0)
    assert solution is not None
    assert (solution.worth, solution.bound, solution.is_proven) == (best, best, True)


def test_precedence_raises_the_bound() -> None:
    problem = random_problem(1, tasks=6, is_plain=True)
    chain = [list(range(k, k + 1)) for k in range(5)]
    before = np.array([[-1, -1], *([*row, -1] for row in chain)], np.int32)
    after = np.array([*([k + 1, -1] for k in range(5)), [-1, -1]], np.int32)
    linked = CoalitionProblem(**(problem._asdict() | {"before": before, "after": after}))
    assert bound_by_chains_and_work(linked, relax(linked)) >= problem.duration.sum()
    free = problem.duration.max() + 200  # a chain of all tasks is longer than any one of them
    assert not refuter_of(problem, relax(problem)).refutes(free, 0)
    assert refuter_of(linked, relax(linked)).refutes(free, 0)


Span = tuple[int, int]


def spans_of_a_tour(
    tour: tuple[int, ...],
    between: Ints,
    duration: Ints,
    first: Ints,
    last: Ints,
) -> list[Span]:
    """Return between when and when each task of a tour can start; nothing if it cannot be made."""
    early, late = [int(first[tour[0]])], [int(last[tour[-1]])]
    for one, two in itertools.pairwise(tour):
        early.append(max(int(first[two]), early[-1] + int(duration[one] + between[one, two])))
    for one, two in itertools.pairwise(tour[::-1]):
        late.append(min(int(last[two]), late[-1] - int(duration[two] + between[two, one])))
    spans = list(zip(early, late[::-1], strict=True))
    return spans if all(begin <= end for begin, end in spans) else []


def spans_by_trying_all(
    between: Ints, duration: Ints, first: Ints, last: Ints, robots: int
) -> dict[int, Span]:
    """Return when each task can start, by every way to deal them out to robots in every order."""
    tasks, found = range(len(duration)), dict[int, Span]()
    for dealt in itertools.product(range(robots), repeat=len(duration)):
        by_robot = [[t for t in tasks if dealt[t] == robot] for robot in range(robots)]
        possible = [
            [
                dict(zip(tour, spans, strict=True))
                for tour in itertools.permutations(mine)
                if (spans := spans_of_a_tour(tour, between, duration, first, last))
            ]
            for mine in by_robot
            if mine
        ]
        if all(possible):
            for task, (begin, end) in (
                (t, s) for tours in possible for x in tours for t, s in x.items()
            ):
                least, most = found.get(task, (begin, end))
                found[task] = min(least, begin), max(most, end)
    return found


@pytest.mark.parametrize("robots", [1, 2, 3])
@pytest.mark.parametrize("seed", range(6))
def test_starts_are_narrowed_as_by_trying_all(seed: int, robots: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 50, size=(5, 2))
    between = np.ceil(np.linalg.norm(points[:, None] - points[None], axis=2)).astype(np.int64)
    for by in range(5):
        between = np.minimum(between, between[:, by, None] + between[None, by])
    duration, first = rng.integers(1, 20, size=5), rng.integers(0, 40, size=5)
    last = first + rng.integers(0, 240 // robots, size=5)
    expected = spans_by_trying_all(between, duration, first, last, robots)
    is_possible = narrow_starts(between, duration, first, last, robots, empty_tables(5))
    assert is_possible == bool(expected)
    if expected:
        narrowed = zip(first.tolist(), last.tolist(), strict=True)
        assert dict(enumerate(narrowed)) == expected


@pytest.mark.parametrize("problem", TINY)
def test_nothing_that_can_be_done_is_refuted(problem: CoalitionProblem) -> None:
    best, refuter = best_of_all(problem), refuter_of(problem, relax(problem))
    assert not any(refuter.refutes(makespan, 200) for makespan in (best, best + 1, 2 * best))
    bounds = raised(problem, best, 60)
    assert bounds == sorted(bounds)
    assert bounds[-1] <= best


def skilled_robots(seed: int) -> CoalitionProblem:
    """Draw few tasks for robots with several skills, half the time on ways with detours."""
    rng = np.random.default_rng(seed)
    tasks, robots, caps = (int(rng.integers(*of)) for of in ((2, 5), (2, 4), (1, 4)))
    counts = rng.integers(0, 3, (robots, caps))
    counts[rng.integers(robots, size=caps), np.arange(caps)] += 1
    needs = np.minimum(rng.integers(0, 3, (tasks, caps)), counts.sum(axis=0))
    needs[np.arange(tasks), rng.integers(caps, size=tasks)] = 1
    points = rng.integers(0, 100, (tasks + 2, 2))
    ways = np.rint(np.linalg.norm(points[:, None] - points[:tasks], axis=2)).astype(np.int64)
    if seed % 2:
        ways = rng.integers(0, 90, ways.shape)
    return pose_problem(
        ways=[ways, 2 * ways],
        home=rng.integers(0, 60, (robots, tasks + 2)),
        pace=rng.integers(2, size=robots),
        origin=tasks + rng.integers(2, size=robots),
        counts=counts,
        needs=needs,
        duration=rng.integers(0, 40, tasks),
        release=rng.integers(0, 60, tasks),
    )


def test_no_plan_is_over_before_its_routes_can_be() -> None:
    """With precedence and forming too."""
    gaps = []
    strict = [random_problem(seed, tasks=4, robots=3, caps=2) for seed in range(30)]
    for problem in (*strict, *map(skilled_robots, range(30))):
        best, relaxation = best_of_all(problem), relax(problem)
        for units in (COARSE, FINE):
            offers: list[int] = []
            bound = raise_by_routes(problem, relaxation, 1, units, offers.append)
            assert offers == sorted(offers)
            assert bound == max([1, *offers])
            gaps.append((best - bound) / max(1, best))
    assert min(gaps) == 0
    assert np.mean(gaps) < 0.1


def test_routes_share_out_what_work_alone_cannot() -> None:
    """Three tasks 10 off in three directions, two robots: one has two of them, 40 with the ways.

    Nothing takes time there. Each takes 20 there and back by itself: 30 a robot in the mean.
    """
    ways = np.array([[0, 20, 20], [20, 0, 20], [20, 20, 0], [10, 10, 10]])
    problem = pose_problem(
        ways=[ways],
        home=[[10, 10, 10, 0]] * 2,
        pace=[0, 0],
        origin=[3, 3],
        counts=[[1], [1]],
        needs=[[1], [1], [1]],
        duration=[0, 0, 0],
    )
    relaxation = relax(problem)
    assert bound_by_chains_and_work(problem, relaxation) < 30
    assert raise_by_routes(problem, relaxation, 1, FINE) == 40


def depots(seed: int, tasks: int, caps: int) -> CoalitionProblem:
    """Pose a problem of two robots for each capability, from a place of their own."""
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 100, size=(tasks + caps, 2))
    ways = np.ceil(np.linalg.norm(points[:, None] - points[None], axis=2)).astype(int)
    needs = rng.integers(0, 2, size=(tasks, caps))
    needs[np.arange(tasks), rng.integers(caps, size=tasks)] = 1
    origin = tasks + np.repeat(np.arange(caps), 2)
    return pose_problem(
        ways=[ways[:, :tasks]],
        home=ways[origin],
        pace=np.zeros(2 * caps),
        origin=origin,
        counts=np.repeat(np.eye(caps, dtype=int), 2, axis=0),
        needs=needs,
        duration=rng.integers(5, 40, size=tasks),
    )


def test_halving_windows_refutes_more() -> None:
    problem = depots(6, tasks=9, caps=3)
    refuter = refuter_of(problem, relax(problem))
    assert not refuter.refutes(285, 0)
    assert refuter.refutes(285, 30)
    plan = plan_together(problem)
    assert plan is not None
    assert plan.worth > 285


def test_a_capability_that_nobody_needs_or_has_bounds_nothing() -> None:
    """A robot at 0 goes to 4, stays 3 and goes home: 11, whatever else there might be."""
    ways = np.array([[0], [4]])  # from the task and from the start
    problem = pose_problem(
        ways=[ways],
        home=[[4, 0]],
        pace=[0],
        origin=[1],
        counts=[[1, 0]],
        needs=[[1, 0]],
        duration=[3],
    )
    assert raised(problem, 11, 3) == [11]
    assert raised(problem, 12, 3) == [11, 11, 11]
    assert raise_by_routes(problem, relax(problem), 0, FINE) == 11


def test_a_bound_is_a_sum_of_the_problem_s_times() -> None:
    """All times are multiples of 1000 but the way of 10,500, which no plan of 9000 has room for."""
    ways = [[[0, 10_500], [4000, 0], [4000, 2000]]]
    problem = pose_problem(
        ways=ways,
        home=[[0, 0, 0]],
        pace=[0],
        origin=[2],
        counts=[[1]],
        needs=[[1], [1]],
        duration=[1000, 2000],
    )
    assert grain_of(problem, 9000) == 1000
    assert grain_of(problem, 10_500) == 500
    bounds = raised(problem, 9000, 20)
    assert bounds[-1] == 9000
    assert all(bound % 1000 == 0 for bound in bounds)
