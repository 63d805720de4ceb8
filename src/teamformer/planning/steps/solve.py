"""The central plan with forming counted: searched from one start after another until time is up."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator

from teamformer.planning.arcs.annealing import ENDLESS
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.steps.arc_search import COLD, COOL, LARGE, LESS_HOT, TeamArcs, cost_of
from teamformer.planning.steps.initial import crew_plans
from teamformer.planning.steps.shared_plan import relaxed_rounds, rounds_for
from teamformer.planning.steps.situation import Situation
from teamformer.planning.steps.starts import plan_from_coalitions
from teamformer.planning.steps.team_plan import TeamPlan
from teamformer.planning.steps.timed_plan import TimedPlan, time_team_plan

Starts = Iterator[TeamPlan]
"""Plans to search from, one after another."""

LONGER = 4
"""How many times as many rounds an annealing has as those of the shared plan."""

ROUNDS = 3000
"""Rounds for each pair of tasks; a search that long finds nothing more."""


class BestPlan:
    """The best plan that any search has found so far, and when it was found."""

    def __init__(self, begun: float, first: TimedPlan) -> None:
        self.plan = first
        self.curve: list[tuple[float, int]] = []
        self.bound = 0
        self._is_stopped = False
        self._begun = begun
        self._lock = threading.Lock()

    @property
    def makespan(self) -> int:
        """Return the step in which its last task is done."""
        return self.plan.makespan

    def offer(self, plan: TimedPlan) -> None:
        """Take a plan if it is better."""
        with self._lock:
            if plan.cost >= self.plan.cost:
                return
            is_faster, self.plan = plan.makespan < self.plan.makespan, plan
            if is_faster:
                self.curve.append((time.perf_counter() - self._begun, plan.makespan))

    def raise_bound(self, bound: int) -> None:
        """Note that no plan is faster than this."""
        with self._lock:
            self.bound = max(self.bound, bound)

    def stop(self) -> None:
        """Let all searches come to their end."""
        self._is_stopped = True

    def is_stopped(self) -> bool:
        """Say whether somebody has stopped all searches."""
        return self._is_stopped

    @property
    def is_over(self) -> bool:
        """Say whether searches are to end: nothing can be faster, or somebody stopped them."""
        return self._is_stopped or (not self.plan.has_prices and self.makespan <= self.bound)


def first_plan(situation: Situation) -> TimedPlan | None:
    """Return the best of the first plans; None if a task has too few robots."""
    problem = situation.problem
    starts = [plan for plan in crew_plans(problem) if is_able(problem, plan)]
    return min((time_team_plan(situation, start) for start in starts), key=cost_of, default=None)


def is_able(problem: Relaxed, plan: TeamPlan) -> bool:
    """Say whether every coalition has what its task needs."""
    coalitions = zip(plan.coalition, plan.size, strict=True)
    has = [problem.counts[coalition[:size]].sum(axis=0) for coalition, size in coalitions]
    return all((have >= need).all() for have, need in zip(has, problem.needs, strict=True))


def from_best(best: BestPlan) -> Starts:
    """Begin at the best plan that there is by then, again and again."""
    while True:
        yield best.plan.plan


def from_coalitions(problem: Relaxed, best: BestPlan, seed: int) -> Starts:
    """Begin at coalitions that are good where joining is free and at the best plan, by turns."""
    rounds = relaxed_rounds(problem)
    for turn, plan in enumerate(from_best(best)):
        relaxed = plan_from_coalitions(problem, rounds, seed + turn)
        if relaxed is not None:
            yield relaxed
        yield plan


def improve(
    best: BestPlan, situation: Situation, deadline: float, starts: Starts, seed: int
) -> None:
    """Search from one start after another until the deadline, and offer what is found.

    `deadline` is what `time.perf_counter` then shows. Small worlds end earlier. Of a large mission
    there is one long annealing, from the first start.
    """
    arcs, tasks = TeamArcs(situation, seed), len(situation.tasks)
    left, at_once = ROUNDS * tasks**2, LONGER * rounds_for(situation.problem, is_again=False).arcs
    if tasks >= LARGE:
        left = at_once = ENDLESS
    while left > 0 and not best.is_over and time.perf_counter() < deadline:
        arcs.begin_at(next(starts))
        hot = arcs.search.leg // COOL if tasks < LARGE else arcs.heats[0] // LESS_HOT
        arcs.search.anneal_until(
            deadline,
            min(at_once, left),
            (hot, hot // COLD),
            lambda: best.is_over,
            lambda: best.offer(arcs.best),
        )
        left -= at_once
