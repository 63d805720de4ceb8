"""The bound of a makespan, raised step by step for as long as anybody wants."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from teamformer.planning.bounds.refutation import (
    MOST_TASKS_A_TOUR,
    Chains,
    Refuter,
    Tours,
    tours_through,
)
from teamformer.planning.continuous_bounds.relaxations import Relaxation
from teamformer.planning.problem.coalition_problem import CoalitionProblem

MORE_NODES = 4
"""How many times more a makespan is looked into when all shorter ones are refuted."""

NEAR = 5000
"""The next round begins when the gap is this share of the makespan."""


def improving_bounds(
    problem: CoalitionProblem, relaxation: Relaxation, bound: int, upper: Callable[[], int]
) -> Iterator[int]:
    """Yield ticks that no plan beats, never fewer than a bound, until they reach `upper`.

    That is the makespan of the best plan known so far, or more.
    Destructive improvement (Klein and Scholl 1999): a makespan that is refuted is too short.
    Makespans are bisected, again and again with more nodes. The same bound may come repeatedly.
    Between multiples of the problem's grain there is no makespan, so bounds are such multiples.
    """
    grain = grain_of(problem, upper())
    bound = min(upper(), _up(bound, grain))
    yield bound
    refuter = refuter_of(problem, relaxation)
    nodes, open_from = 0, upper()  # so many nodes have not refuted `open_from`, if it is less
    while bound < (most := upper()):
        open_from = min(open_from, most)
        is_near = open_from - bound <= most // NEAR
        if is_near and open_from < most:
            nodes, open_from = max(1, MORE_NODES * nodes), most
            continue
        makespan = most - 1 if is_near else (bound + open_from) // 2
        if refuter.refutes(makespan, nodes):
            bound = min(most, _up(makespan + 1, grain))
        elif is_near:
            nodes = max(1, MORE_NODES * nodes)
        else:
            open_from = makespan
        yield bound


def grain_of(problem: CoalitionProblem, most: int) -> int:
    """Return ticks of which the makespan of every plan that takes `most` or less is a multiple.

    Makespans are sums of the problem's times; longer ones than `most` play no part in them.
    """
    parts = (
        *(problem.ways, problem.home, problem.duration, problem.slower, problem.release),
        *(problem.ready, problem.forming, problem.links.gap),
        *(problem.rotas.shifts, problem.rotas.every),
    )
    times = np.concatenate([part.ravel() for part in parts])
    return max(1, int(np.gcd.reduce(times[np.abs(times) <= most])))


def _up(ticks: int, grain: int) -> int:
    """Return the next multiple of a grain that is not less."""
    return -(-ticks // grain) * grain


def refuter_of(problem: CoalitionProblem, relaxation: Relaxation) -> Refuter:
    """Return a refuter of makespans in ticks."""
    caps = np.flatnonzero((problem.needs > 0).sum(axis=0) > 1).tolist()
    tours = [_tours(problem, relaxation, cap) for cap in caps]
    chains = Chains(relaxation.head, problem.duration, relaxation.tail, problem.before)
    return Refuter(chains, tours)


def _tours(problem: CoalitionProblem, relaxation: Relaxation, cap: int) -> Tours:
    """Return the tours of the robots with a capability."""
    able = np.flatnonzero(problem.counts[:, cap])
    tasks = np.flatnonzero(problem.needs[:, cap])
    between = relaxation.ways[np.unique(problem.pace[able])][:, tasks][:, :, tasks].min(axis=0)
    urgent = problem.duration + relaxation.head + relaxation.tail
    return tours_through(urgent, tasks, between, problem.duration, len(able), MOST_TASKS_A_TOUR)
