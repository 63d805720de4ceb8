"""Losses: robots that count for nothing from a step on, and those that come back."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.energy import is_dry
from teamformer.world.phases.formation import add_robot, clear_slot
from teamformer.world.rules.constants import NEVER, NOBODY
from teamformer.world.state.arrays import BACK, LOST

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def lose_robots(world: World, step: int) -> bool:
    """Take the robots that are lost or dry in this step out of their teams; say whether any was."""
    any_lost = False
    for robot in range(world.rules.robots):
        world.robots[robot].formed = world.robots[robot].team
    for robot in range(world.rules.robots):
        if world.robots[robot].team == NOBODY:
            continue
        if is_dry(world, robot):  # it stands still for good
            world.robots[robot].lost, world.robots[robot].back = step, NEVER
        if world.robots[robot].lost == step:
            any_lost = True
            world.count.news |= LOST
            team = world.robots[robot].team
            world.robots[robot].x, world.robots[robot].y = world.teams[team].x, world.teams[team].y
            _take_out(world, robot)
    return any_lost


@kernel
def return_robots(world: World, step: int) -> bool:
    """Let the robots that are back in this step be teams of their own; say whether any is.

    Each stands where it was lost, and everybody knows.
    """
    any_back = False
    for robot in range(world.rules.robots):
        if world.robots[robot].back == step and world.robots[robot].team == NOBODY:
            any_back = True
            world.count.news |= BACK
            clear_slot(world, robot)
            add_robot(world, robot, robot)
            world.teams[robot].x = world.robots[robot].x
            world.teams[robot].y = world.robots[robot].y
            world.teams[robot].pursued = NOBODY
            _look_ahead(world, robot, step)
    return any_back


@kernel
def _look_ahead(world: World, robot: int, step: int) -> None:
    """Note when a robot that is back is lost next, if it is."""
    for time in range(world.absences.shape[1]):
        if world.absences[robot, time, 0] > step:
            world.robots[robot].lost = world.absences[robot, time, 0]
            world.robots[robot].back = world.absences[robot, time, 1]
            return


@kernel
def _take_out(world: World, robot: int) -> None:
    """Found the robot's team anew without it, at its new lowest robot; keep all else."""
    old = world.robots[robot].team
    world.robots[robot].team = NOBODY
    slot = NOBODY
    for member in range(old, world.rules.robots):
        if world.robots[member].team == old:
            slot = member
            break
    team = world.teams[old]
    x, y, credit, serves = team.x, team.y, team.credit, team.serves
    task, is_detour, pursued = team.task, team.is_detour, team.pursued
    charger, charges_for = team.charger, team.charges_for
    clear_slot(world, old)
    if slot != NOBODY:
        clear_slot(world, slot)
        world.teams[slot].x, world.teams[slot].y = x, y
        for member in range(slot, world.rules.robots):
            if world.robots[member].team == old:
                add_robot(world, slot, member)
        world.teams[slot].task, world.teams[slot].is_detour = task, is_detour
        world.teams[slot].serves, world.teams[slot].credit = serves, credit
        world.teams[slot].pursued = pursued
        world.teams[slot].charger, world.teams[slot].charges_for = charger, charges_for
    for served in range(world.rules.tasks):
        if world.tasks[served].server == old:
            world.tasks[served].server = slot
            world.tasks[served].lies_x, world.tasks[served].lies_y = x, y
