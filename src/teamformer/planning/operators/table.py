"""The operators of a search, and for which problems each is.

An operator is a kernel in a file of its own. It changes the arcs of a graph around a task, and says
whether it did. What follows from the change is timed and judged afterwards, for all alike.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array, Int32s
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import StepRules
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.links import have_weights
from teamformer.world.rules.chance import draw_below


class OperatorShares(NamedTuple):
    """How many percent of the changes an operator makes of each kind of problem.

    One that is `with_spares` only is for those in which more robots than are needed may pay, one
    `with_misses` for those in which tasks may be left out; the others have what these leave them.
    """

    name: str
    plain: int  # in continuous time, if the makespan counts
    weighed: int  # if plans have a cost
    steps: int
    large_steps: int  # a hundred tasks and more
    with_spares: bool = False
    with_misses: bool = False


DROP, EXCHANGE_TASKS, EXCHANGE, RIDE, STRETCH, MOVE_GROUP, MOVE_TASK = range(7)

OPERATORS = (
    OperatorShares("drop a task", 10, 10, 10, 10, with_misses=True),
    OperatorShares("exchange tasks", 20, 20, 20, 20, with_misses=True),
    OperatorShares("exchange rests", 40, 30, 25, 30),
    OperatorShares("ride", 15, 10, 20, 5, with_spares=True),
    OperatorShares("move a stretch", 0, 0, 15, 0),
    OperatorShares("move a group", 0, 70, 0, 0),
    OperatorShares("move a task", 100, 0, 100, 100),
)
"""In the order of their numbers; the last of those that a problem has makes all other changes."""


def shares_of(problem: CoalitionProblem, steps: StepRules | None) -> Int32s:
    """Return how many percent of the changes operators make, (operators,)."""
    if steps is not None:
        shares = [one.large_steps if steps.is_large else one.steps for one in OPERATORS]
    else:
        is_weighed = have_weights(problem.links)
        shares = [one.weighed if is_weighed else one.plain for one in OPERATORS]
    has_spares, has_misses = problem.spares > 0, bool(problem.misses.optional.any())
    rest = 100 - has_misses * sum(
        share for one, share in zip(OPERATORS, shares, strict=True) if one.with_misses
    )
    kept = [
        share * has_misses
        if one.with_misses
        else share * rest // 100 * (has_spares or not one.with_spares)
        for one, share in zip(OPERATORS, shares, strict=True)
    ]
    kept[max(place for place, share in enumerate(kept) if share)] = 100
    return np.array(kept, np.int32)


@kernel
def draw_operator(shares: Array, random: Array) -> int:
    """Draw the number of an operator."""
    draw, number = draw_below(random, 100), 0
    while draw >= shares[number]:
        draw -= shares[number]
        number += 1
    return number
