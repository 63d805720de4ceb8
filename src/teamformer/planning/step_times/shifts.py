"""Teams in shifts: walks pause while one of a team does not work, and a task fits into one of each.

Where everybody always works nothing of this is asked.
"""

from __future__ import annotations

from typing import Any

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.problem.rotas import (
    fit_together,
    have_shifts,
    pair_off_together,
    walk_together,
)
from teamformer.planning.step_times.groups import Groups
from teamformer.world.rules.pairing import pair_off


@kernel
def walked_by(
    problem: Relaxed,
    plan: CoalitionPlan,
    groups: Groups,
    group: int,
    task: int,
    begin: int,
    steps: int,
) -> Any:
    """Return when those of a group have walked so many steps who leave it for a task."""
    if not have_shifts(problem.rotas):
        return begin + steps
    count = _list_of_group(plan, groups, group, task)
    return walk_together(problem.rotas, groups.together, count, begin, steps, 1)


@kernel
def begins_in_passing(
    problem: Relaxed,
    plan: CoalitionPlan,
    groups: Groups,
    group: int,
    task: int,
    other: int,
    came: int,
) -> Any:
    """Return when those of a group who leave it for a task begin another one that they pass.

    It fits into their shifts when they come there, or when they go on after a pause; else -1.
    """
    if not have_shifts(problem.rotas):
        return came
    count, takes = _list_of_group(plan, groups, group, task), problem.duration[other]
    if fit_together(problem.rotas, groups.together, count, came, takes) == came:
        return came
    again = fit_together(problem.rotas, groups.together, count, came, 1)
    if fit_together(problem.rotas, groups.together, count, again, takes) == again:
        return again
    return -1


@kernel
def united(problem: Relaxed, plan: CoalitionPlan, groups: Groups, task: int, count: int) -> Any:
    """Return the step in which the groups that come to a task are one team."""
    if not have_shifts(problem.rotas):
        return pair_off(groups.arrive, count)
    size = _list_all(plan, groups, task)
    return pair_off_together(problem.rotas, groups.together, size, groups.arrive, count, 1)


@kernel
def fitted(
    problem: Relaxed, plan: CoalitionPlan, groups: Groups, task: int, earliest: int, takes: int
) -> Any:
    """Return the first step from which something fits into a shift of each robot of a task."""
    if not have_shifts(problem.rotas):
        return earliest
    size = _list_all(plan, groups, task)
    return fit_together(problem.rotas, groups.together, size, earliest, takes)


@kernel
def _list_all(plan: CoalitionPlan, groups: Groups, task: int) -> int:
    for seat in range(plan.size[task]):
        groups.together[seat] = plan.coalition[task, seat]
    return plan.size[task]


@kernel
def _list_of_group(plan: CoalitionPlan, groups: Groups, group: int, task: int) -> int:
    """List those of a group who leave it for a task; return how many they are."""
    count = 0
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        if groups.of[robot] == group:
            groups.together[count] = robot
            count += 1
    return count
