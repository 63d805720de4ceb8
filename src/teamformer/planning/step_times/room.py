"""Room in zones: tasks take it in the order of the plan, whenever they begin.

So one that comes later in the order begins before another where there is room for both.
"""

from __future__ import annotations

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.step_times.groups import Groups
from teamformer.world.rules.constants import NOBODY


@kernel
def enters(problem: Relaxed, groups: Groups, task: int, count: int) -> int:
    """Return the first step in which a task has room in all its zones; 0 if it is in none.

    The first `count` groups of `groups.touched` come to it. They are assigned to it in a step after
    the one in which they are free.
    """
    first = 0
    for zone in range(problem.permits.needs.shape[1]):
        if problem.permits.needs[task, zone] > 0:
            first = max(first, groups.permits[_first_free(problem, groups, zone)])
            for place in range(count):
                first = max(first, groups.free[groups.touched[place]] + 1)
    return first


@kernel
def take_room(problem: Relaxed, groups: Groups, task: int) -> None:
    """Let a task have room in all its zones until it ends."""
    for zone in range(problem.permits.needs.shape[1]):
        if problem.permits.needs[task, zone] > 0:
            groups.permits[_first_free(problem, groups, zone)] = groups.end[task]


@kernel
def _first_free(problem: Relaxed, groups: Groups, zone: int) -> int:
    """Return the permit of a zone that can be used first."""
    first = NOBODY
    for permit in range(len(groups.permits)):
        is_own = problem.permits.counts[permit, zone] > 0
        if is_own and (first == NOBODY or groups.permits[permit] < groups.permits[first]):
            first = permit
    return first
