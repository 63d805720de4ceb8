"""What robots with batteries have left: what walking, serving and waiting take of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.carrying import is_carrying
from teamformer.world.phases.delays import is_robot_off
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.spatial_index import stands_at

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World

SHORT = 1e-9
"""By such a share of a full battery what is left may be short of what is wanted."""

DRY = 1e-5
"""A robot has run dry that lacks such a share of a full battery: places are rounded."""


def dry_robots(robots: Array) -> set[int]:
    """Return the robots that have run dry, by number; `robots` are their (robots,) records."""
    return {int(robot) for robot in np.flatnonzero(robots["left"] < -DRY * robots["lasts"])}


@kernel
def spend_walking(world: World, team: int, length: float) -> None:
    """Let a team have walked so many cells or metres; each takes what it would take alone."""
    if not world.rules.has_batteries or length == 0:
        return
    world.teams[team].has_walked = True
    for robot in range(team, world.rules.robots):
        if world.robots[robot].team == team and world.robots[robot].lasts > 0:
            world.robots[robot].left -= length / world.robots[robot].pace


@kernel
def spend_standing(world: World) -> None:
    """At the end of motion: what serving takes, unloading too, and waiting at a task."""
    for robot in range(world.rules.robots):
        team = world.robots[robot].team
        if team == NOBODY or world.robots[robot].lasts == 0 or world.teams[team].has_walked:
            continue
        if world.teams[team].serves > 0:
            is_on_the_way = world.rules.has_loads and is_carrying(world, team)
            if is_on_the_way and world.tasks[world.teams[team].task].came_at != NOBODY:
                world.robots[robot].left -= world.robots[robot].waiting
            elif not is_on_the_way or stands_at(world, team, world.teams[team].task):
                world.robots[robot].left -= world.robots[robot].serving
        elif _waits(world, team) and not is_robot_off(world, robot):
            world.robots[robot].left -= world.robots[robot].waiting


@kernel
def _waits(world: World, team: int) -> bool:
    """Say whether a team that does nothing stands at its task."""
    task = world.teams[team].task
    if task == NOBODY or world.teams[team].charger != NOBODY:
        return False
    return stands_at(world, team, task)


@kernel
def is_dry(world: World, robot: int) -> bool:
    """Say whether a robot has run dry."""
    lasts = world.robots[robot].lasts
    return bool(world.rules.has_batteries and world.robots[robot].left < -DRY * lasts)


@kernel
def has_enough(world: World, team: int, task: int) -> bool:
    """Say whether all robots of a team can do a task where they are, and then get to a charger."""
    if world.rules.has_batteries:
        for robot in range(team, world.rules.robots):
            lasts = world.robots[robot].lasts
            is_short = world.robots[robot].left + SHORT * lasts < world.wanted[robot, task]
            if is_short and lasts > 0 and world.robots[robot].team == team:
                return False
    return True
