"""Allocation: which task a team without an assignment heads for.

docs/explanation/order.md has the rules.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.motion import is_way, travel, travel_between
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.coverage import covers, helps
from teamformer.world.state.arrays import ANYWHERE, World
from teamformer.world.state.spatial_index import find_near


@kernel
def allocate_tasks(world: World, named: Array) -> None:
    """Phase 4, in slot order: tasks that decisions name, the plan's, or the allocator's.

    The part that leaves a team under command waits for its own decision.
    """
    if world.rules.is_coordinated:
        find_earliest_tasks(world)
    for team in range(world.rules.robots):
        world.teams[team].pursued = world.teams[team].task
        if world.teams[team].size == 0 or world.teams[team].serves > 0:
            continue
        if world.teams[team].is_commanded:
            row = world.teams[team].row
            world.teams[team].task = NOBODY if row == NOBODY else named[row]
            world.teams[team].is_detour = False
        elif world.rules.is_coordinated:
            world.teams[team].task = world.teams[team].next
            world.teams[team].is_detour = False
        elif world.teams[team].task == NOBODY and contributes_to_any(world, team):
            task, is_detour = choose_task(world, team)
            world.teams[team].task, world.teams[team].is_detour = task, is_detour
        world.teams[team].pursued = world.teams[team].task


@kernel
def find_earliest_tasks(world: World) -> None:
    """Find each team's task by its coordinator's plan: the earliest of its robots'."""
    for team in range(world.rules.robots):
        world.teams[team].next = NOBODY
    for robot in range(world.rules.robots):
        team, task = world.robots[robot].team, world.robots[robot].next
        if team != NOBODY and task != NOBODY:
            earliest = world.teams[team].next
            if earliest == NOBODY or world.tasks[task].rank < world.tasks[earliest].rank:
                world.teams[team].next = task


@kernel
def contributes_to_any(world: World, team: int) -> bool:
    """Say whether any open task needs something that the team has."""
    for cap in range(world.has.shape[1]):
        if world.has[team, cap] > 0 and world.demand[cap] > 0:
            return True
    return False


@kernel
def choose_task(world: World, team: int) -> tuple[Any, bool]:
    """Return the team's task by the shared order, and whether it is a detour.

    The first open task in the order that it can contribute to and that nearer teams it senses do
    not cover already, or a later one that it can do alone on a detour that shortens the tour.
    """
    near = find_near(world, team, world.rules.sensing_radius)
    for position in range(world.count.open):
        task = world.order[position]
        if contributes(world, team, task) and not is_covered(world, near, team, task):
            detour = _best_detour(world, near, team, position)
            if detour != NOBODY:
                return detour, True
            return task, False
    return np.int32(NOBODY), False


@kernel
def contributes(world: World, team: int, task: int) -> bool:
    """Say whether a team has something that a task needs, and a way to it."""
    return can_reach(world, team, task) and helps(world.has[team], world.needs[task])


@kernel
def can_reach(world: World, team: int, task: int) -> bool:
    """Say whether a way leads a team to a task."""
    return is_way(world.teams[team].region, world.tasks[task].region)


@kernel
def can_do_alone(world: World, team: int, task: int) -> bool:
    """Say whether a team has everything that a task needs."""
    return covers(world.has[team], world.needs[task])


@kernel
def is_covered(world: World, near: Array, team: int, task: int) -> bool:
    """Say whether the sensed teams that head for a task and are nearer to it need no help.

    Of two that are equally near, the lower slot counts as nearer.
    """
    away = np.int64(-1)
    helpers = 0  # the nearer ones are moved to the front of world.near
    for i in range(near):
        other = world.near[i]
        if world.teams[other].task != task:
            continue
        if away < 0:
            away = _way_of(world, team, task)
        other_away = _way_of(world, other, task)
        if other_away < away or (other_away == away and other < team):
            world.near[i], world.near[helpers] = world.near[helpers], other
            helpers += 1
    if helpers == 0:
        return False
    for cap in range(world.has.shape[1]):
        short = world.needs[task, cap]
        for i in range(helpers):
            short -= world.has[world.near[i], cap]
        if short > 0:
            return False
    return True


@kernel
def _way_of(world: World, team: int, task: int) -> np.int64:
    """Return the way of a team to a task."""
    flies = world.teams[team].region == ANYWHERE
    return travel(world, world.teams[team].x, world.teams[team].y, task, flies)


@kernel
def _best_detour(world: World, near: Array, team: int, position: int) -> Any:
    """Return the later task to do first, alone, that shortens the tour most; NOBODY if none does.

    The tour is the team's way to its next task and on through the order.
    """
    best, best_change = np.int32(NOBODY), np.int64(0)
    flies = world.teams[team].region == ANYWHERE
    following = world.order[position]
    direct = _way_of(world, team, following)
    count = world.count.open
    for later in range(position + 1, count):
        task = world.order[later]
        if not can_reach(world, team, task):
            continue
        if not can_do_alone(world, team, task):
            continue
        before = world.order[later - 1]
        change = _way_of(world, team, task) - direct
        change += travel_between(world, task, following, flies)
        change -= travel_between(world, before, task, flies)
        if later + 1 < count:
            after = world.order[later + 1]
            change += travel_between(world, before, after, flies)
            change -= travel_between(world, task, after, flies)
        if change < best_change and not is_covered(world, near, team, task):
            best, best_change = task, change
    return best
