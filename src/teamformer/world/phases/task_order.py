"""The shared task order: which tasks are in it, and, without a coordinator, how they are ordered.

It is made at the start and again when tasks appear, alike by every robot. It rests only on what
everybody knows: the fleet list, the open tasks, who did the others when.
"""

from __future__ import annotations

import numpy as np

from teamformer.base.kernels.jit import allocating_kernel, entry, kernel
from teamformer.world.phases.motion import travel, travel_between
from teamformer.world.rules.constants import NEVER, NOBODY
from teamformer.world.rules.tour import UNLINKED, plan_tour
from teamformer.world.state.arrays import APPEARED, NEAREST, RUNNING, World, Worlds, world_at


@kernel
def release_tasks(world: World, steps_made: int) -> bool:
    """Make known the tasks that appear now; say whether the order has new ones, at its end."""
    arrived = 0
    for task in range(world.rules.tasks):
        is_due = world.tasks[task].appears == steps_made
        is_over = world.tasks[task].cancelled <= steps_made
        if is_due and not is_over and world.tasks[task].missed_at == NOBODY:
            world.tasks[task].is_open = True
            for cap in range(world.has.shape[1]):
                world.demand[cap] += world.needs[task, cap] > 0
        if world.tasks[task].is_open and _ordered_at(world, task) == steps_made:
            world.tasks[task].ordered_at = steps_made
            world.order[world.count.open] = task
            world.count.open += 1
            arrived += 1
    world.count.arrived = arrived
    if arrived > 0:
        world.count.news |= APPEARED
    return arrived > 0


@kernel
def _ordered_at(world: World, task: int) -> int:
    """Return how many steps are made when a task gets its place in the order.

    Coordinators share out what is known, the paper's allocator what may begin.
    """
    appears = world.tasks[task].appears
    if world.rules.is_coordinated:
        return appears
    return NEVER if world.tasks[task].awaits else max(appears, world.tasks[task].opens)


@kernel
def close_gaps_in_order(world: World) -> None:
    """Take the tasks that are over out of the order."""
    kept = 0
    for position in range(world.count.open):
        task = world.order[position]
        if world.tasks[task].is_open:
            world.order[kept] = task
            world.tasks[task].rank = kept
            kept += 1
    world.count.open = kept


@entry
def order_worlds(worlds: Worlds) -> None:
    """Bring the order up to date in every world that goes on without a coordinator."""
    for w in range(len(worlds.rules)):
        world = world_at(worlds, w)
        has_order = not world.rules.is_coordinated
        if world.count.status == RUNNING and has_order and world.count.arrived > 0:
            _order_arrived(world)
            world.count.arrived = 0


@allocating_kernel
def _order_arrived(world: World) -> None:
    """Give the tasks that have arrived a place in the tour, or make a new one."""
    if world.rules.new_tasks == NEAREST and world.count.arrived < world.count.open:
        _insert_after_nearest(world)
    else:
        _solve_anew(world)
    for position in range(world.count.open):
        world.tasks[world.order[position]].rank = position
    world.count.orders += 1


@allocating_kernel
def _solve_anew(world: World) -> None:
    """Order the open tasks by a tour from the latest one done, at first from the centroid."""
    x, y = world.rules.start_x, world.rules.start_y
    latest = 0
    for task in range(world.rules.tasks):
        if world.tasks[task].done_at > latest:
            latest = world.tasks[task].done_at
            x, y = world.tasks[task].x, world.tasks[task].y
    tasks = np.sort(world.order[: world.count.open])
    from_start = np.empty(len(tasks), dtype=np.int64)
    between = np.zeros((len(tasks), len(tasks)), dtype=np.int64)
    for i in range(len(tasks)):
        from_start[i] = travel(world, x, y, tasks[i], False)
        for j in range(i):
            between[i, j] = between[j, i] = travel_between(world, tasks[i], tasks[j], False)
    for position, chosen in enumerate(plan_tour(between, from_start)):
        world.order[position] = tasks[chosen]


@kernel
def _insert_after_nearest(world: World) -> None:
    """Put each new task right after the nearest task in the order, the first of equals."""
    count = world.count.open
    for arrived in range(count - world.count.arrived, count):
        task = world.order[arrived]
        nearest, nearest_away = NOBODY, UNLINKED
        for position in range(arrived):
            away = travel_between(world, task, world.order[position], False)
            if away < nearest_away:
                nearest, nearest_away = position, away
        for position in range(arrived, nearest + 1, -1):
            world.order[position] = world.order[position - 1]
        world.order[nearest + 1] = task
