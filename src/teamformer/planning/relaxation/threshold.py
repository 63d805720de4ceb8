"""Relaxed coalitions in whole numbers: the same search on every machine gives the same ones.

Ruin and recreate as in `ruin_recreate`, but worse plans are accepted by a threshold that sinks to
nothing (Dueck and Scheuer 1990), which needs no fraction and no logarithm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.jit import entry, kernel
from teamformer.planning.relaxation.insertion import empty_desk
from teamformer.planning.relaxation.plan import copy_plan, empty_plan, empty_timing, start_tasks
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.relaxation.ruin_recreate import recreate, ruin
from teamformer.planning.relaxation.schedule import Schedule, read_schedule
from teamformer.rules.arrays import Array

if TYPE_CHECKING:
    from teamformer.planning.relaxation.insertion import Desk
    from teamformer.planning.relaxation.plan import Plan, Timing

STEP = 5
"""What a step of makespan costs, for each robot; a step that a robot walks costs 1."""
UNDONE = 10**9
"""What a task without a coalition costs."""
HOT = 6
"""How many steps of makespan a plan may be worse at first."""


def search_coalitions(problem: Relaxed, rounds: int, seed: int = 0) -> Schedule | None:
    """Return the best relaxed schedule of so many rounds; None if a task cannot be done."""
    plans = tuple(empty_plan(problem) for _ in range(3))
    timing, desk = empty_timing(problem, plans[0]), empty_desk(problem, seed)
    torn = np.zeros(len(problem.appears), np.int32)
    _search(problem, *plans, timing, desk, torn, rounds)
    return read_schedule(problem, plans[1])


@entry
def _search(
    problem: Relaxed,
    plan: Plan,
    best: Plan,
    spare: Array,
    timing: Timing,
    desk: Desk,
    torn: Array,
    rounds: int,
) -> None:
    """Ruin and recreate; begins with nothing placed, so that the first round places everything."""
    cost, lowest = np.int64(2**62), np.int64(2**62)
    hot = HOT * STEP * len(timing.robots)
    for made in range(rounds):
        copy_plan(plan, spare)
        count = ruin(problem, spare, timing, desk, torn)
        recreate(problem, spare, timing, desk, torn, count)
        new = _cost(problem, spare, timing)
        if made == 0 or new <= cost + hot * (rounds - made) // rounds:
            copy_plan(spare, plan)
            cost = new
            if new < lowest:
                copy_plan(spare, best)
                lowest = new


@kernel
def _cost(problem: Relaxed, plan: Plan, timing: Timing) -> Any:
    makespan, walked, late = start_tasks(problem, plan, timing)
    undone = late + len(plan.size) - plan.placed[0]
    return np.int64(makespan) * STEP * len(timing.robots) + walked + undone * UNDONE
