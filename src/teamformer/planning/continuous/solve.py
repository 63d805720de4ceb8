"""Solving a coalition problem: a shared plan from fixed rounds, or the best one in a given time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

from teamformer.planning.continuous_bounds.cost import least_cost
from teamformer.planning.continuous_bounds.raising import MANY_TASKS, raise_bound
from teamformer.planning.problem.charged_plans import are_carried_out, charged_totals
from teamformer.planning.problem.coalition_plan import CoalitionPlan, without_riders
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.links import have_weights, is_bounded
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.schedule import COST, LATE, MAKESPAN, MISSED, schedule_of
from teamformer.planning.race import Judgement, Race
from teamformer.planning.search.arc_search import ArcSearch

SECONDS_EACH = 3.0
"""A search of fewer than `MANY_TASKS` tasks anneals again every `SECONDS_EACH` seconds."""

COOLER = (1, 3)
"""A search of more tasks anneals twice. The heat of the shared plan is divided by these at the
beginning: the second time it begins at a good plan, and much heat would leave little of it."""

FEW_IF_WEIGHED, SECONDS_EACH_IF_WEIGHED = 100, 15.0
"""If plans have a cost, a search of fewer tasks than this anneals again after so many seconds; with
more it anneals once in all the time there is."""


CHARGED_SEARCHES, CHARGED_PARTS, CHARGED_PARTS_IF_WEIGHED = 4, 28, 50
"""Where robots may queue, so many annealings share the rounds, and of each plans are judged
after so many parts, more if plans have a cost."""

CHARGED_AGAIN = 2
"""After news so many of these annealings are made."""


@dataclass(frozen=True)
class Solution:
    """A plan, and what it is compared by; `curve` holds (seconds, worth).

    That is what it is judged by, its makespan or what it costs, then what leads a search. No plan
    is over before tick `bound`, none costs less than `least_cost`, and none is better than one that
    is proven.
    """

    plan: CoalitionPlan
    rank: tuple[float, float]
    bound: int = 0
    least_cost: float = 0.0
    is_proven: bool = False
    curve: tuple[tuple[float, float], ...] = ()

    @property
    def worth(self) -> float:
        """Return what the plan is judged by: its makespan in ticks, or its cost."""
        return self.rank[0]


def plan_together(problem: CoalitionProblem, seed: int = 0) -> Solution | None:
    """Return the plan that every robot computes for itself, after a fixed number of rounds.

    None if some task cannot be done by all robots together, or if no coalitions were found for
    tasks that are linked: different robots do them. There is no clock in it, and the same sums of
    the same numbers, so that it is the same on every machine.
    """
    if are_carried_out(problem):
        return _plan_charged(problem, seed)
    search = ArcSearch(problem, seed)
    if not search.begin_anew():
        return None
    search.anneal_shared()
    return _without_riders(problem, _found(search))


def _plan_charged(
    problem: CoalitionProblem,
    seed: int,
    start: CoalitionPlan | None = None,
    is_over: Callable[[], bool] = lambda: False,
    searches: int = CHARGED_SEARCHES,
) -> Solution | None:
    """Return the best of several plans, judged with queues at chargers, which searches leave out.

    A few annealings share the rounds, of which so many are made; after each part of one its plans
    are judged. With a `start` they begin there, less hot.
    """
    best = None if start is None else _timed(problem, start)
    parts = CHARGED_PARTS_IF_WEIGHED if have_weights(problem.links) else CHARGED_PARTS
    for number in range(searches):
        search = ArcSearch(problem, seed + number)
        if start is None or not search.begin_at(start):
            start = None
            if not search.begin_anew():
                return best
        for _ in search.anneal_in_parts(CHARGED_SEARCHES, parts, start is not None):
            for plan in (search.best, search.present):
                found = _timed(problem, plan)
                best = found if best is None or found.rank < best.rank else best
            if is_over():
                return best
    return best and _without_riders(problem, best)


def plan_again(problem: CoalitionProblem, start: CoalitionPlan, seed: int = 0) -> Solution | None:
    """Return the plan that every robot computes after news: from what is left of the old one.

    It is never worse than that, unless robots wait in it for one another for ever. The search is
    shorter than a first one and begins less hot. None where `plan_together` finds none.
    """
    if are_carried_out(problem):
        return _mend_charged(problem, start, seed)
    search = ArcSearch(problem, seed)
    if not search.begin_at(start) and not search.begin_anew():
        return None
    search.anneal_again()
    return _without_riders(problem, _found(search))


def _mend_charged(problem: CoalitionProblem, start: CoalitionPlan, seed: int) -> Solution | None:
    """Return the plan after news where robots have batteries.

    If somebody runs dry in it, it is searched for anew.
    """
    best = _plan_charged(problem, seed, start, searches=CHARGED_AGAIN)
    if best is None or math.isinf(best.worth):
        return _plan_charged(problem, seed)
    return best


def solve(
    problem: CoalitionProblem,
    time_limit: float,
    seed: int = 0,
    workers: int = 2,
    start: CoalitionPlan | None = None,
    is_over: Callable[[], bool] = lambda: False,
) -> Solution | None:
    """Return the best plan found in so many seconds; None where `plan_together` finds none.

    It begins with the shared plan, or with `start` if that is better, and ends early if a plan is
    proven, or if it `is_over` because nobody waits for it. The main thread only waits, so that
    Ctrl-C reaches it.
    """
    begun = time.perf_counter()
    shared = plan_together(problem, seed)
    if shared is None:
        return None
    race = Race(partial(judge, problem), shared, begun, begun + time_limit, is_over)
    first = (time.perf_counter() - begun, shared.worth)
    if start is not None:
        race.offer(measuring(problem)(start))
    jobs = [partial(_bound_and_search, problem, seed + 1, race)]
    jobs += [partial(_search, problem, seed + n, race) for n in range(2, workers + 1)]
    race.run(jobs, len(jobs))
    best = _without_riders(problem, race.plan)
    has_least = have_weights(problem.links) and not can_miss(problem.misses)
    least = least_cost(problem) if has_least else 0.0
    is_proven = judge(problem, best).bounded <= race.bound or best.worth <= least
    return replace(
        best, bound=race.bound, least_cost=least, is_proven=is_proven, curve=(first, *race.curve)
    )


def measuring(problem: CoalitionProblem) -> Callable[[CoalitionPlan], Solution]:
    """Return who says what plans of a problem are worth; infinite if robots wait for ever.

    Plans that have a cost are laid out in a graph where all robots may come to a task.
    """
    if are_carried_out(problem) or not have_weights(problem.links):
        return partial(_timed, problem)
    search = ArcSearch(problem._replace(spares=len(problem.counts)), 0)

    def measured(plan: CoalitionPlan) -> Solution:
        is_possible = search.begin_at(plan)
        return Solution(search.best, search.rank) if is_possible else Solution(plan, NEVER_DONE)

    return measured


NEVER_DONE = (math.inf, math.inf)
"""What a plan is worth in which robots wait for ever."""


def _timed(problem: CoalitionProblem, plan: CoalitionPlan) -> Solution:
    if are_carried_out(problem):
        return Solution(plan, charged_totals(problem, plan))
    total = schedule_of(problem, plan).total
    return Solution(plan, (int(total[MAKESPAN] + total[MISSED]), int(total[COST])))


def _found(search: ArcSearch) -> Solution:
    """Return the best plan of a search.

    In a graph what takes no time takes a tick, so that where the makespan counts all is timed anew.
    """
    if have_weights(search.problem.links):
        return Solution(search.best, search.rank)
    return _timed(search.problem, search.best)


def _without_riders(problem: CoalitionProblem, solution: Solution) -> Solution:
    """Return a solution without robots that only come along."""
    if problem.spares == 0:
        return solution
    return without_riders(problem.counts, problem.needs, solution, measuring(problem))


def judge(problem: CoalitionProblem, solution: Solution) -> Judgement:
    """Compare plans by what they are judged by, and only then by what leads a search.

    If they have a cost, a bound of the makespan may say something of those with nothing late.
    """
    bounded = solution.worth
    if have_weights(problem.links):
        total, bounded = schedule_of(problem, solution.plan).total, math.inf
        if not are_carried_out(problem) and is_bounded(problem.links) and total[LATE] == 0:
            bounded = int(total[MAKESPAN])
    if can_miss(problem.misses):
        bounded = math.inf
    return Judgement(solution.rank, solution.worth, bounded)


def _search(problem: CoalitionProblem, seed: int, race: Race[Solution]) -> None:
    """Anneal once or several times, each time from the best plan.

    If plans have a cost it begins anew each time: what the best plan costs says too little of how
    hot to begin, as it is not left any more then.
    """
    if are_carried_out(problem):
        _search_charged(problem, seed, race)
        return
    search, is_weighed = ArcSearch(problem, seed), have_weights(problem.links)
    if not is_weighed:
        search.begin_at(race.plan.plan)
    coolings = _coolings(problem, race.seconds_left)
    for number, cooler in enumerate(coolings):
        if race.is_over:
            break
        if is_weighed:
            search.begin_anew()
            search.quench()
        hot, cold = search.heats
        search.anneal_until(
            time.perf_counter() + race.seconds_left / (len(coolings) - number),
            race,
            lambda: race.offer(_found(search)),
            (hot / cooler, cold),
        )
        if not is_weighed:
            search.begin_at_best()


def _search_charged(problem: CoalitionProblem, seed: int, race: Race[Solution]) -> None:
    """Search again and again, anew and from the best plan in turns."""
    number = 0
    while not race.is_over:
        start = race.plan.plan if number % 2 else None
        own = 1000 * seed + CHARGED_SEARCHES * number
        found = _plan_charged(problem, own, start, lambda: race.is_over)
        if found is not None:
            race.offer(found)
        number += 1


def _coolings(problem: CoalitionProblem, seconds: float) -> Sequence[int]:
    """Return what the heat of each annealing in so many seconds is divided by at its beginning."""
    tasks = len(problem.needs)
    if have_weights(problem.links):
        is_few = tasks < FEW_IF_WEIGHED
        return [1] * max(1, round(seconds / SECONDS_EACH_IF_WEIGHED) if is_few else 1)
    return COOLER if tasks >= MANY_TASKS else [1] * max(1, round(seconds / SECONDS_EACH))


def _bound_and_search(problem: CoalitionProblem, seed: int, race: Race[Solution]) -> None:
    """Work out a bound, and search for the rest of the time."""
    if is_bounded(problem.links) and not can_miss(problem.misses):
        raise_bound(
            problem, race, lambda: int(schedule_of(problem, race.plan.plan).total[MAKESPAN])
        )
    _search(problem, seed, race)
