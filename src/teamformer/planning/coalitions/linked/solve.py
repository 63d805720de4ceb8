"""Solving a linked problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from teamformer.planning.coalitions.linked.problem import LinkedProblem
from teamformer.planning.coalitions.linked.schedule import LinkedSchedule, plan_of
from teamformer.planning.coalitions.linked.search import LinkedSearch
from teamformer.planning.coalitions.search.schedule import CoalitionPlan

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

Stop = Callable[[], bool]


@dataclass(frozen=True)
class LinkedSolution:
    """A plan and what it costs, as the problem weighs; `curve` holds (seconds, cost)."""

    plan: CoalitionPlan
    cost: int
    curve: tuple[tuple[float, int], ...] = ()


def plan_linked(problem: LinkedProblem, seed: int = 0) -> LinkedSolution | None:
    """Return the plan that every robot computes for itself, after a fixed number of rounds.

    None if no coalitions were found: linked tasks are done by different robots.
    """
    search, found = LinkedSearch(problem, seed), []
    for _ in range(SHARED_STARTS):
        if not _anneal_and_reheat(search, SHARED_ROUNDS, lambda: False):
            return None
        found.append(search.best)
    best = min(found, key=lambda schedule: int(schedule.cost[0]))
    return LinkedSolution(plan_of(problem, best), int(best.cost[0]))


def solve_linked(
    problem: LinkedProblem, time_limit: float, seed: int = 0, workers: int = 2
) -> LinkedSolution | None:
    """Return the best plan found in so many seconds; None if no coalitions were found."""
    best = _Best(time.perf_counter(), time_limit)
    searches = [LinkedSearch(problem, seed + worker) for worker in range(workers)]
    with ThreadPoolExecutor(workers) as pool:
        running = [pool.submit(_search, search, best) for search in searches]
        try:
            for job in running:
                job.result()
        finally:
            best.stop()
    if best.schedule is None:
        return None
    return LinkedSolution(
        plan_of(problem, best.schedule), int(best.schedule.cost[0]), tuple(best.curve)
    )


class _Best:
    """The best plan that any thread has found so far, and when each better one was found."""

    def __init__(self, begun: float, time_limit: float) -> None:
        self.schedule: LinkedSchedule | None = None
        self.curve: list[tuple[float, int]] = []
        self._begun, self._deadline = begun, begun + time_limit
        self._lock = threading.Lock()
        self._is_stopped = False

    def offer(self, search: LinkedSearch) -> None:
        """Take what a search has found if it is better."""
        with self._lock:
            if not self.curve or search.cost < self.curve[-1][1]:
                self.schedule = search.best
                self.curve.append((time.perf_counter() - self._begun, search.cost))

    def stop(self) -> None:
        """Let all searches come to their end."""
        self._is_stopped = True

    def is_over(self) -> bool:
        """Say whether searches are to end."""
        return self._is_stopped or time.perf_counter() > self._deadline


def _search(search: LinkedSearch, best: _Best) -> None:
    """Anneal again and again, each time from a fresh start, until it is over."""

    def look() -> bool:
        best.offer(search)
        return best.is_over()

    while not best.is_over() or best.schedule is None:
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
        search.anneal(leg // hot, leg // COLD, made, end, rounds)
        if is_over():
            return
