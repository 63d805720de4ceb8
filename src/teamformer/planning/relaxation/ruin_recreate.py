"""Changes to a relaxed plan: tear a few tasks out, put each back where it costs least.

Ruin and recreate, after Christiaens and Vanden Berghe, "Slack induction by string
removals" (Transportation Science 2020), here with coalitions that wait for one another.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.relaxation.insertion import insert_task
from teamformer.planning.relaxation.relaxed_plan import hang_tasks, placed_in, start_tasks
from teamformer.world.rules.chance import draw, draw_below

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.relaxation.insertion import InsertionRoom
    from teamformer.planning.relaxation.relaxed_plan import Timing

NEARBY, STRETCH = 0.5, 0.3
"""How often tasks in one area, or done around one time, are torn out; else any tasks."""

LARGEST_RUIN = 10
"""At most so many tasks are torn out at a time."""


@kernel
def ruin(problem: Relaxed, plan: CoalitionPlan, timing: Timing, room: InsertionRoom) -> Any:
    """Take tasks out of a plan; list them, and those that had no coalition; return how many."""
    placed = placed_in(plan)
    first = _choose_first(problem, plan, timing, room)
    wanted = 1 + draw_below(room.random, min(LARGEST_RUIN, len(plan.size)))
    kind = draw(room.random)
    if kind < NEARBY:
        _tear_nearby(plan, room, first, wanted)
    elif kind < NEARBY + STRETCH:
        _tear_stretch(plan, room, placed, first, wanted)
    else:
        for _ in range(wanted):
            plan.size[draw_below(room.random, len(plan.size))] = 0
    plan.size[first] = 0
    return _close_gaps(plan, placed, room.torn)


@kernel
def _choose_first(
    problem: Relaxed, plan: CoalitionPlan, timing: Timing, room: InsertionRoom
) -> int:
    """Choose any task, or every other time one that the makespan hangs on."""
    chosen = draw_below(room.random, len(plan.size))
    if draw(room.random) < 0.5:
        makespan, _, _ = start_tasks(problem, plan, timing)
        hang_tasks(problem, plan, timing)
        seen = 0
        for position in range(placed_in(plan)):
            task = plan.order[position]
            if timing.start[task] + timing.tail[task] >= makespan:
                seen += 1
                if draw_below(room.random, seen) == 0:
                    chosen = task
    return chosen


@kernel
def _tear_nearby(plan: CoalitionPlan, room: InsertionRoom, first: int, wanted: int) -> None:
    """Take out tasks around one, most but not all of the nearest."""
    for nearby in range(room.near.shape[1]):
        if wanted > 1 and draw(room.random) < 0.6:
            plan.size[room.near[first, nearby]] = 0
            wanted -= 1


@kernel
def _tear_stretch(
    plan: CoalitionPlan, room: InsertionRoom, placed: int, first: int, wanted: int
) -> None:
    """Take out tasks that are done around the same time as one."""
    at = 0
    while at < placed and plan.order[at] != first:
        at += 1
    begin = max(0, at - draw_below(room.random, wanted))
    for position in range(begin, min(begin + wanted, placed)):
        plan.size[plan.order[position]] = 0


@kernel
def _close_gaps(plan: CoalitionPlan, placed: int, torn: Array) -> int:
    """Drop tasks without a coalition from the first of the order; list them, return how many."""
    kept = 0
    for position in range(placed):
        task = plan.order[position]
        if plan.size[task] > 0:
            plan.order[kept] = task
            kept += 1
    count = 0
    for task in range(len(plan.size)):
        if plan.size[task] == 0:
            torn[count] = task
            count += 1
    return count


@allocating_kernel
def recreate(
    problem: Relaxed, plan: CoalitionPlan, timing: Timing, room: InsertionRoom, count: int
) -> None:
    """Put the first of those torn out back, in random order."""
    torn = room.torn
    for last in range(count - 1, 0, -1):
        other = draw_below(room.random, last + 1)
        torn[last], torn[other] = torn[other], torn[last]
    for index in range(count):
        makespan, _, _ = start_tasks(problem, plan, timing)
        hang_tasks(problem, plan, timing)
        insert_task(problem, plan, timing, room, torn[index], makespan)
