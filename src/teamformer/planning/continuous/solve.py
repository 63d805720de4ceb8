"""Solving a coalition problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from teamformer.planning.arcs.annealing import ENDLESS, ArcSearch, has_few_tasks, shared_annealings
from teamformer.planning.continuous.bounds.makespan import improving_bounds
from teamformer.planning.continuous.cp_sat import is_small, solve_exactly
from teamformer.planning.continuous.problem import CoalitionProblem
from teamformer.planning.continuous.schedule import (
    COST,
    LATE,
    LATENESS,
    MAKESPAN,
    CoalitionPlan,
    Schedule,
    schedule_of,
)

PROOF, LARGE_PROOF = 0.3, 0.1
"""Share of the time that one thread spends on bounds at most, and on CP-SAT again; the latter where
tasks are not few, on bounds alone: they hardly rise."""

MANY_TASKS, SECONDS_EACH = 120, 3.0
"""A search of fewer than `MANY_TASKS` tasks anneals again every `SECONDS_EACH` seconds."""

COOLER = (2, 4)
"""A search of more tasks anneals twice. The heat of the shared plan is divided by these at the
beginning: a search begins at a good plan, and much heat would leave little of it."""


@dataclass(frozen=True)
class Solution:
    """A timed plan, and ticks that no plan beats; `curve` holds (seconds, makespan)."""

    schedule: Schedule
    bound: int
    curve: tuple[tuple[float, int], ...] = ()

    @property
    def plan(self) -> CoalitionPlan:
        """Return the plan itself."""
        return self.schedule.plan

    @property
    def makespan(self) -> int:
        """Return when all is over, in ticks."""
        return int(self.schedule.total[MAKESPAN])

    @property
    def late(self) -> int:
        """Return by how many ticks all tasks together end too late."""
        return int(self.schedule.total[LATE])

    @property
    def is_proven(self) -> bool:
        """Say whether no plan is better: everything in time, and no later than the bound."""
        return self.late == 0 and self.makespan <= self.bound


def plan_together(problem: CoalitionProblem, seed: int = 0) -> Solution | None:
    """Return the plan that every robot computes for itself, after a fixed number of rounds.

    None if some task cannot be done by all robots together. There is no clock and no fraction in
    it, so that it is the same on every machine.
    """
    search = ArcSearch(problem, seed)
    if not search.begin_anew():
        return None
    for rounds in shared_annealings(len(problem.needs)):
        search.anneal(*search.heats, 0, rounds, rounds)
        search.begin_at_best()
    return Solution(schedule_of(problem, search.best), 0)


def solve(
    problem: CoalitionProblem,
    time_limit: float,
    seed: int = 0,
    workers: int = 2,
    start: CoalitionPlan | None = None,
) -> Solution | None:
    """Return the best plan found in so many seconds; None if some task can never be done.

    It begins with the shared plan, or with `start` if that is better, and ends early if a plan is
    proven. The main thread only waits, so that Ctrl-C reaches it.
    """
    begun = time.perf_counter()
    shared = plan_together(problem, seed)
    if shared is None:
        return None
    best = _Best(problem, begun, shared, begun + time_limit)
    if start is not None:
        best.offer(start)
    jobs = [partial(_prove_and_search, problem, seed + 1, best)]
    jobs += [partial(_search, problem, seed + n, best) for n in range(2, workers + 1)]
    with ThreadPoolExecutor(len(jobs)) as pool:
        running = [pool.submit(job) for job in jobs]
        try:
            for job in running:
                job.result()
        finally:
            best.stop()
    return best.solution()


class _Best:
    """The best plan that any thread has found so far, and the highest bound."""

    def __init__(
        self, problem: CoalitionProblem, begun: float, first: Solution, deadline: float
    ) -> None:
        self.deadline, self.bound = deadline, 0
        self._problem, self._begun = problem, begun
        self._plan, self._rank = first.schedule.plan, _rank(first.schedule)
        self.makespan, self._late = first.makespan, first.late
        self._curve = [(time.perf_counter() - begun, first.makespan)]
        self._lock = threading.Lock()
        self._is_stopped = False

    def offer(self, plan: CoalitionPlan) -> None:
        """Take a plan if it is better."""
        schedule = schedule_of(self._problem, plan)
        with self._lock:
            if _rank(schedule) >= self._rank:
                return
            self._plan, self._rank = plan, _rank(schedule)
            self._late = int(schedule.total[LATE])
            if schedule.total[MAKESPAN] != self.makespan:
                self.makespan = int(schedule.total[MAKESPAN])
                self._curve.append((time.perf_counter() - self._begun, self.makespan))

    def stop(self) -> None:
        """Let all searches come to their end."""
        self._is_stopped = True

    @property
    def plan(self) -> CoalitionPlan:
        """Return the best plan."""
        return self._plan

    @property
    def seconds_left(self) -> float:
        """Return the seconds until the searches are to end."""
        return max(0.0, self.deadline - time.perf_counter())

    @property
    def is_over(self) -> bool:
        """Say whether searches are to end: time is up, or nothing can be better."""
        is_proven = self._late == 0 and self.makespan <= self.bound
        return self._is_stopped or is_proven or self.seconds_left == 0.0

    def solution(self) -> Solution:
        """Return the plan with its times."""
        schedule = schedule_of(self._problem, self._plan)
        return Solution(schedule, min(self.bound, self.makespan), tuple(self._curve))


def _rank(schedule: Schedule) -> tuple[int, int]:
    """Return what plans are judged by: makespan and lateness, and only then what a search goes by.

    To a search it also counts how early robots are home on average, which shows it the way.
    """
    makespan, late = int(schedule.total[MAKESPAN]), int(schedule.total[LATE])
    return makespan + LATENESS * late, int(schedule.total[COST])


def _search(problem: CoalitionProblem, seed: int, best: _Best) -> None:
    """Anneal several times, from the best plan each time."""
    search = ArcSearch(problem, seed)
    search.begin_at(best.plan)
    coolings: Sequence[int] = COOLER
    if len(problem.needs) < MANY_TASKS:
        coolings = [1] * max(1, round(best.seconds_left / SECONDS_EACH))
    for number, cooler in enumerate(coolings):
        hot, cold = search.heats
        search.anneal_until(
            time.perf_counter() + best.seconds_left / (len(coolings) - number),
            ENDLESS,
            (hot // cooler, cold),
            lambda: best.is_over,
            lambda: best.offer(search.best),
        )
        search.begin_at_best()


def _prove_and_search(problem: CoalitionProblem, seed: int, best: _Best) -> None:
    """Work out a bound, prove small problems, and search for the rest of the time."""
    is_provable = has_few_tasks(len(problem.needs))
    share = PROOF if is_provable else LARGE_PROOF
    _raise_bound(problem, best, time.perf_counter() + share * best.seconds_left)
    if is_provable and is_small(problem) and not best.is_over:
        proof = solve_exactly(problem, best.plan, best.bound, share * best.seconds_left)
        best.bound = max(best.bound, proof.bound)
        if proof.plan is not None:
            best.offer(proof.plan)
    _search(problem, seed, best)


def _raise_bound(problem: CoalitionProblem, best: _Best, deadline: float) -> None:
    """Raise the bound until a moment, or until it is over."""
    for bound in improving_bounds(problem, lambda: best.makespan):
        best.bound = bound
        if best.is_over or time.perf_counter() > deadline:
            break
