"""Solving a linked problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from teamformer.planning.arcs.linked.search import COOLER, COOLINGS, LinkedSearch
from teamformer.planning.continuous.links import LinkedProblem
from teamformer.planning.continuous.schedule import CoalitionPlan

ROUNDS_EACH, MOST_ROUNDS = 20_000, 600_000
"""The shared plan takes so many rounds for each task, and so many at most: about a second."""

FEW_TASKS, SECONDS_EACH = 100, 15.0
"""With fewer tasks than this a search anneals again after so many seconds; with more it anneals
once in all the time there is."""


@dataclass(frozen=True)
class LinkedSolution:
    """A plan and what it costs, as the problem weighs; `curve` holds (seconds, cost)."""

    plan: CoalitionPlan
    cost: float
    curve: tuple[tuple[float, float], ...] = ()


def plan_linked(problem: LinkedProblem, seed: int = 0) -> LinkedSolution | None:
    """Return the plan that every robot computes for itself, after a fixed number of rounds.

    None if no coalitions were found: linked tasks are done by different robots.
    """
    search = LinkedSearch(problem, seed)
    if not search.begin_anew():
        return None
    search.quench()
    heat = search.heat
    rounds = min(MOST_ROUNDS, ROUNDS_EACH * len(problem.group)) // COOLINGS
    for _ in range(COOLINGS):
        search.anneal(heat, rounds)
        heat *= COOLER
    return LinkedSolution(search.best, search.cost)


def solve_linked(
    problem: LinkedProblem,
    time_limit: float,
    seed: int = 0,
    workers: int = 2,
    start: CoalitionPlan | None = None,
) -> LinkedSolution | None:
    """Return the best plan found in so many seconds; None if no coalitions were found.

    The plan is never worse than the shared plan, or than `start` if there is one.
    """
    begun = time.perf_counter()
    shared = plan_linked(problem, seed)
    if shared is None:
        return None
    best = _Best(begun, shared, begun + time_limit)
    if start is not None:
        given = LinkedSearch(problem, seed)
        if given.begin_at(start):
            best.offer(given)
    with ThreadPoolExecutor(workers) as pool:
        running = [
            pool.submit(partial(_search, problem, seed + n + 1, best)) for n in range(workers)
        ]
        try:
            for job in running:
                job.result()
        finally:
            best.stop()
    return best.solution()


class _Best:
    """The best plan that any thread has found so far, and when each better one was found."""

    def __init__(self, begun: float, first: LinkedSolution, deadline: float) -> None:
        self.plan, self._cost, self._deadline = first.plan, first.cost, deadline
        self._curve = [(time.perf_counter() - begun, first.cost)]
        self._begun = begun
        self._lock = threading.Lock()
        self._is_stopped = False

    def offer(self, search: LinkedSearch) -> None:
        """Take what a search has found if it is better."""
        with self._lock:
            if search.cost < self._cost:
                self.plan, self._cost = search.best, search.cost
                self._curve.append((time.perf_counter() - self._begun, search.cost))

    def stop(self) -> None:
        """Let all searches come to their end."""
        self._is_stopped = True

    @property
    def seconds_left(self) -> float:
        """Return the seconds until the searches are to end."""
        return max(0.0, self._deadline - time.perf_counter())

    @property
    def is_over(self) -> bool:
        """Say whether searches are to end."""
        return self._is_stopped or self.seconds_left == 0.0

    def solution(self) -> LinkedSolution:
        """Return the best plan."""
        return LinkedSolution(self.plan, self._cost, tuple(self._curve))


def _search(problem: LinkedProblem, seed: int, best: _Best) -> None:
    """Anneal once in the time there is, or several times, each time from the first plan.

    What the best plan costs says too little of how hot to begin: it is not left any more then.
    """
    search, seconds = LinkedSearch(problem, seed), best.seconds_left
    is_small = len(problem.group) < FEW_TASKS
    for left in range(max(1, round(seconds / SECONDS_EACH)) if is_small else 1, 0, -1):
        search.begin_anew()
        search.quench()
        search.anneal_for(
            best.seconds_left / left, lambda: best.is_over, lambda: best.offer(search)
        )
