"""How long one thread of a search works out bounds, and what it tells the others."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from teamformer.planning.continuous_bounds.makespan import improving_bounds
from teamformer.planning.continuous_bounds.relaxations import bound_by_chains_and_work, relax
from teamformer.planning.continuous_bounds.routes import COARSE, FINE, raise_by_routes
from teamformer.planning.problem.coalition_problem import NEVER, CoalitionProblem
from teamformer.planning.race import Race
from teamformer.planning.search.arc_search import has_few_tasks

PROOF, LARGE_PROOF = 0.3, 0.1
"""Share of the time that one thread spends on bounds at most, with few tasks and with more."""

MANY_TASKS = 120
"""With so many tasks only the first bound is asked for: later ones were no better."""


def proof_share(tasks: int) -> float:
    """Return the share of the time for bounds of a problem of so many tasks."""
    if tasks >= MANY_TASKS:
        return 0.0
    return PROOF if has_few_tasks(tasks) else LARGE_PROOF


def raise_bound(problem: CoalitionProblem, race: Race[Any], makespan: Callable[[], int]) -> None:
    """Raise the bound for its share of the time, or until the race is over.

    `makespan` is that of the best plan known.
    """
    deadline = time.perf_counter() + proof_share(len(problem.needs)) * race.seconds_left

    def is_over() -> bool:
        return race.is_over or time.perf_counter() > deadline

    relaxation = relax(problem)
    bound = bound_by_chains_and_work(problem, relaxation)
    race.raise_bound(bound)
    if bound >= NEVER:  # some task is never done
        return
    for units in (COARSE, FINE):
        if not is_over():
            bound = raise_by_routes(problem, relaxation, bound, units, race.raise_bound, is_over)
    for better in improving_bounds(problem, relaxation, bound, makespan):
        race.raise_bound(better)
        if is_over():
            break
