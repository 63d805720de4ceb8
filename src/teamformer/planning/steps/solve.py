"""The central plan with forming counted: searched from one start after another until time is up."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.race import Judgement, Race
from teamformer.planning.steps.arc_search import COLD, COOL, LARGE, LESS_HOT, TeamArcs
from teamformer.planning.steps.shared_plan import relaxed_rounds, rounds_for
from teamformer.planning.steps.situation import Situation
from teamformer.planning.steps.starts import plan_from_coalitions, plan_from_crews
from teamformer.planning.steps.timed_plan import TimedPlan, time_team_plan

Starts = Iterator[CoalitionPlan]
"""Plans to search from, one after another."""

LONGER = 4
"""How many times as many rounds an annealing has as those of the shared plan."""

ROUNDS = 3000
"""Rounds for each pair of tasks; a search that long finds nothing more."""


def begin_race(
    first: TimedPlan,
    begun: float,
    deadline: float,
    is_abandoned: Callable[[], bool] = lambda: False,
) -> Race[TimedPlan]:
    """Return a race of plans in steps that a first one leads; `is_abandoned` as in `Race`."""
    return Race(_judge, first, begun, deadline, is_abandoned)


def _judge(plan: TimedPlan) -> Judgement:
    """Compare plans by their costs; bounds are of the makespan, if that alone counts."""
    is_bounded = not plan.has_prices and plan.missed is None
    bounded = plan.makespan if is_bounded else math.inf
    return Judgement(plan.rank, plan.makespan, bounded)


def first_plan(situation: Situation) -> TimedPlan | None:
    """Return what crews do that share a tour out; None if a task has too few robots."""
    plan = plan_from_crews(situation.problem, situation.company, rounds=0)
    return time_team_plan(situation, plan) if is_able(situation.problem, plan) else None


def is_able(problem: Relaxed, plan: CoalitionPlan) -> bool:
    """Say whether every coalition has what its task needs."""
    coalitions = zip(plan.coalition, plan.size, strict=True)
    has = [problem.counts[coalition[:size]].sum(axis=0) for coalition, size in coalitions]
    return all((have >= need).all() for have, need in zip(has, problem.needs, strict=True))


def from_best(race: Race[TimedPlan]) -> Starts:
    """Begin at the best plan that there is by then, again and again."""
    while True:
        yield race.plan.plan


def from_coalitions(problem: Relaxed, race: Race[TimedPlan], seed: int) -> Starts:
    """Begin at coalitions that are good where joining is free and at the best plan, by turns."""
    rounds = relaxed_rounds(problem)
    for turn, plan in enumerate(from_best(race)):
        relaxed = plan_from_coalitions(problem, rounds, seed + turn)
        if relaxed is not None:
            yield relaxed
        yield plan


def improve(race: Race[TimedPlan], situation: Situation, starts: Starts, seed: int) -> None:
    """Search from one start after another until the race is over, and offer what is found.

    Small worlds end earlier. Of a large mission there is one long annealing, from the first start.
    """
    arcs, tasks = TeamArcs(situation, seed), len(situation.tasks)
    rounds, times = math.inf, 1
    if tasks < LARGE:
        rounds = LONGER * rounds_for(situation.problem, is_again=False).arcs
        times = math.ceil(ROUNDS * tasks**2 / rounds)
    for _ in range(times):
        if race.is_over:
            break
        arcs.begin_at(next(starts))
        hot = arcs.search.leg // COOL if tasks < LARGE else arcs.heats[0] // LESS_HOT
        arcs.search.anneal_until(
            race.deadline,
            race,
            lambda: race.offer(arcs.best),
            (hot, hot // COLD),
            rounds,
        )
