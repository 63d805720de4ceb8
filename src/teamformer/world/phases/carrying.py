"""Carrying: loads are taken up, walk with their team, and are unloaded or set down on the way.

While a load is carried, `world.tasks` has it where it is brought to: so its team walks there as to
any task.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.world.phases.room import note_zones
from teamformer.world.rules.constants import NEVER, NOBODY, ROUNDING
from teamformer.world.state.task_places import change_cell, put_task

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def is_carrying(world: World, team: int) -> bool:
    """Say whether a team carries a load, or unloads it."""
    task = world.teams[team].task
    if task == NOBODY or not world.tasks[task].is_carried:
        return False
    return bool(world.tasks[task].server == team)


@kernel
def is_delivered(world: World, team: int, task: int, step: int) -> bool:
    """Say whether a team that carries a load has been long enough where it is brought to.

    `served` counts the steps at whose ends it stands there, the one of its arrival too; in a zone
    those since it has room, for which it waits.
    """
    if not _is_there(world, team, task):
        world.tasks[task].served = 0
    elif world.tasks[task].is_brought_to_zone and not world.tasks[task].is_unloading:
        world.tasks[task].served = 0
        if world.tasks[task].came_at == NOBODY:
            world.tasks[task].came_at = step
    return bool(world.tasks[task].served > world.tasks[task].unload)


@kernel
def expect_arrival(world: World, team: int, task: int) -> None:
    """Write down how many steps of carrying and unloading a load are ahead of its team."""
    ahead = world.tasks[task].unload
    if not _is_there(world, team, task):
        ahead += _steps_to_go(world, team, task, world.teams[team].credit)
    elif world.tasks[task].is_carried:
        ahead += 1 - world.tasks[task].served
    world.tasks[task].ahead = ahead


@kernel
def carried_for(world: World, team: int, task: int) -> int:
    """Return how many steps a team that takes up a load carries and unloads it."""
    unload = world.tasks[task].unload
    if _is_there(world, team, task):
        return int(unload)
    return int(unload + _steps_to_go(world, team, task, 0.0))


@kernel
def carries_in_time(world: World, team: int, task: int, step: int) -> bool:
    """Say whether a team that begins with a load in a step is done with it by the end of all."""
    if world.rules.until == NEVER:
        return True
    takes = world.tasks[task].duration + carried_for(world, team, task)
    return bool(step + takes <= world.rules.until)


@kernel
def _is_there(world: World, team: int, task: int) -> bool:
    away_x = world.teams[team].x - world.tasks[task].to_x
    away_y = world.teams[team].y - world.tasks[task].to_y
    return bool(away_x * away_x + away_y * away_y <= world.rules.arrival_radius**2)


@kernel
def _steps_to_go(world: World, team: int, task: int, credit: float) -> int:
    x, y = world.teams[team].x, world.teams[team].y
    away_x, away_y = abs(world.tasks[task].to_x - x), abs(world.tasks[task].to_y - y)
    if world.rules.is_plane:
        to_go = np.sqrt(away_x * away_x + away_y * away_y) - world.rules.arrival_radius
    elif world.rules.has_walls:
        to_go = np.float64(world.fields[len(world.tasks) + task, int(y), int(x)])
    else:
        to_go = away_x + away_y
    to_go -= credit
    return int(np.ceil(to_go / world.teams[team].pace - ROUNDING))


@kernel
def note_place(world: World, task: int, x: float, y: float) -> None:
    """Remember where the load that a team has just let go of lies."""
    world.tasks[task].lies_x, world.tasks[task].lies_y = x, y


@allocating_kernel
def place_loads(world: World, step: int) -> None:
    """At the end of a step: what was taken up is headed for where it goes, what was let go of lies.

    So a load that was set down can be taken up again in the next step.
    """
    for position in range(world.count.open):
        task = world.order[position]
        if not world.tasks[task].is_carried:
            continue
        if world.tasks[task].server == NOBODY:
            world.tasks[task].is_carried = False
            world.tasks[task].left_at = step
            world.tasks[task].is_unloading, world.tasks[task].came_at = False, NOBODY
            put_task(world, task, world.tasks[task].lies_x, world.tasks[task].lies_y)
            if len(world.zones) > 0:
                note_zones(world, task)
        elif world.tasks[task].taken_at == step:
            change_cell(world, task, world.tasks[task].to_x, world.tasks[task].to_y)
            if world.rules.has_walls:
                for row in range(world.fields.shape[1]):
                    for column in range(world.fields.shape[2]):
                        there = world.fields[len(world.tasks) + task, row, column]
                        world.fields[task, row, column] = there
