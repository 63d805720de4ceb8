"""The central plan with forming counted, improved until time is up."""

from __future__ import annotations

import threading
import time

from teamformer.model import Scenario
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.relaxation.schedule import Schedule
from teamformer.planning.teams.annealing import TeamSearch
from teamformer.planning.teams.initial import crew_plans
from teamformer.planning.teams.plan import TeamPlan, plan_teams

Annealings = tuple[tuple[float, float], ...]
"""When each annealing ends, as a share of time or rounds, and how hot it begins.

The first starts where the search is, the others at the best plan. Hot ones leave it behind, cool
ones better it.
"""

FROM_CREWS: Annealings = ((0.05, 0.8), (0.3, 0.3), (1.0, 0.6))
FROM_COALITIONS: Annealings = ((0.4, 0.5), (1.0, 0.3))

ROUNDS = 3000
"""Rounds for each pair of tasks; a search that long finds nothing more."""

MOST_SECONDS_AT_ONCE = 0.05
"""Between two looks at the clock."""


class BestPlan:
    """The best plan that any search has found so far, and when it was found."""

    def __init__(self, begun: float, search: TeamSearch) -> None:
        self.plan, self._cost, self.makespan = search.best, search.cost, search.makespan
        self.curve: list[tuple[float, int]] = []
        self.bound = 0
        self._is_stopped = False
        self._begun = begun
        self._lock = threading.Lock()

    def offer(self, search: TeamSearch) -> None:
        """Take a search's plan if it is better."""
        with self._lock:
            if search.cost >= self._cost:
                return
            self._cost, self.plan = search.cost, search.best
            if search.makespan < self.makespan:
                self.makespan = search.makespan
                self.curve.append((time.perf_counter() - self._begun, self.makespan))

    def raise_bound(self, bound: int) -> None:
        """Note that no plan is faster than this."""
        with self._lock:
            self.bound = max(self.bound, bound)

    def stop(self) -> None:
        """Let all searches come to their end."""
        self._is_stopped = True

    @property
    def is_over(self) -> bool:
        """Say whether searches are to end: nothing can be faster, or somebody stopped them."""
        return self._is_stopped or self.makespan <= self.bound


def first_search(problem: Relaxed, scenario: Scenario, seed: int) -> TeamSearch | None:
    """Return a search at the best of the first plans; None if a task has too few robots."""
    starts = [plan for plan in crew_plans(problem) if is_able(problem, plan)]
    searches = [TeamSearch(problem, scenario, plan, seed) for plan in starts]
    return min(searches, key=lambda search: search.cost, default=None)


def is_able(problem: Relaxed, plan: TeamPlan) -> bool:
    """Say whether every coalition has what its task needs."""
    coalitions = zip(plan.coalition, plan.size, strict=True)
    has = [problem.counts[coalition[:size]].sum(axis=0) for coalition, size in coalitions]
    return all((have >= need).all() for have, need in zip(has, problem.needs, strict=True))


def plan_from_schedule(problem: Relaxed, schedule: Schedule) -> TeamPlan:
    """Return the plan in which the robots of each task are those of a relaxed schedule."""
    return plan_teams(problem, schedule.order, schedule.coalitions)


def improve(best: BestPlan, search: TeamSearch, deadline: float, annealings: Annealings) -> None:
    """Anneal again and again until the deadline, and offer what is found.

    `deadline` is what `time.perf_counter` then shows. Small worlds end earlier.
    """
    begun, most = time.perf_counter(), ROUNDS * len(search.problem.appears) ** 2
    made, at_once, begin, end, hot = 0, 1, 0.0, 0.0, 0.0
    while not best.is_over:
        passed = _share(made / most, begun, deadline)
        if passed == 1.0:
            break
        if passed >= end:
            if made > 0:
                search.restart(best.plan)
            begin, (end, hot) = passed, next(which for which in annealings if which[0] > passed)
        seconds = -time.perf_counter()
        search.anneal(at_once, min(1.0, (passed - begin) / (end - begin)), hot)
        best.offer(search)
        seconds += time.perf_counter()
        made += at_once
        room = min(MOST_SECONDS_AT_ONCE, max(0.0, deadline - time.perf_counter()))
        at_once = max(1, min(2 * at_once, int(at_once * room / max(seconds, 1e-7))))


def _share(made: float, begun: float, deadline: float) -> float:
    """Return the share of rounds or of time that has passed, whichever is more; 1 at the end."""
    now = time.perf_counter()
    if now >= deadline:
        return 1.0
    return min(1.0, max(made, (now - begun) / (deadline - begun)))
