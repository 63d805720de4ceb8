"""A group walks to its next task, and does on its way what it can do there."""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed, way_number
from teamformer.planning.problem.team_batteries import may_charge
from teamformer.planning.step_times.charging import charge_first
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
from teamformer.planning.step_times.shifts import begins_in_passing, walked_by
from teamformer.world.rules.constants import NOBODY, ROUNDING


@kernel
def walk(
    problem: Relaxed,
    crossings: Crossings,
    plan: CoalitionPlan,
    groups: Groups,
    group: int,
    task: int,
    leave: int,
) -> Any:
    """Let the part of a group that leaves walk to a task; return when it is there.

    It does what it can do on the way. Leaves in `groups.until` when that is done too.
    """
    rank, way, cells = _way_to(problem, plan, groups, group, task)
    if may_charge(problem.batteries):
        arrives = charge_first(problem, plan, groups, group, task, leave)
        if arrives != NOBODY:  # what it passes on its way round is not looked at
            groups.until[group] = leave
            return arrives
    slot = slot_of(plan, groups, group, task)
    since, passed = leave, 0  # it walks on from the cell after so many, since then
    here, came, until = NOBODY, leave, leave  # the cell where it does something, and until when
    if len(crossings.task) > 0:
        for index in range(crossings.first[way], crossings.first[way + 1]):
            other, away = crossings.task[index], crossings.cells[index]
            if away == 0 and crossings.speeds[rank] >= 1:
                continue  # it leaves the cell in the first step
            if away != here:
                steps = max(1, _steps_of(problem, crossings, rank, away - passed))
                came = walked_by(problem, plan, groups, group, task, since, steps)
            if is_begun(groups, other, came, slot) or not may_begin(problem, groups, other, came):
                continue
            if away != cells and not _is_stop(crossings.speeds[rank], away - passed):
                continue
            if not can_do(problem, plan, groups, group, task, other):
                continue
            start = begins_in_passing(problem, plan, groups, group, task, other, came)
            if start < came:
                continue
            if groups.is_done[other]:
                note_too_early(groups, group, task, other, start)
                continue
            end = start + problem.duration[other]
            do_on_the_way(groups, group, task, other, start, end, slot)
            is_planned = away == cells and is_crew(plan, groups, group, task, other)
            groups.passes[0] += not is_planned
            if problem.duration[other] > 0:
                until = max(until, end)
                since, passed, here = until, away, away
    groups.until[group] = until
    if here == cells:
        return came
    if passed == 0 and len(problem.lengths) > 1:
        steps = problem.steps[groups.pace[group], way_number(problem, group, task)]
    else:
        steps = _steps_of(problem, crossings, rank, cells - passed)
    return walked_by(problem, plan, groups, group, task, since, steps)


@kernel
def _way_to(problem: Relaxed, plan: CoalitionPlan, groups: Groups, group: int, task: int) -> Any:
    """Return the rank of a group's speed, its way to a task in the crossings, and the way's cells.

    Ways of those that fly come after those of all that walk.
    """
    rank, way = groups.pace[group], group * len(plan.order) + task
    cells = way_number(problem, group, task)
    if len(problem.lengths) > 1:
        speeds, is_flying = len(problem.steps) // 2, 0
        if rank >= speeds:
            rank -= speeds
            way += len(plan.order) * len(groups.end)
            is_flying = 1
        cells = problem.lengths[is_flying, cells]
    return rank, way, cells


@kernel
def _steps_of(problem: Relaxed, crossings: Crossings, rank: int, cells: int) -> int:
    """Return the steps that some cells take, walked or flown, by the rank of the speed."""
    if len(problem.lengths) == 1:
        return problem.steps[rank, cells]
    return int(np.ceil(cells / crossings.speeds[rank] - ROUNDING))


@kernel
def _is_stop(speed: float, cells: int) -> bool:
    """Say whether a team that has left so many cells ago ends a step there."""
    steps = np.ceil(cells / speed - 1e-9)
    return np.floor(steps * speed + 1e-9) == cells
