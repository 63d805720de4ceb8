"""Groups come together at a task, one joining a step, and those that part pay for it."""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.permits import are_zoned
from teamformer.planning.problem.relaxed_problem import Relaxed, pace_together
from teamformer.planning.problem.team_batteries import may_charge
from teamformer.planning.step_times.charging import spend_at
from teamformer.planning.step_times.crossings import Crossings
from teamformer.planning.step_times.groups import Groups, can_do, opens
from teamformer.planning.step_times.room import enters, take_room
from teamformer.planning.step_times.serving import serve, takes_at
from teamformer.planning.step_times.shifts import fitted, united
from teamformer.planning.step_times.walking import walk


@kernel
def meet(
    problem: Relaxed, crossings: Crossings, plan: CoalitionPlan, groups: Groups, task: int
) -> Any:
    """Bring a task's coalition together and let it do it; return the steps that robots walk."""
    count = _list_groups(problem, plan, groups, task)
    walked, until, pace = _arrive(problem, crossings, plan, groups, task, count)
    if count > 1:
        _note_spare_group(problem, plan, groups, task, count)
    start = max(united(problem, plan, groups, task, count), opens(problem, groups, task))
    takes = takes_at(problem, task, pace)
    if are_zoned(problem.permits):
        start = max(start, enters(problem, groups, task, count))
    start = fitted(problem, plan, groups, task, start, takes)
    if may_charge(problem.batteries):
        spend_at(problem, plan, groups, task, count, start)
    serve(problem, crossings, plan, groups, task, start, until, takes)
    if are_zoned(problem.permits):
        take_room(problem, groups, task)
    return walked


@kernel
def _list_groups(problem: Relaxed, plan: CoalitionPlan, groups: Groups, task: int) -> int:
    """List the groups that robots come from, how many leave each, and their pace; count them."""
    count = 0
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        group = groups.of[robot]
        if groups.seen[group] != task:
            groups.seen[group] = task
            groups.pace[group] = problem.pace[robot]
            groups.leaving[group] = 0
            groups.touched[count] = group
            count += 1
        groups.pace[group] = pace_together(problem, groups.pace[group], problem.pace[robot])
        groups.leaving[group] += 1
    return count


@kernel
def _arrive(
    problem: Relaxed,
    crossings: Crossings,
    plan: CoalitionPlan,
    groups: Groups,
    task: int,
    count: int,
) -> tuple[Any, Any, Any]:
    """Have groups part from who stays, and walk to a task; sort them by when they are there.

    Return the steps that robots walk, when all that is done on the way is over, and the pace of
    the slowest.
    """
    walked, until, pace = np.int64(0), 0, groups.pace[groups.touched[0]]
    for place in range(count):
        group = groups.touched[place]
        pace = pace_together(problem, pace, groups.pace[group])
        groups.size[group] -= groups.leaving[group]
        groups.splits[group] += groups.size[group] > 0
        leave = groups.free[group] + groups.splits[group] * groups.forming[0]
        arrival = walk(problem, crossings, plan, groups, group, task, leave)
        walked += (arrival - leave) * groups.leaving[group]
        until = max(until, groups.until[group])
        if count > 1:
            arrival = max(arrival, groups.until[group])
        gap = place
        while gap > 0 and groups.arrive[gap - 1] > arrival:
            groups.arrive[gap] = groups.arrive[gap - 1]
            groups.touched[gap] = groups.touched[gap - 1]
            gap -= 1
        groups.arrive[gap], groups.touched[gap] = arrival, group
    return walked, until, pace


@kernel
def _note_spare_group(
    problem: Relaxed, plan: CoalitionPlan, groups: Groups, task: int, count: int
) -> None:
    """Note the last to come of those groups without which a task can be done: it would be."""
    for place in range(count - 1, -1, -1):
        if can_do(problem, plan, groups, groups.touched[place], task, task, is_with=False):
            groups.spare[0], groups.spare[1] = task, groups.touched[place]
            return
