"""Changes of a plan that are judged by their plays.

What robots that are lost and come back do meanwhile, where a load was set down, and where ways of
broken speeds end decide about a play, and no plan counts with them. So plans near the best one are
played, too, while there is time.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.methods.central.plays import Plays
from teamformer.planning.problem.coalition_plan import CoalitionPlan, keep_order, plan_of_lists
from teamformer.planning.problem.relaxed_problem import Relaxed

PATIENCE = 400
"""How many plays in a row may find nothing better."""

FAMILIAR = 200
"""How many changes in a row may lead to plans that were played already."""

Draft = tuple[tuple[int, ...], tuple[tuple[int, ...], ...]]
"""The order of the tasks, and the robots of each task, sorted."""


def vary(problem: Relaxed, plays: Plays, bound: int, seed: int) -> None:
    """Play one change of the best plan after another, going on from whatever is no worse.

    It ends when time is up, a play is proven the best by `bound`, nothing better is found for
    long, or there is hardly another plan.
    """
    if plays.best_plan is None:
        return
    rank, plan = plays.best_plan
    rng, here = np.random.default_rng(seed), _draft_of(plan)
    tried, waited, known = {here}, 0, 0
    while waited < PATIENCE and known < FAMILIAR:
        if plays.is_proven(bound) or plays.seconds_left == 0.0:
            break
        draft = here
        for _ in range(rng.geometric(0.5)):
            draft = _changed(problem, draft, rng)
        known += 1
        if draft in tried:
            continue
        tried.add(draft)
        known, waited = 0, waited + 1
        found = plays.add_plan("search", plan_of_lists(*draft))
        if found < rank:
            waited = 0
        if found <= rank:
            here, rank = draft, found


def _draft_of(plan: CoalitionPlan) -> Draft:
    crews = zip(plan.coalition.tolist(), plan.size.tolist(), strict=True)
    return tuple(plan.order.tolist()), tuple(tuple(sorted(crew[:size])) for crew, size in crews)


def _changed(problem: Relaxed, draft: Draft, rng: np.random.Generator) -> Draft:
    """Return a draft with a task elsewhere in the order or done by others, if these are able."""
    order, crews = draft
    task = int(rng.integers(len(order)))
    if rng.random() < 0.5:
        rest = [other for other in order if other != task]
        rest.insert(int(rng.integers(len(order))), task)
        return tuple(keep_order(problem.before, rest)), crews
    crew = _other_crew(crews, task, len(problem.pace), rng)
    if not crew or (problem.counts[crew].sum(axis=0) < problem.needs[task]).any():
        return draft
    return order, (*crews[:task], tuple(sorted(crew)), *crews[task + 1 :])


def _other_crew(
    crews: Sequence[Sequence[int]], task: int, robots: int, rng: np.random.Generator
) -> list[int]:
    """Return a task's crew with a robot more, one less or another, or the crew of another task."""
    crew, robot = set(crews[task]), int(rng.integers(robots))
    kind = int(rng.integers(3))
    if kind == 0:
        return list(crews[int(rng.integers(len(crews)))])
    if kind == 1 and crew:
        crew.discard(int(rng.choice(sorted(crew))))
        return sorted(crew | {robot})
    return sorted(crew ^ {robot})
