"""Solving a coalition problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from teamformer.planning.arcs.annealing import ArcSearch, has_few_tasks, shared_annealings
from teamformer.planning.continuous.cp_sat import is_small, solve_exactly
from teamformer.planning.continuous_bounds.raising import MANY_TASKS, proof_share, raise_bound
from teamformer.planning.problem.coalition_plan import CoalitionPlan, without_riders
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.schedule import COST, MAKESPAN, Schedule, schedule_of
from teamformer.planning.race import Judgement, Race

SECONDS_EACH = 3.0
"""A search of fewer than `MANY_TASKS` tasks anneals again every `SECONDS_EACH` seconds."""

COOLER = (1, 3)
"""A search of more tasks anneals twice. The heat of the shared plan is divided by these at the
beginning: the second time it begins at a good plan, and much heat would leave little of it."""


SHORTER, LESS_HOT = 5, 3
"""A search after news is so many times shorter than the first one, and begins less hot."""


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
    def is_proven(self) -> bool:
        """Say whether no plan is better: it is over no later than the bound."""
        return self.makespan <= self.bound


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
    return Solution(_schedule(problem, search.best), 0)


def plan_again(problem: CoalitionProblem, start: CoalitionPlan, seed: int = 0) -> Solution:
    """Return the plan that every robot computes after news: from what is left of the old one.

    It is never worse than that. The search is shorter than a first one and begins less hot.
    """
    search = ArcSearch(problem, seed)
    search.begin_at(start)
    hot, cold = search.heats
    rounds = sum(shared_annealings(len(problem.needs))) // SHORTER
    search.anneal(max(cold, hot // LESS_HOT), cold, 0, rounds, rounds)
    return Solution(_schedule(problem, search.best), 0)


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
    race = Race(partial(judge, problem), shared.plan, begun, begun + time_limit)
    first = (time.perf_counter() - begun, shared.makespan)
    if start is not None:
        race.offer(start)
    jobs = [partial(_prove_and_search, problem, seed + 1, race)]
    jobs += [partial(_search, problem, seed + n, race) for n in range(2, workers + 1)]
    race.run(jobs, len(jobs))
    schedule = _schedule(problem, race.plan)
    bound = min(race.bound, int(schedule.total[MAKESPAN]))
    return Solution(schedule, bound, (first, *race.curve))


def _schedule(problem: CoalitionProblem, plan: CoalitionPlan) -> Schedule:
    """Return a plan with its times, and without robots that only come along."""
    return schedule_of(problem, without_riders(problem, plan, lambda it: judge(problem, it).rank))


def judge(problem: CoalitionProblem, plan: CoalitionPlan) -> Judgement:
    """Compare plans by their makespans, and only then by what leads a search.

    That also counts how early robots are home on average.
    """
    total = schedule_of(problem, plan).total
    makespan = int(total[MAKESPAN])
    return Judgement((makespan, int(total[COST])), makespan, makespan)


def _search(problem: CoalitionProblem, seed: int, race: Race[CoalitionPlan]) -> None:
    """Anneal several times, from the best plan each time."""
    search = ArcSearch(problem, seed)
    search.begin_at(race.plan)
    coolings: Sequence[int] = COOLER
    if len(problem.needs) < MANY_TASKS:
        coolings = [1] * max(1, round(race.seconds_left / SECONDS_EACH))
    for number, cooler in enumerate(coolings):
        hot, cold = search.heats
        search.anneal_until(
            time.perf_counter() + race.seconds_left / (len(coolings) - number),
            race,
            lambda: race.offer(search.best),
            (hot // cooler, cold),
        )
        search.begin_at_best()


def _prove_and_search(problem: CoalitionProblem, seed: int, race: Race[CoalitionPlan]) -> None:
    """Work out a bound, prove small problems, and search for the rest of the time.

    CP-SAT gets as large a share of what is left as bounds get.
    """
    tasks = len(problem.needs)
    raise_bound(problem, race, lambda: int(race.judgement.value))
    if has_few_tasks(tasks) and is_small(problem) and not race.is_over:
        seconds = proof_share(tasks) * race.seconds_left
        proof = solve_exactly(problem, race.plan, race.bound, seconds)
        race.raise_bound(proof.bound)
        if proof.plan is not None:
            race.offer(proof.plan)
    _search(problem, seed, race)
