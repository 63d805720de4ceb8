"""Random coalition problems, and their plans timed by plain Python."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from teamformer.planning.dispatch.futures import begin_dispatch, empty_calls, play_out
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem, pose_problem
from teamformer.planning.problem.schedule import empty_schedule


def random_problem(
    seed: int, tasks: int = 7, robots: int = 5, caps: int = 3, is_plain: bool = False
) -> CoalitionProblem:
    """Draw a problem; unless it is plain it has windows, precedence, paces and a price to form."""
    rng = np.random.default_rng(seed)
    counts = np.zeros((robots, caps), int)
    counts[np.arange(robots), rng.integers(caps, size=robots)] = 1
    counts[rng.integers(robots, size=caps), np.arange(caps)] += 1
    needs = rng.integers(0, 2, size=(tasks, caps))
    needs[np.arange(tasks), rng.integers(caps, size=tasks)] = 1
    starts = 1 if is_plain else 2
    points = rng.integers(0, 100, size=(tasks + starts, 2))
    if not is_plain:
        points[-1] = points[0]  # who starts there is where the first task is
    straight = np.rint(np.linalg.norm(points[:, None] - points[None, :tasks], axis=2)).astype(int)
    origin = tasks + rng.integers(starts, size=robots)
    home = np.rint(np.linalg.norm(points[origin][:, None] - points[None], axis=2)).astype(int)
    pairs = [(i, j) for i, j in itertools.combinations(range(tasks), 2) if rng.random() < 0.1]
    return pose_problem(
        ways=straight[None] if is_plain else [straight, 2 * straight],
        home=home,
        pace=np.zeros(robots) if is_plain else rng.integers(2, size=robots),
        origin=origin,
        counts=counts,
        needs=needs,
        duration=rng.integers(0, 60, size=tasks),
        release=None if is_plain else rng.integers(0, 80, size=tasks),
        due=None if is_plain else rng.integers(100, 300, size=tasks),
        precedence=() if is_plain else pairs,
        forming=0 if is_plain else 7,
        site=np.unique(points, axis=0, return_inverse=True)[1].ravel(),
    )


def drawn_plan(problem: CoalitionProblem, seed: int) -> CoalitionPlan:
    """Return a plan in which tasks that are put back at random are done by who is there first."""
    schedule, calls = empty_schedule(problem), empty_calls(problem, 0)
    calls.handicap[:] = np.random.default_rng(seed).integers(2000, size=len(problem.needs))
    begin_dispatch(problem, schedule)
    assert play_out(problem, schedule, calls, 0)
    return schedule.plan


def plain_times(
    problem: CoalitionProblem, plan: CoalitionPlan
) -> tuple[int, int, int, dict[int, int]]:
    """Return makespan, sum of times at home, lateness and starts, worked out task after task."""
    place = [int(origin) for origin in problem.origin]
    free = [0] * len(place)
    start: dict[int, int] = {}
    late = 0
    for task in plan.order.tolist():
        coalition = plan.coalition[task, : plan.size[task]].tolist()
        there = max(free[r] + int(problem.ways[problem.pace[r], place[r], task]) for r in coalition)
        if len({int(problem.site[place[r]]) for r in coalition}) > 1:
            there += int(problem.forming[0])
        ends = [start[o] + int(problem.duration[o]) for o in problem.before[task] if o != NOBODY]
        start[task] = max([there, int(problem.release[task]), *ends])
        end = start[task] + int(problem.duration[task])
        late += max(0, end - int(problem.due[task]))
        for robot in coalition:
            place[robot], free[robot] = task, end
    back = [f + int(problem.home[k, p]) for f, k, p in zip(free, problem.kind, place, strict=True)]
    return max(back), sum(back), late, start


def is_able(problem: CoalitionProblem, plan: CoalitionPlan) -> bool:
    """Say whether every coalition brings what its task needs, with nobody in it twice."""
    for task, size in enumerate(plan.size.tolist()):
        coalition = plan.coalition[task, :size].tolist()
        if (
            len(set(coalition)) < size
            or (problem.counts[coalition].sum(axis=0) < problem.needs[task]).any()
        ):
            return False
    return True


def all_plans(problem: CoalitionProblem) -> Iterator[CoalitionPlan]:
    """Return every plan of a tiny problem: all orders, and all coalitions without spare robots."""
    tasks, robots = len(problem.needs), len(problem.counts)
    choices = [least_coalitions(problem, task) for task in range(tasks)]
    for order in itertools.permutations(range(tasks)):
        for coalitions in itertools.product(*choices):
            plan = empty_plan(problem)
            plan.order[:] = order
            for task, coalition in enumerate(coalitions):
                plan.size[task] = len(coalition)
                plan.coalition[task, : len(coalition)] = coalition
            yield plan
    assert robots


def least_coalitions(problem: CoalitionProblem, task: int) -> Sequence[tuple[int, ...]]:
    """Return the able coalitions that are none without any of their robots."""
    robots = range(len(problem.counts))
    able: list[tuple[int, ...]] = []
    for size in range(1, len(problem.counts) + 1):
        for coalition in itertools.combinations(robots, size):
            is_enough = (problem.counts[list(coalition)].sum(axis=0) >= problem.needs[task]).all()
            if is_enough and not any(set(one) < set(coalition) for one in able):
                able.append(coalition)
    return able
