"""The search for a good relaxed plan, in whole numbers: the same one on every machine.

Ruin and recreate as in `ruin_recreate`; worse plans are accepted by a threshold that sinks (Dueck
and Scheuer 1990), which needs no fraction and no logarithm.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, needs_compiling
from teamformer.planning.problem.coalition_plan import CoalitionPlan, copy_plan, plan_of_lists
from teamformer.planning.problem.prices import price_of_ends
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.relaxation.insertion import insertion_room
from teamformer.planning.relaxation.relaxed_plan import (
    empty_plan,
    empty_timing,
    makespan_of,
    placed_in,
    start_tasks,
)
from teamformer.planning.relaxation.ruin_recreate import recreate, ruin

if TYPE_CHECKING:
    from teamformer.planning.relaxation.insertion import InsertionRoom
    from teamformer.planning.relaxation.relaxed_plan import Timing

STEP = 5
"""What a step of makespan costs, for each robot; a step that a robot walks costs 1."""
UNDONE = 10**9
"""What a task without a coalition, or with a lost robot in it, costs."""
HOT = 6.0
"""How many steps of makespan a plan may be worse at first."""
ENDLESS = 2**62
"""The cost of no plan."""


class ThresholdSearch:
    """A search: where it stands, the best plan it has seen, and room to work in."""

    def __init__(self, problem: Relaxed, seed: int) -> None:
        self.problem = problem
        self._plan, self._best, self._spare = (empty_plan(problem) for _ in range(3))
        self._timing = empty_timing(problem, self._plan)
        self._room = insertion_room(problem, seed)
        self._costs = np.array([ENDLESS, ENDLESS, 0])  # of the plan it stands at, of the best;
        # and the price of a step, 0 where the makespan counts

    def go_by_price(self) -> None:
        """Search by what plans cost from now on; the mission has prices.

        As much as the first plan takes or costs is worth the same, so that it is as hot.
        """
        self.run(1)
        makespan, _, late = start_tasks(self.problem, self._best, self._timing)
        if late or (self._best.size == 0).any():
            return
        price = _price_of(self.problem, self._timing, makespan)
        self._costs[2], self._room.by_price[0] = max(1, price // makespan), True
        copy_plan(self._best, self._plan)
        self._costs[:2] = cost_of(self.problem, self._best, self._timing, self._costs[2])

    def run(self, rounds: int, hot: float = HOT, cool: float = 0.0) -> None:
        """Search for some rounds; plans may be worse by `hot` steps at first, `cool` in the end.

        The first round of all places everything.
        """
        step = STEP * len(self._timing.robots)
        room = (self._spare, self._timing, self._room, self._costs)
        heats = (int(hot * step), int(cool * step))
        _search(self.problem, self._plan, self._best, *room, rounds, *heats)

    @property
    def cost(self) -> int:
        """Return what the best plan costs; it falls whenever a better one is found."""
        return int(self._costs[1])

    @property
    def best(self) -> CoalitionPlan | None:
        """Return the best plan seen, None if each has a task that nobody is left to do."""
        if makespan_of(self.problem, self._best) is None:
            return None
        rows = zip(self._best.coalition.tolist(), self._best.size.tolist(), strict=True)
        coalitions = [sorted(robots[:size]) for robots, size in rows]
        return plan_of_lists(self._best.order.tolist(), coalitions)


def is_compiled() -> bool:
    """Say whether the search was compiled before, so that a first plan has not to wait for it."""
    return not needs_compiling(_search)


@entry
def _search(
    problem: Relaxed,
    plan: CoalitionPlan,
    best: CoalitionPlan,
    spare: CoalitionPlan,
    timing: Timing,
    room: InsertionRoom,
    costs: Array,
    rounds: int,
    hot: int,
    cool: int,
) -> None:
    """Ruin and recreate for a number of rounds.

    `plan` is where the search stands and `best` the best seen; `costs` holds the costs of both,
    and the price of a step.
    `spare` and `room` are to work in; `hot` is what a change may cost at first and `cool` in
    the end.
    """
    for made in range(rounds):
        copy_plan(plan, spare)
        count = ruin(problem, spare, timing, room)
        recreate(problem, spare, timing, room, count)
        cost = cost_of(problem, spare, timing, costs[2])
        if cost <= costs[0] + (hot * (rounds - made) + cool * made) // rounds:
            copy_plan(spare, plan)
            costs[0] = cost
            if cost < costs[1]:
                copy_plan(spare, best)
                costs[1] = cost


@entry
def cost_of(problem: Relaxed, plan: CoalitionPlan, timing: Timing, step: int) -> Any:
    """Return what the search minimises: by the price of a step, or the makespan if that is 0."""
    makespan, walked, late = start_tasks(problem, plan, timing)
    undone, share = late + len(plan.size) - placed_in(plan), STEP * len(timing.robots)
    if step > 0:
        return _price_of(problem, timing, makespan) * share // step + walked + undone * UNDONE
    return np.int64(makespan) * share + walked + undone * UNDONE


@entry
def _price_of(problem: Relaxed, timing: Timing, makespan: int) -> Any:
    """Return what a plan costs whose tasks have been started."""
    return problem.prices.whole[0] * makespan + price_of_ends(problem.prices, timing.end)
