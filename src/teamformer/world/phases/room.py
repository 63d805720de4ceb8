"""Room in zones: what is taken of it in a step, by services and by those that have their turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def count_services(world: World) -> None:
    """Let the services that are under way take room in their zones, and nothing else."""
    for zone in range(len(world.zones)):
        world.zones[zone].taken = 0
        for task in range(world.rules.tasks):
            is_served = world.tasks[task].is_open and world.tasks[task].server != NOBODY
            world.zones[zone].taken += world.inside[zone, task] and is_served


@kernel
def has_room(world: World, task: int) -> bool:
    """Say whether all zones of a task have room for one more."""
    for zone in range(len(world.zones)):
        if world.inside[zone, task] and world.zones[zone].taken >= world.zones[zone].room:
            return False
    return True


@kernel
def take_room(world: World, task: int) -> None:
    """Let a task take room in all its zones."""
    for zone in range(len(world.zones)):
        world.zones[zone].taken += world.inside[zone, task]
