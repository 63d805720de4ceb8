"""Solving a linked problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

from teamformer.planning.continuous.linked.problem import LinkedProblem
from teamformer.planning.continuous.linked.schedule import LinkedSchedule, plan_of
from teamformer.planning.continuous.linked.search import LinkedSearch
from teamformer.planning.continuous.schedule import CoalitionPlan

SHARED_ROUNDS, CENTRAL_ROUNDS = 50_000, 100_000
"""Rounds of an annealing of twenty tasks; of as many more as there are tasks more."""

SHARED_STARTS = 3
"""From how many plans the shared one is searched for: the best of them is taken."""

USUAL_TASKS = 20

REHEATS = 2
"""How often an annealing goes on from its best plan, with half the rounds, before a new start."""

HOT, REHEATED, COLD = 2, 6, 200
"""Annealings begin and end at what a visit costs on average, divided by these."""

ROUNDS_AT_ONCE = 1000
"""Between two looks at the clock; some hundredths of a second."""

SHARED_SECONDS = 5.0
"""What the shared plan may take at the least where the best one in a given time is searched for."""

Stop = Callable[[], bool]


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
    best = _Best(time.perf_counter())
    _share(LinkedSearch(problem, seed), best, math.inf)
    found = best.solution(problem)
    return found and replace(found, curve=())


def solve_linked(
    problem: LinkedProblem, time_limit: float, seed: int = 0, workers: int = 2
) -> LinkedSolution | None:
    """Return the best plan found in so many seconds; None if no coalitions were found.

    The first thread begins with the shared plan, so that none is worse: where there is next to no
    time, that has a second.
    """
    best, first = _Best(time.perf_counter()), LinkedSearch(problem, seed)

    def share_and_search() -> None:
        _share(first, best, max(SHARED_SECONDS, time_limit))
        _search(first, best, time_limit)

    others = [LinkedSearch(problem, seed + worker) for worker in range(1, workers)]
    with ThreadPoolExecutor(workers) as pool:
        running = [pool.submit(share_and_search)]
        running += [pool.submit(_search, other, best, time_limit) for other in others]
        try:
            for job in running:
                job.result()
        finally:
            best.stop()
    return best.solution(problem)


class _Best:
    """The best plan that any thread has found so far, and when each better one was found."""

    def __init__(self, begun: float) -> None:
        self.schedule: LinkedSchedule | None = None
        self._curve: list[tuple[float, float]] = []
        self._begun = begun
        self._lock = threading.Lock()
        self._is_stopped = False

    def offer(self, search: LinkedSearch) -> None:
        """Take what a search has found if it is better."""
        with self._lock:
            if not self._curve or search.cost < self._curve[-1][1]:
                self.schedule = search.best
                self._curve.append((time.perf_counter() - self._begun, search.cost))

    def stop(self) -> None:
        """Let all searches come to their end."""
        self._is_stopped = True

    def is_over(self, seconds: float) -> bool:
        """Say whether a search that has so many seconds is to end."""
        return self._is_stopped or time.perf_counter() - self._begun > seconds

    def solution(self, problem: LinkedProblem) -> LinkedSolution | None:
        """Return the best plan, if there is one."""
        if self.schedule is None:
            return None
        plan = plan_of(problem, self.schedule)
        return LinkedSolution(plan, float(self.schedule.cost[0]), tuple(self._curve))


def _share(search: LinkedSearch, best: _Best, seconds: float) -> None:
    """Find the shared plan, from a few fresh starts, or as much of it as there is time for."""

    def look() -> bool:
        best.offer(search)
        return best.is_over(seconds)

    for _ in range(SHARED_STARTS):
        if best.is_over(seconds) or not _anneal_and_reheat(search, SHARED_ROUNDS, look):
            return


def _search(search: LinkedSearch, best: _Best, seconds: float) -> None:
    """Anneal again and again, each time from a fresh start, until it is over."""

    def look() -> bool:
        best.offer(search)
        return best.is_over(seconds)

    while not best.is_over(seconds) or best.schedule is None:
        if not _anneal_and_reheat(search, CENTRAL_ROUNDS, look):
            return


def _anneal_and_reheat(search: LinkedSearch, rounds: int, is_over: Stop) -> bool:
    """Anneal from a fresh start, then a few times from the best; say whether there is a plan."""
    if not search.begin_anew():
        return False
    rounds = max(1, rounds * len(search.problem.group) // USUAL_TASKS)
    _anneal(search, HOT, rounds, is_over)
    for _ in range(REHEATS):
        search.begin_at_best()
        _anneal(search, REHEATED, rounds // 2, is_over)
    return True


def _anneal(search: LinkedSearch, hot: int, rounds: int, is_over: Stop) -> None:
    leg = search.leg
    for made in range(0, rounds, ROUNDS_AT_ONCE):
        end = min(rounds, made + ROUNDS_AT_ONCE)
        search.anneal(leg / hot, leg / COLD, made, end, rounds)
        if is_over():
            return
