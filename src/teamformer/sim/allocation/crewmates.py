"""Which teams are of the same crew or coalition; where there are none, all are."""

from __future__ import annotations

from teamformer.jit import kernel
from teamformer.rules.constants import NOBODY
from teamformer.sim.arrays import CREWS, MIXED, PLAN, World


@kernel
def name_crews(world: World) -> None:
    """Write down each team's crew: that of all its robots, or MIXED."""
    for team in range(world.rules.robots):
        world.teams[team].crew = world.robots[team].crew
    for robot in range(world.rules.robots):
        team = world.robots[robot].team
        if team != NOBODY and world.robots[robot].crew != world.teams[team].crew:
            world.teams[team].crew = MIXED


@kernel
def are_mates(world: World, team: int, other: int) -> bool:
    """Say whether some robot of a team is in the crew of some robot of another one.

    By a shared plan those are mates that have the same task next. Crews must have been named since
    teams or crews changed.
    """
    if world.rules.allocation == PLAN:
        task = world.teams[team].next
        return task != NOBODY and task == world.teams[other].next
    if world.rules.allocation != CREWS:
        return True
    if world.teams[team].crew != MIXED and world.teams[other].crew != MIXED:
        return world.teams[team].crew == world.teams[other].crew
    for robot in range(world.rules.robots):
        if world.robots[robot].team == team and _has_one_of(world, other, world.robots[robot].crew):
            return True
    return False


@kernel
def _has_one_of(world: World, team: int, crew: int) -> bool:
    for robot in range(world.rules.robots):
        if world.robots[robot].team == team and world.robots[robot].crew == crew:
            return True
    return False
