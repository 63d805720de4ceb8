"""Bounds by routes in continuous time: robots have to bring in time what tasks need.

As in steps (`bounds/route_cover.py`), with ticks counted in units of which a makespan has some
hundreds. From the start of one task to the arrival at the next is rounded down to units, so no
route takes longer than it does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from teamformer.base.array_types import Array, Ints
from teamformer.planning.bounds.prize_routes import make_stops
from teamformer.planning.bounds.robot_kinds import Kind
from teamformer.planning.bounds.route_cover import RouteCover, linked_capabilities, raise_by_covers
from teamformer.planning.continuous_bounds.relaxations import Relaxation
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem

COARSE, FINE = 300, 600
"""Units in a bound that is to be raised: with more of them more is proven, and takes longer."""

AT_ONCE = {COARSE: 2e7, FINE: 4e8}
"""What may be looked at in one go, by units; each is about a nanosecond."""

GRAIN = 4000
"""Bounds are raised by this share at least."""

NO_LEG = 2**40
"""Units from a task to itself; more than any leg has."""


def raise_by_routes(
    problem: CoalitionProblem,
    relaxation: Relaxation,
    bound: int,
    units: int,
    offer: Callable[[int], None] = lambda _: None,
    is_over: Callable[[], bool] = lambda: False,
) -> int:
    """Raise a bound until routes prove nothing more, offer every better one and return the best.

    The bound so far has so many `units`.
    """
    covers = list(_covers(problem, relaxation, max(1, bound // units)))
    legs = max((cover.effort(bound) for cover in covers), default=0)
    grain = max(1, bound // GRAIN)
    return raise_by_covers(covers, legs, bound, offer, is_over, AT_ONCE[units], grain)


def _covers(problem: CoalitionProblem, relaxation: Relaxation, unit: int) -> Iterator[RouteCover]:
    """Yield what has to be covered, apart for capabilities that no robot links."""
    into = relaxation.ways.min(axis=0)  # (places, tasks)
    np.fill_diagonal(into, NEVER)
    effort = (problem.duration + into.min(axis=0)) / unit  # (tasks,)
    for caps in linked_capabilities(problem.counts):
        is_need = np.zeros(problem.needs.shape, np.bool_)
        is_need[:, caps] = problem.needs[:, caps] > 0
        needs = np.argwhere(is_need)  # (needs, 2) task and capability
        alike = (row[row != NOBODY] for row in problem.like)
        kinds = (_kind(problem, relaxation, robots, needs, unit) for robots in alike)
        able = [kind for kind in kinds if kind is not None]
        if able:
            yield RouteCover(problem.needs[is_need], effort[needs[:, 0]], able)


def _kind(
    problem: CoalitionProblem, relaxation: Relaxation, robots: Ints, needs: Array, unit: int
) -> Kind | None:
    """Return robots of one kind, and None if they bring nothing."""
    one, (task_of, cap_of), tasks = int(robots[0]), needs.T, len(problem.needs)
    stops = np.unique(task_of[problem.counts[one, cap_of] > 0])  # (stops,)
    if not len(stops):
        return None
    ways, duration = relaxation.ways[problem.pace[one]], problem.duration[stops]
    legs = (duration[:, None] + ways[np.ix_(stops, stops)]) // unit
    np.fill_diagonal(legs, NO_LEG)
    home = duration + relaxation.home[problem.kind[one], stops]
    origin, sizes = np.unique(problem.origin[robots], return_counts=True)
    first = problem.ready[origin - tasks][:, None] + ways[np.ix_(origin, stops)]
    brought = np.minimum(problem.counts[one, cap_of], problem.needs[task_of, cap_of])
    brings = np.where(stops[:, None] == task_of, brought, 0).astype(np.int64)
    place, stay = np.arange(len(stops)), np.zeros(len(stops), np.int64)
    times = (legs, relaxation.head[stops] // unit, stay, home // unit)
    made = make_stops(*times, place, memory=0)
    return Kind(sizes, place, made, first // unit, brings, 1 / unit, 2**60)
