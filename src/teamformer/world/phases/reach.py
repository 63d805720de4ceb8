"""Who flies over walls gets to tasks that a team with others cannot get to: who may be one team.

docs/explanation/nothing-blocks.md has the rules.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.motion import is_way
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.coverage import helps
from teamformer.world.state.arrays import ANYWHERE
from teamformer.world.state.spatial_index import stands_at

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def any_fly(world: World) -> bool:
    """Say whether some robots get to places that others cannot get to."""
    for robot in range(world.rules.robots):
        if world.robots[robot].region == ANYWHERE:
            return bool(world.rules.has_walls)
    return False


@kernel
def has_to_part(world: World, team: int) -> bool:
    """Say whether a team keeps a robot that flies over walls from a task that needs it.

    Where it stands at its assignment, only tasks before that in the order count.
    """
    if world.teams[team].serves > 0 or not _has_flyers(world, team):
        return False
    first = _place_in_order(world, team, team)
    return _is_held_back(world, team, world.teams[team].region, first)


@kernel
def can_go_with(world: World, team: int, other: int) -> bool:
    """Say whether the union of two teams in the same place would not have to part."""
    region = max(world.teams[team].region, world.teams[other].region)
    if region == ANYWHERE:
        return True
    first = _place_in_order(world, team, other)
    return not (
        _is_held_back(world, team, region, first) or _is_held_back(world, other, region, first)
    )


@kernel
def _place_in_order(world: World, team: int, other: int) -> int:
    """Return the place of the task that two teams are assigned to and stand at, else of none."""
    task = world.teams[team].task
    if task == NOBODY or task != world.teams[other].task or not world.tasks[task].is_open:
        return int(world.count.open)
    if not (stands_at(world, team, task) and stands_at(world, other, task)):
        return int(world.count.open)
    return int(world.tasks[task].rank)


@kernel
def _is_held_back(world: World, team: int, region: int, first: int) -> bool:
    """Say whether one of the first tasks needs who flies in a team, but is not in its region."""
    if region == ANYWHERE or not _has_flyers(world, team):
        return False
    for position in range(first):
        task = world.order[position]
        if is_way(region, world.tasks[task].region):
            continue
        for robot in range(team, world.rules.robots):
            if world.robots[robot].team != team or world.robots[robot].region != ANYWHERE:
                continue
            if helps(world.brings[robot], world.needs[task]):
                return True
    return False


@kernel
def _has_flyers(world: World, team: int) -> bool:
    for robot in range(team, world.rules.robots):
        if world.robots[robot].team == team and world.robots[robot].region == ANYWHERE:
            return True
    return False
