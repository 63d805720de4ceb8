"""A team does its task, carries its load, and does all else that it can do where it is."""

from __future__ import annotations

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.step_times.crossings import Crossings
from teamformer.planning.step_times.groups import (
    Groups,
    can_do,
    do_on_the_way,
    is_begun,
    is_crew,
    may_begin,
    note_too_early,
    slot_of,
)
from teamformer.planning.step_times.shifts import fitted


@kernel
def serve(
    problem: Relaxed,
    crossings: Crossings,
    plan: CoalitionPlan,
    groups: Groups,
    task: int,
    start: int,
    until: int,
    takes: int,
) -> None:
    """Have a team do its task from a step on; it is free when it has done all, on the way too.

    `until` is when what was done on the way is over.
    """
    groups.start[task] = start
    groups.end[task] = start + takes
    groups.free[task] = max(until, groups.end[task])
    groups.is_done[task] = True
    groups.size[task] = plan.size[task]
    for seat in range(plan.size[task]):
        groups.of[plan.coalition[task, seat]] = task
    groups.slot[task] = slot_of(plan, groups, task, task)
    if len(crossings.task) > 0:
        _do_what_is_here(problem, crossings, plan, groups, task)


@kernel
def takes_at(problem: Relaxed, task: int, pace: int) -> int:
    """Return how long a task takes a team; a load goes at its pace."""
    takes = problem.duration[task]
    if problem.carry[task] > 0:
        takes += problem.steps[pace, problem.carry[task]] - problem.quickest[task]
    return takes


@kernel
def _do_what_is_here(
    problem: Relaxed, crossings: Crossings, plan: CoalitionPlan, groups: Groups, task: int
) -> None:
    """Let the team that does a task do all else that it can do there, at the same time."""
    start, slot = groups.start[task], groups.slot[task]
    way = task * len(plan.order) + task
    for index in range(crossings.first[way], crossings.first[way + 1]):
        other = crossings.task[index]
        if is_begun(groups, other, start, slot) or not may_begin(problem, groups, other, start):
            continue
        if not can_do(problem, plan, groups, task, task, other):
            continue
        if fitted(problem, plan, groups, task, start, problem.duration[other]) > start:
            continue
        if groups.is_done[other]:
            note_too_early(groups, task, task, other, start)
            continue
        groups.passes[0] += not is_crew(plan, groups, task, task, other)
        end = start + problem.duration[other]
        do_on_the_way(groups, task, task, other, start, end, slot)
        groups.free[task] = max(groups.free[task], end)
