"""Room in zones: what is taken of it in a step, by services and by those that have their turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import INSIDE, NAMED, UNLOADS

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def count_services(world: World) -> None:
    """Let the services that are under way take room in their zones, and nothing else."""
    for zone in range(len(world.zones)):
        world.zones[zone].taken = 0
        for task in range(world.rules.tasks):
            if not world.tasks[task].is_open or world.tasks[task].server == NOBODY:
                continue
            if world.tasks[task].is_unloading:
                world.zones[zone].taken += (world.inside[zone, task] & UNLOADS) > 0
            elif not world.tasks[task].is_carried:
                world.zones[zone].taken += (world.inside[zone, task] & INSIDE) > 0


@kernel
def has_room(world: World, task: int, how: int) -> bool:
    """Say whether all zones of a task have room for one more; `how` it is in: INSIDE or UNLOADS."""
    for zone in range(len(world.zones)):
        is_full = world.zones[zone].taken >= world.zones[zone].room
        if world.inside[zone, task] & how > 0 and is_full:
            return False
    return True


@kernel
def take_room(world: World, task: int, how: int) -> None:
    """Let a task take room in all these zones."""
    for zone in range(len(world.zones)):
        world.zones[zone].taken += (world.inside[zone, task] & how) > 0


@kernel
def next_in_queue(world: World, came: int, after: int) -> int:
    """Return the load that waits for room to be unloaded next to one that came in a step.

    Of two that came in one step it is the one with the lower number; NOBODY if it is the last.
    """
    found = NOBODY
    for task in range(world.rules.tasks):
        since = world.tasks[task].came_at
        if since == NOBODY or world.tasks[task].server == NOBODY:
            continue
        is_next = since > came or (since == came and task > after)
        if is_next and (found == NOBODY or since < world.tasks[found].came_at):
            found = task
    return found


@kernel
def note_zones(world: World, task: int) -> None:
    """Let a load that was set down be in the zones of the place where it lies."""
    x, y, inside = world.tasks[task].x, world.tasks[task].y, world.inside
    for zone in range(len(world.zones)):
        is_named = inside[zone, task] & NAMED > 0
        inside[zone, task] = inside[zone, task] & (UNLOADS | NAMED) | (INSIDE if is_named else 0)
        world.tasks[task].is_in_zone = False
    for row in range(len(world.areas)):
        area = world.areas[row]
        if area.zone != NOBODY and area.left <= x <= area.right and area.low <= y <= area.high:
            inside[area.zone, task] |= INSIDE
    for zone in range(len(world.zones)):
        world.tasks[task].is_in_zone |= inside[zone, task] & INSIDE > 0
