"""Who is in which crew: as many crews as are complete, of robots that can reach one another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.planning.crews.routes import count_crews
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.coverage import covers

if TYPE_CHECKING:
    from teamformer.planning.crews.routes import Shared


@allocating_kernel
def deal_robots(shared: Shared, crew: Array) -> None:
    """Deal the robots out into crews, region by region; write each robot's crew.

    A crew takes robots that bring something it still lacks, until it has what any one task needs
    and one of every capability, or nobody brings any of it. Robots that start as a team stay
    together.
    """
    brings = np.zeros(shared.counts.shape, dtype=np.int64)  # of each company, at its leader
    regions = 0
    for robot in range(len(crew)):
        _add(shared.counts[robot], brings[shared.company[robot]])
        regions = max(regions, shared.robot_region[robot] + 1)
    demand = np.empty(shared.counts.shape[1], dtype=np.int64)
    have = np.empty(shared.counts.shape[1], dtype=np.int64)
    number = 0
    for region in range(regions):
        _demand_in(shared, region, demand)
        is_dealt = False
        while not is_dealt:
            for cap in range(len(have)):
                have[cap] = 0
            chosen = _most_useful(shared, crew, region, brings, demand, have)
            is_dealt = chosen == NOBODY
            while chosen != NOBODY:
                for robot in range(len(crew)):
                    if shared.company[robot] == chosen:
                        crew[robot] = number
                _add(brings[chosen], have)
                chosen = _most_useful(shared, crew, region, brings, demand, have)
            number += not is_dealt


@kernel
def _add(counts: Array, to: Array) -> None:
    for cap in range(len(to)):
        to[cap] += counts[cap]


@kernel
def _demand_in(shared: Shared, region: int, demand: Array) -> None:
    """Write what a crew of a region needs to do any of its tasks, and at least 1 of all."""
    for cap in range(len(demand)):
        demand[cap] = 1
        for task in range(len(shared.needs)):
            if shared.task_region[task] == region:
                demand[cap] = max(demand[cap], shared.needs[task, cap])


@kernel
def _most_useful(
    shared: Shared, crew: Array, region: int, brings: Array, demand: Array, have: Array
) -> int:
    """Return the company without crew that brings most of what is lacking and least besides."""
    best, best_use, best_waste = NOBODY, 0, 0
    for leader in range(len(crew)):
        is_there = shared.company[leader] == leader and shared.robot_region[leader] == region
        if crew[leader] != NOBODY or not is_there:
            continue
        use = waste = 0
        for cap in range(len(demand)):
            useful = min(brings[leader, cap], max(demand[cap] - have[cap], 0))
            use += useful
            waste += brings[leader, cap] - useful
        if use > best_use or (use == best_use and use > 0 and waste < best_waste):
            best, best_use, best_waste = leader, use, waste
    return best


@allocating_kernel
def merge_where_needed(shared: Shared, crew: Array) -> Array:
    """Merge crews until each task can be done by one; return who can do what, (crews, tasks)."""
    is_able = _who_can(shared, crew)
    for task in range(len(shared.needs)):
        if not _can_any(is_able, task):
            _merge_for(shared, crew, task)
            is_able = _who_can(shared, crew)
    return is_able


@kernel
def _can_any(is_able: Array, task: int) -> bool:
    for number in range(len(is_able)):
        if is_able[number, task]:
            return True
    return False


@allocating_kernel
def _who_can(shared: Shared, crew: Array) -> Array:
    """Return which crew can do which task, (crews, tasks)."""
    has, region = _sum_up(shared, crew)
    is_able = np.zeros((len(has), len(shared.needs)), dtype=np.bool_)
    for number in range(len(has)):
        for task in range(len(shared.needs)):
            is_near = region[number] == shared.task_region[task]
            is_able[number, task] = is_near and covers(has[number], shared.needs[task])
    return is_able


@allocating_kernel
def _sum_up(shared: Shared, crew: Array) -> tuple[Any, Any]:
    """Return what each crew has, (crews, caps), and its region, NOBODY for one without robots."""
    crews = count_crews(crew)
    has = np.zeros((crews, shared.needs.shape[1]), dtype=np.int64)
    region = np.empty(crews, dtype=np.int64)
    for number in range(crews):
        region[number] = NOBODY
    for robot in range(len(crew)):
        _add(shared.counts[robot], has[crew[robot]])
        region[crew[robot]] = shared.robot_region[robot]
    return has, region


@allocating_kernel
def _merge_for(shared: Shared, crew: Array, task: int) -> None:
    """Merge the crews that bring most of what a task needs until they have all of it."""
    has, region = _sum_up(shared, crew)
    union = np.zeros(has.shape[1], dtype=np.int64)
    first = NOBODY
    while not covers(union, shared.needs[task]):
        best, best_use = NOBODY, 0
        for number in range(len(has)):
            if region[number] == shared.task_region[task]:
                use = _use(union, has[number], shared.needs[task])
                if use > best_use:
                    best, best_use = number, use
        assert best != NOBODY  # a task that cannot be done has ended the trial
        first = best if first == NOBODY else first
        region[best] = NOBODY
        _add(has[best], union)
        for robot in range(len(crew)):
            if crew[robot] == best:
                crew[robot] = first


@kernel
def _use(union: Array, has: Array, need: Array) -> int:
    use = 0
    for cap in range(len(need)):
        use += min(has[cap], max(need[cap] - union[cap], 0))
    return use
