"""Solving a linked problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from functools import partial

from teamformer.planning.continuous_bounds.raising import raise_bound
from teamformer.planning.linked.search import COOLER, COOLINGS, LinkedSearch
from teamformer.planning.problem.coalition_plan import CoalitionPlan, without_riders
from teamformer.planning.problem.links import LinkedProblem, is_bounded
from teamformer.planning.problem.schedule import LATE, MAKESPAN, schedule_of
from teamformer.planning.race import Judgement, Race

ROUNDS_EACH, MOST_ROUNDS = 20_000, 600_000
"""The shared plan takes so many rounds for each task, and so many at most: about a second."""

SHORTER, LESS_HOT = 5, 8
"""A search after news is so many times shorter than the first one, and begins less hot."""

FEW_TASKS, SECONDS_EACH = 100, 15.0
"""With fewer tasks than this a search anneals again after so many seconds; with more it anneals
once in all the time there is."""


@dataclass(frozen=True)
class LinkedSolution:
    """A plan and what it costs, as the problem weighs; `curve` holds (seconds, cost).

    Plans are compared by `rank`: what they cost, then what leads the search. No plan is over before
    tick `bound`, and none is better than one that is proven.
    """

    plan: CoalitionPlan
    rank: tuple[float, float]
    bound: int = 0
    is_proven: bool = False
    curve: tuple[tuple[float, float], ...] = ()

    @property
    def cost(self) -> float:
        """Return what the plan costs."""
        return self.rank[0]


def plan_linked(problem: LinkedProblem, seed: int = 0) -> LinkedSolution | None:
    """Return the plan that every robot computes for itself, after a fixed number of rounds.

    None if no coalitions were found: tasks that are linked are done by different robots.
    """
    search = LinkedSearch(problem, seed)
    if not search.begin_anew():
        return None
    search.quench()
    _cool(search, search.heat, shared_rounds(len(problem.group)))
    return _without_riders(problem, _solution(search))


def plan_linked_again(
    problem: LinkedProblem, start: CoalitionPlan, seed: int = 0
) -> LinkedSolution | None:
    """Return the plan that every robot computes after news: from what is left of the old one.

    It is never worse than that, unless robots wait in it for one another for ever. The search is
    shorter than a first one and begins less hot. None if no coalitions were found.
    """
    search = LinkedSearch(problem, seed)
    if not search.begin_at(start) and not search.begin_anew():
        return None
    _cool(search, search.heat / LESS_HOT, shared_rounds(len(problem.group)) // SHORTER)
    return _without_riders(problem, _solution(search))


def shared_rounds(tasks: int) -> int:
    """Return how many rounds the shared plan of so many tasks takes."""
    return min(MOST_ROUNDS, ROUNDS_EACH * tasks)


def _cool(search: LinkedSearch, heat: float, rounds: int) -> None:
    """Anneal from some heat on, so many rounds in all."""
    for _ in range(COOLINGS):
        search.anneal(heat, rounds // COOLINGS)
        heat *= COOLER


def solve_linked(
    problem: LinkedProblem,
    time_limit: float,
    seed: int = 0,
    workers: int = 2,
    start: CoalitionPlan | None = None,
) -> LinkedSolution | None:
    """Return the best plan found in so many seconds; None if no coalitions were found.

    The plan is never worse than the shared plan, or than `start` if there is one. The search ends
    early if a plan is proven.
    """
    begun = time.perf_counter()
    shared = plan_linked(problem, seed)
    if shared is None:
        return None
    race = Race(partial(_judge, problem), shared, begun, begun + time_limit)
    first = (time.perf_counter() - begun, shared.cost)
    if start is not None:
        given = _with_all_seats(problem)
        if given.begin_at(start):
            race.offer(_solution(given))
    jobs = [partial(_bound_and_search, problem, seed + 1, race)]
    jobs += [partial(_search, problem, seed + n, race) for n in range(2, workers + 1)]
    race.run(jobs, len(jobs))
    is_proven = race.judgement.bounded <= race.bound
    best = _without_riders(problem, race.plan)
    return replace(best, bound=race.bound, is_proven=is_proven, curve=(first, *race.curve))


def _with_all_seats(problem: LinkedProblem) -> LinkedSearch:
    """Return a search that can stand at any plan: all robots may come to a task."""
    everybody = problem.base._replace(spares=len(problem.base.counts))
    return LinkedSearch(problem._replace(base=everybody), 0)


def _without_riders(problem: LinkedProblem, solution: LinkedSolution) -> LinkedSolution:
    """Return a solution without robots that only come along."""
    if problem.base.spares == 0:
        return solution
    search = _with_all_seats(problem)

    def cost_of(plan: CoalitionPlan) -> float:
        return search.cost if search.begin_at(plan) else math.inf

    plan = without_riders(problem.base, solution.plan, cost_of)
    search.begin_at(plan)
    return _solution(search)


def _judge(problem: LinkedProblem, solution: LinkedSolution) -> Judgement:
    """Compare plans by their costs; a bound of the makespan is one of plans with nothing late."""
    bounded = math.inf
    if is_bounded(problem):
        total = schedule_of(problem.base, solution.plan).total
        bounded = math.inf if total[LATE] > 0 else int(total[MAKESPAN])
    return Judgement(solution.rank, solution.cost, bounded)


def _solution(search: LinkedSearch) -> LinkedSolution:
    return LinkedSolution(search.best, search.rank)


def _bound_and_search(problem: LinkedProblem, seed: int, race: Race[LinkedSolution]) -> None:
    """Work out a bound, if one says anything of what plans cost, and search then."""
    if is_bounded(problem):
        raise_bound(
            problem.base,
            race,
            lambda: int(schedule_of(problem.base, race.plan.plan).total[MAKESPAN]),
        )
    _search(problem, seed, race)


def _search(problem: LinkedProblem, seed: int, race: Race[LinkedSolution]) -> None:
    """Anneal once in the time there is, or several times, each time from the first plan.

    What the best plan costs says too little of how hot to begin: it is not left any more then.
    """
    search, seconds = LinkedSearch(problem, seed), race.seconds_left
    is_small = len(problem.group) < FEW_TASKS
    for left in range(max(1, round(seconds / SECONDS_EACH)) if is_small else 1, 0, -1):
        if race.is_over:
            break
        search.begin_anew()
        search.quench()
        deadline = time.perf_counter() + race.seconds_left / left
        search.anneal_until(deadline, race, lambda: race.offer(_solution(search)))
