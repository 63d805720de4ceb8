"""The central plan with forming counted: searched from one start after another until time is up."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from itertools import count

from teamformer.planning.relaxation.problem import Relaxed, has_prices
from teamformer.planning.relaxation.schedule import Schedule
from teamformer.planning.steps.arc_search import LESS_HOT, TeamArcs
from teamformer.planning.steps.initial import crew_plans
from teamformer.planning.steps.shared_plan import HOT, LARGE, relaxed_rounds, rounds_for
from teamformer.planning.steps.situation import Situation
from teamformer.planning.steps.starts import plan_from_coalitions
from teamformer.planning.steps.team_plan import TeamPlan, plan_teams
from teamformer.planning.steps.threshold_search import ThresholdSearch
from teamformer.rules.constants import FAR

Starts = Iterator[tuple[TeamPlan, float]]
"""Plans to search from, one after another, and how hot each search begins, in steps."""

HEATS = (2.0, 0.5, 1.0)
"""How hot searches from the best plan begin: hot ones leave it behind, cool ones better it."""

ROUNDS = 3000
"""Rounds for each pair of tasks; a search that long finds nothing more."""

MOST_SECONDS_AT_ONCE = 0.05
"""Between two looks at the clock."""


class BestPlan:
    """The best plan that any search has found so far, and when it was found."""

    def __init__(self, begun: float, search: ThresholdSearch) -> None:
        self.plan, self._cost, self.makespan = search.best, search.cost, search.makespan
        self.curve: list[tuple[float, int]] = []
        self.bound = 0
        self._has_prices = has_prices(search.problem)
        self._is_stopped = False
        self._begun = begun
        self._lock = threading.Lock()

    def offer(self, search: ThresholdSearch) -> None:
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
        return self._is_stopped or (not self._has_prices and self.makespan <= self.bound)


def start_search(situation: Situation, seed: int) -> ThresholdSearch:
    """Return a search that has not begun."""
    return ThresholdSearch(
        situation.problem, situation.crossings, situation.company, situation.forming_steps, seed
    )


def first_search(situation: Situation, seed: int) -> ThresholdSearch | None:
    """Return a search at the best of the first plans; None if a task has too few robots."""
    search = start_search(situation, seed)
    starts = [plan for plan in crew_plans(situation.problem) if is_able(situation.problem, plan)]
    for start in starts:
        search.begin(start)
    return search if starts else None


def is_able(problem: Relaxed, plan: TeamPlan) -> bool:
    """Say whether every coalition has what its task needs."""
    coalitions = zip(plan.coalition, plan.size, strict=True)
    has = [problem.counts[coalition[:size]].sum(axis=0) for coalition, size in coalitions]
    return all((have >= need).all() for have, need in zip(has, problem.needs, strict=True))


def plan_from_schedule(problem: Relaxed, schedule: Schedule) -> TeamPlan:
    """Return the plan in which the robots of each task are those of a relaxed schedule."""
    return plan_teams(problem, schedule.order, schedule.coalitions)


def from_best(best: BestPlan) -> Starts:
    """Begin at the best plan that there is by then, again and again."""
    for turn in count():
        yield best.plan, HEATS[turn % len(HEATS)]


def from_coalitions(problem: Relaxed, best: BestPlan, seed: int) -> Starts:
    """Begin at coalitions that are good where joining is free and at the best plan, by turns."""
    rounds = relaxed_rounds(problem)
    for turn, (plan, hot) in enumerate(from_best(best)):
        relaxed = plan_from_coalitions(problem, rounds, seed + turn)
        if relaxed is not None:
            yield relaxed, HOT
        yield plan, hot


def improve(best: BestPlan, search: ThresholdSearch, deadline: float, starts: Starts) -> None:
    """Search from one start after another until the deadline, and offer what is found.

    `deadline` is what `time.perf_counter` then shows. Small worlds end earlier.
    """
    problem = search.problem
    rounds, left = rounds_for(problem, is_again=False).team, ROUNDS * len(problem.appears) ** 2
    while left > 0 and not best.is_over and time.perf_counter() < deadline:
        start, hot = next(starts)
        search.begin(start)
        _search_once(best, search, deadline, min(rounds, left), hot)
        left -= rounds


def improve_by_arcs(best: BestPlan, situation: Situation, deadline: float, seed: int) -> None:
    """Anneal once over graphs of arcs until the deadline, from the best plan, and offer what is
    found.
    """
    arcs, timed = TeamArcs(situation, seed), start_search(situation, seed)

    def offer() -> None:
        timed.begin(arcs.best)
        best.offer(timed)

    arcs.begin_at(best.plan)
    (hot, cold), seconds = arcs.heats, deadline - time.perf_counter()
    arcs.search.anneal_for(seconds, (hot // LESS_HOT, cold), lambda: best.is_over, offer)


def is_for_arcs(problem: Relaxed) -> bool:
    """Say whether graphs of arcs are searched: of large missions that nobody is lost in."""
    is_large = len(problem.appears) >= LARGE and not has_prices(problem)
    return is_large and int(problem.lost.min()) >= FAR


def _search_once(
    best: BestPlan, search: ThresholdSearch, deadline: float, rounds: int, hot: float
) -> None:
    """Search for some rounds, fewer if time is short, and cool down meanwhile."""
    begun, made, at_once, passed = time.perf_counter(), 0, 1, 0.0
    while passed < 1.0 and not best.is_over:
        at_once = min(at_once, rounds - made)
        before = time.perf_counter()
        heat = hot * (1.0 - passed)
        search.run(at_once, heat, heat * (1.0 - at_once / (rounds - made)))
        best.offer(search)
        made += at_once
        now = time.perf_counter()
        passed = max(made / rounds, (now - begun) / max(deadline - begun, 1e-9))
        room = min(MOST_SECONDS_AT_ONCE, max(0.0, deadline - now))
        at_once = max(1, min(2 * at_once, int(at_once * room / max(now - before, 1e-7))))
