"""Solving a coalition problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from teamformer.planning.arcs.annealing import ArcSearch, rounds_of_a_second
from teamformer.planning.coalitions.bounds.makespan import improving_bounds
from teamformer.planning.coalitions.cp_sat import is_small, solve_exactly
from teamformer.planning.coalitions.problem import CoalitionProblem
from teamformer.planning.coalitions.search.annealing import CoalitionSearch, schedule_of
from teamformer.planning.coalitions.search.schedule import (
    COST,
    LATE,
    LATENESS,
    MAKESPAN,
    CoalitionPlan,
    Schedule,
)

FEWEST_FOR_ARCS = 30
"""Plans of so many tasks are searched for as graphs of arcs; of fewer, as orders of tasks."""

SHARED_ROUNDS, CENTRAL_ROUNDS = 200_000, 500_000
"""Rounds of a first annealing; reheated ones have half of them."""

USUAL_TASKS = 20
"""With more tasks rounds take longer, with fewer there is less to find: there are fewer rounds."""

FEWEST_ROUNDS = 200

SHARED_REHEATS, CENTRAL_REHEATS = 2, 6
"""How often an annealing goes on from its best plan before the search begins anew."""

HOT, REHEATED, COLD = 28, 56, 280
"""Annealings begin and end at what a task takes a robot on average, divided by these."""

SECONDS_AT_ONCE = 0.05
"""Between two looks at the clock."""

PROOF, LARGE_PROOF = 0.3, 0.1
"""Share of the time that one thread spends on bounds at most, and on CP-SAT again; the latter of
problems that are large enough for arcs, whose bounds hardly rise."""

MANY_TASKS, SECONDS_EACH = 120, 3.0
"""With fewer tasks than this a search over arcs anneals again after so many seconds; with more it
anneals once in all the time there is."""


class Annealing(NamedTuple):
    """One annealing of a search: anew or from the best plan, how hot it begins, how long it is."""

    is_anew: bool
    hot: int
    rounds: int


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


def is_for_arcs(problem: CoalitionProblem) -> bool:
    """Say whether plans of a problem are searched for as graphs of arcs."""
    return len(problem.needs) >= FEWEST_FOR_ARCS


def annealings(tasks: int, rounds: int, reheats: int) -> Iterator[Annealing]:
    """Return the annealings between two fresh starts."""
    share = min(tasks / USUAL_TASKS, USUAL_TASKS / tasks)
    first = max(FEWEST_ROUNDS, int(rounds * share))
    yield Annealing(True, HOT, first)
    for _ in range(reheats):
        yield Annealing(False, REHEATED, first // 2)


def plan_together(problem: CoalitionProblem, seed: int = 0) -> Solution | None:
    """Return the plan that every robot computes for itself, after a fixed number of rounds.

    None if some task cannot be done by all robots together. There is no clock and no fraction in
    it, so that it is the same on every machine.
    """
    if is_for_arcs(problem):
        return _plan_by_arcs(problem, seed)
    search = CoalitionSearch(problem, seed)
    for annealing in annealings(len(problem.needs), SHARED_ROUNDS, SHARED_REHEATS):
        if not _begin(search, annealing):
            return None
        leg = search.leg
        search.anneal(leg // annealing.hot, leg // COLD, 0, annealing.rounds, annealing.rounds)
    return Solution(schedule_of(problem, search.best), 0)


def _plan_by_arcs(problem: CoalitionProblem, seed: int) -> Solution | None:
    """Return the shared plan of a large problem: one annealing of about a second."""
    search = ArcSearch(problem, seed)
    if not search.begin_anew():
        return None
    rounds = rounds_of_a_second(len(problem.needs))
    search.anneal(*search.heats, 0, rounds, rounds)
    return Solution(schedule_of(problem, search.best), 0)


def solve(
    problem: CoalitionProblem, time_limit: float, seed: int = 0, workers: int = 2
) -> Solution | None:
    """Return the best plan found in so many seconds; None if some task can never be done.

    It begins with the shared plan and ends early if a plan is proven. The main thread only waits,
    so that Ctrl-C reaches it.
    """
    begun = time.perf_counter()
    shared = plan_together(problem, seed)
    if shared is None:
        return None
    best = _Best(problem, begun, shared, begun + time_limit)
    jobs = [partial(_prove_and_search, problem, seed + 1, best)]
    search = _search_arcs if is_for_arcs(problem) else _search
    jobs += [partial(search, problem, seed + n, best) for n in range(2, workers + 1)]
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


def _begin(search: CoalitionSearch, annealing: Annealing) -> bool:
    if annealing.is_anew:
        return search.begin_anew()
    search.begin_at_best()
    return True


def _search(problem: CoalitionProblem, seed: int, best: _Best) -> None:
    """Anneal again and again, each time from a fresh start, until it is over."""
    search = CoalitionSearch(problem, seed)
    while not best.is_over:
        for annealing in annealings(len(problem.needs), CENTRAL_ROUNDS, CENTRAL_REHEATS):
            _begin(search, annealing)
            _anneal_by_the_clock(search, annealing, best)


def _anneal_by_the_clock(search: CoalitionSearch, annealing: Annealing, best: _Best) -> None:
    """Make an annealing a few rounds at a time, and offer what it finds."""
    made, at_once, leg = 0, FEWEST_ROUNDS, search.leg
    while made < annealing.rounds and not best.is_over:
        seconds = -time.perf_counter()
        end = min(annealing.rounds, made + at_once)
        search.anneal(leg // annealing.hot, leg // COLD, made, end, annealing.rounds)
        seconds += time.perf_counter()
        best.offer(search.best)
        room = min(SECONDS_AT_ONCE, best.seconds_left)
        made, at_once = end, max(1, min(2 * at_once, int(at_once * room / max(seconds, 1e-7))))


def _search_arcs(problem: CoalitionProblem, seed: int, best: _Best) -> None:
    """Anneal once in the time there is, or several times, from the best plan each time."""
    search, seconds = ArcSearch(problem, seed), best.seconds_left
    search.begin_at(best.plan)
    is_large = len(problem.needs) >= MANY_TASKS
    for left in range(1 if is_large else max(1, round(seconds / SECONDS_EACH)), 0, -1):
        _anneal_for(search, best.seconds_left / left, best)
        search.begin_at_best()


def _anneal_for(search: ArcSearch, seconds: float, best: _Best) -> None:
    """Anneal for so many seconds, a few rounds at a time, and offer what is found."""
    (hot, cold), at_once, cost = search.heats, FEWEST_ROUNDS, search.cost
    begun = now = time.perf_counter()
    while now < begun + seconds and not best.is_over:
        heat = hot + int((cold - hot) * (now - begun) / seconds)
        search.anneal(heat, heat, 0, at_once, at_once)
        if search.cost < cost:
            cost = search.cost
            best.offer(search.best)
        took, now = time.perf_counter() - now, time.perf_counter()
        at_once = max(1, min(2 * at_once, int(at_once * SECONDS_AT_ONCE / max(took, 1e-7))))


def _prove_and_search(problem: CoalitionProblem, seed: int, best: _Best) -> None:
    """Work out a bound, prove small problems, and search for the rest of the time."""
    if is_for_arcs(problem):
        _raise_bound(problem, best, time.perf_counter() + LARGE_PROOF * best.seconds_left)
        return _search_arcs(problem, seed, best)
    _raise_bound(problem, best, time.perf_counter() + PROOF * best.seconds_left)
    if is_small(problem) and not best.is_over:
        proof = solve_exactly(problem, best.plan, best.bound, PROOF * best.seconds_left)
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
