"""Teams with batteries: who has to charge does so before its task, and finds room there.

By the rule by which teams charge (`world/phases/charging.py`). Who queues is known only to who
carries a plan out.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed, way_number
from teamformer.planning.step_times.groups import Groups
from teamformer.planning.step_times.shifts import walked_by
from teamformer.world.rules.constants import NOBODY, ROUNDING

REACH, SPARE, FULL, FULL_SPARE, PACE = range(5)
"""In `groups.reach`: how many cells all robots of a team get, what they can spare for the way to a
task, the same of full ones, and how many they walk in a step."""


@kernel
def charge_first(
    problem: Relaxed, plan: CoalitionPlan, groups: Groups, group: int, task: int, leave: int
) -> Any:
    """Let those of a group who leave it for a task charge before, if they have to.

    Return when they are at the task then, NOBODY if they need not charge. What they have left is
    what they have at the task.
    """
    tasks, at, goes = len(plan.order), NOBODY, leave
    cells = np.float64(problem.lengths[0, way_number(problem, group, task)])
    for _ in range(len(problem.batteries.fro) + 1):
        _look_how_far(problem, plan, groups, group, task)
        if cells <= groups.reach[SPARE]:
            break
        here = group if at == NOBODY else tasks + len(groups.of) + at
        following = _charger_for(problem, groups, here, task)
        if following == NOBODY:
            break
        way = problem.batteries.to[here, following]
        goes = walked_by(problem, plan, groups, group, task, goes, _steps_of(groups, way))
        goes += _fill(problem, plan, groups, group, task, way)
        at, cells = following, problem.batteries.fro[following, task]
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        if groups.of[robot] == group:
            groups.left[robot] -= cells / problem.speed[robot]
    if at == NOBODY:
        return NOBODY
    return walked_by(problem, plan, groups, group, task, goes, _steps_of(groups, cells))


@kernel
def spend_at(
    problem: Relaxed, plan: CoalitionPlan, groups: Groups, task: int, count: int, start: int
) -> None:
    """Note what robots have left after a task; the first `count` of `groups.touched` come to it."""
    serves = problem.duration[task] - problem.quickest[task]
    carried = problem.lengths[0, problem.carry[task]] if problem.carry[task] > 0 else 0
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        for place in range(count):
            if groups.touched[place] == groups.of[robot]:
                waits = start - groups.arrive[place]
                groups.left[robot] -= problem.batteries.waiting[robot] * waits
        groups.left[robot] -= problem.batteries.serving[robot] * serves
        groups.left[robot] -= carried / problem.speed[robot]
        lasts = problem.batteries.lasts[robot]
        groups.dry[0] += lasts > 0 and groups.left[robot] < -ROUNDING * lasts


@kernel
def _steps_of(groups: Groups, cells: float) -> int:
    """Return the steps that a team takes for some cells."""
    return int(np.ceil(cells / groups.reach[PACE] - ROUNDING))


@kernel
def _look_how_far(
    problem: Relaxed, plan: CoalitionPlan, groups: Groups, group: int, task: int
) -> None:
    """Work out `groups.reach` of those of a group who leave it for a task."""
    batteries, reach = problem.batteries, groups.reach
    for what in range(len(reach)):
        reach[what] = np.inf
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        if groups.of[robot] != group:
            continue
        pace, lasts = problem.speed[robot], batteries.lasts[robot]
        reach[PACE] = min(reach[PACE], pace)
        if lasts > 0:
            more = ROUNDING * lasts
            left, wanted = groups.left[robot] + more, batteries.wanted[robot, task]
            reach[REACH] = min(reach[REACH], left * pace)
            reach[SPARE] = min(reach[SPARE], (left - wanted) * pace)
            reach[FULL] = min(reach[FULL], (lasts + more) * pace)
            reach[FULL_SPARE] = min(reach[FULL_SPARE], (lasts + more - wanted) * pace)


@kernel
def _charger_for(problem: Relaxed, groups: Groups, here: int, task: int) -> int:
    """Return the charger with the least detour of those in reach; NOBODY if none helps."""
    batteries, onward, reach = problem.batteries, groups.onward, groups.reach
    for charger in range(len(onward)):
        direct = batteries.fro[charger, task]
        onward[charger] = direct if direct <= reach[FULL_SPARE] else np.inf
    from_chargers = len(batteries.to) - len(onward)
    for _ in range(len(onward)):
        for charger in range(len(onward)):
            for other in range(len(onward)):
                hop = batteries.to[from_chargers + charger, other]
                if hop <= reach[FULL]:
                    onward[charger] = min(onward[charger], hop + onward[other])
    best, least = NOBODY, np.inf
    for charger in range(len(onward)):
        way = batteries.to[here, charger]
        is_there = way == 0 and reach[REACH] == reach[FULL]
        if way <= reach[REACH] and way + onward[charger] < least and not is_there:
            best, least = charger, way + onward[charger]
    return best


@kernel
def _fill(
    problem: Relaxed, plan: CoalitionPlan, groups: Groups, group: int, task: int, way: float
) -> int:
    """Let a team that has gone a way charge; return the steps until all its robots are full."""
    steps = 0
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        lasts = problem.batteries.lasts[robot]
        if groups.of[robot] == group and lasts > 0:
            lacks = lasts - groups.left[robot] + way / problem.speed[robot]
            takes = np.ceil((lacks - ROUNDING * lasts) / problem.batteries.filled[robot])
            steps = max(steps, int(takes))
            groups.left[robot] = lasts
    return steps
