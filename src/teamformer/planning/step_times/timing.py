"""When everything in a plan is done if it is played step by step, forming counted.

Robots that have done a task together are a group and stay one as long as they go the same way. A
group whose robots part pays one forming for each further way, the way of the earlier task first;
who has nothing to do on it, or nothing at all, stays behind. Groups that meet at a task pair up
there, one joining a step, until they are one team. A group that comes past a task that it can do
does it, and so does a team that can do more where it stands. So any order with any able
coalitions is a plan that cannot block.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.prices import SHARES, SMOOTH, STEP, price_of_ends
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.step_times.crossings import Crossings
from teamformer.planning.step_times.groups import Groups, gather_at_start
from teamformer.planning.step_times.meet import meet
from teamformer.world.rules.constants import NEVER, NOBODY

STEP_OF_END = 30
"""What a step of the end of any task costs a search: it leads out of plateaus."""
STEP_WALKED = 1
"""What a step walked by a robot costs a search, so that nobody trails along without use."""
LATE = 10_000
"""Steps of makespan that a robot lost before its task's end is worth, or one that runs dry."""


@entry
def time_plan(
    problem: Relaxed, crossings: Crossings, plan: CoalitionPlan, groups: Groups
) -> tuple[Any, Any]:
    """Return what a plan costs, and the same with what leads a search; both are whole numbers.

    That is the makespan or, where a mission has prices, what these make of it, and what is missed.
    A task for nobody is left out; it ends FAR if nobody passes it. Leaves in `groups`
    each task's start and end, the task it waited for, and what was done on the way.
    """
    gather_at_start(problem, groups)
    tasks, has_prices = len(plan.order), len(problem.prices.due) > 0
    step = problem.prices.whole[0] if has_prices else np.int64(STEP * tasks)
    makespan, total, walked = np.int64(0), np.int64(0), np.int64(0)
    can_miss = len(problem.misses.until) > 0
    until = np.int64(problem.misses.until[0]) if can_miss else np.int64(NEVER)
    for position in range(tasks):
        task = plan.order[position]
        if not groups.is_done[task] and can_miss and plan.size[task] == 0:
            continue
        if not groups.is_done[task]:
            walked += meet(problem, crossings, plan, groups, task)
            makespan = max(makespan, groups.free[task])
        total += groups.end[task]
    cost, everything, smooth = step * makespan, np.int64(STEP * tasks), np.int64(STEP_OF_END)
    if has_prices:
        cost += price_of_ends(problem.prices, groups.end, until)
        everything, smooth = np.int64(SHARES * tasks), np.int64(SMOOTH)
    if can_miss:
        missed, total = count_missed(problem, groups, until)
        cost += missed
    if groups.losses[0]:
        cost += LATE * everything * count_late(problem, plan, groups)
    cost += LATE * everything * groups.dry[0]
    return cost, cost + smooth * total + STEP_WALKED * walked


@kernel
def count_missed(problem: Relaxed, groups: Groups, until: int) -> tuple[Any, Any]:
    """Return what it costs that tasks are missed, and the sum of all ends, `until` for theirs."""
    missed, total = np.int64(0), np.int64(0)
    for task in range(len(problem.duration)):
        total += min(groups.end[task], until)
        if groups.end[task] > until:
            missed += problem.misses.judged[task]
    return missed, total


@kernel
def count_late(problem: Relaxed, plan: CoalitionPlan, groups: Groups) -> int:
    """Return how many robots are lost before the end of a task that they are planned for."""
    late = 0
    for task in range(len(plan.order)):
        for seat in range(plan.size[task]):
            late += groups.end[task] >= problem.lost[plan.coalition[task, seat]]
    return late


@kernel
def is_settled(groups: Groups) -> bool:
    """Say whether everything in the plan timed last is done by those who are planned for it."""
    is_passed = groups.passes[0] > 0 or groups.too_early[0] != NOBODY
    return not is_passed and groups.spare[0] == NOBODY
