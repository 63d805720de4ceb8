"""Solvers of vehicle routing on missions whose tasks need one robot each.

They know no makespan, but how long a route may last. So they are asked for routes within a limit,
which is lowered for as long as they find some.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from teamformer.bench.peers.peer_plan import OutOfReachError, PeerPlan, makespan_of, plan_of
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem

Routes = list[list[int]]
"""The tasks of each robot, in its order."""

Attempt = Callable[[int, float], Routes | None]
"""Looks for routes that last so many ticks at most, for so many seconds."""

SLICES = 8
"""Parts that the time is cut into, one for each limit."""

BOLD, CAREFUL = 0.5, 0.002
"""How much of the way from the best makespan to the bound a limit is lowered, at first and last."""


def able_robots(problem: CoalitionProblem, name: str) -> npt.NDArray[np.bool_]:
    """Return which robot can do which task alone, as (robots, tasks).

    Raises `OutOfReachError` if some task needs several robots.
    """
    enough = problem.counts[:, None, :] >= problem.needs[None, :, :]
    can_do = np.asarray(enough.all(axis=2))  # (robots, tasks)
    if not can_do.any(axis=0).all():
        raise OutOfReachError(f"{name} is asked missions only whose tasks need one robot each")
    return can_do


def horizon_of(problem: CoalitionProblem) -> int:
    """Return ticks within which one robot could do all tasks."""
    longest = max(int(problem.ways.max()), int(problem.home.max()))
    return int(problem.duration.sum()) + (len(problem.needs) + 1) * longest


def lower_limits(
    problem: CoalitionProblem, can_do: npt.NDArray[np.bool_], seconds: float, attempt: Attempt
) -> PeerPlan | None:
    """Return the plan of the least makespan that attempts found in so many seconds."""
    deadline = time.perf_counter() + seconds
    floor, part = _floor(problem, can_do), BOLD
    best, least = None, horizon_of(problem)
    limit = least
    while part >= CAREFUL and (left := deadline - time.perf_counter()) > 0:
        routes = attempt(limit, min(left, seconds / SLICES))
        plan = None if routes is None else _plan(problem, routes)
        makespan = None if plan is None else makespan_of(problem, plan)
        if plan is not None and makespan is not None and (best is None or makespan < least):
            best, least = plan, makespan
        elif best is None:
            return None
        else:
            part /= 2
        limit = least - max(1, int(part * (least - floor)))
    return None if best is None else PeerPlan(best)


def _floor(problem: CoalitionProblem, can_do: npt.NDArray[np.bool_]) -> int:
    """Return ticks that no plan beats: somebody goes to each task, does it and goes home."""
    robots = np.arange(len(problem.origin))
    there = problem.ways[problem.pace, problem.origin]  # (robots, tasks)
    back = problem.home[problem.kind[robots]][:, : len(problem.needs)]
    alone = np.where(can_do, there + problem.duration + back, 2**62)
    return int(alone.min(axis=0).max())


def _plan(problem: CoalitionProblem, routes: Routes) -> CoalitionPlan:
    """Return routes as a plan: tasks in the order of their places in the routes."""
    coalitions: list[list[int]] = [[] for _ in problem.needs]
    place = [0] * len(coalitions)
    for robot, route in enumerate(routes):
        for number, task in enumerate(route):
            coalitions[task], place[task] = [robot], number
    order = sorted(range(len(place)), key=lambda task: (place[task], task))
    return plan_of(problem, coalitions, order)
