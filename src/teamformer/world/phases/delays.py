"""Steps in which robots stand still: delays, drawn from a seed of the truth, and between shifts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.rules.chance import fraction, next_state
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.shifts import is_within_shift

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def delay_teams(world: World) -> None:
    """Say which teams stand still in this step: those of which one robot does at least.

    Every robot draws in every step, wherever it is.
    """
    for team in range(world.rules.robots):
        world.teams[team].is_delayed = False
    for robot in range(world.rules.robots):
        state = next_state(world.robots[robot].luck)
        world.robots[robot].luck = state
        team = world.robots[robot].team
        if team != NOBODY and fraction(state) < world.robots[robot].delay:
            world.teams[team].is_delayed = True
    if world.rules.has_shifts:
        for robot in range(world.rules.robots):
            team = world.robots[robot].team
            if team != NOBODY and is_robot_off(world, robot):
                world.teams[team].is_delayed = True


@kernel
def chance_of_delay(world: World, team: int) -> float:
    """Return with what probability a team stands still in a step."""
    walks = 1.0
    if world.rules.has_delays:
        for robot in range(team, world.rules.robots):
            if world.robots[robot].team == team:
                walks *= 1.0 - world.robots[robot].delay
    return 1.0 - walks


@kernel
def is_in_shift(world: World, team: int, begin: int, end: int) -> bool:
    """Say whether one shift of each robot of a team has the time between two numbers of steps."""
    if world.rules.has_shifts:
        for robot in range(team, world.rules.robots):
            if world.robots[robot].team == team:
                every = world.robots[robot].every
                if not is_within_shift(world.shifts[robot], every, begin, end):
                    return False
    return True


@kernel
def may_join(world: World, team: int) -> bool:
    """Say whether a team serves and charges nothing, and all its robots are in their shifts."""
    is_free = world.teams[team].serves == 0 and world.teams[team].charger == NOBODY
    return bool(is_free) and not is_off(world, team)


@kernel
def is_off(world: World, team: int) -> bool:
    """Say whether a robot of a team is outside its shifts in the step that is made next, or now."""
    steps = world.count.steps
    return not is_in_shift(world, team, steps, steps + 1)


@kernel
def is_robot_off(world: World, robot: int) -> bool:
    """Say whether a robot is outside its shifts in the step that is made next, or now."""
    if not world.rules.has_shifts:
        return False
    steps, every = world.count.steps, world.robots[robot].every
    return not is_within_shift(world.shifts[robot], every, steps, steps + 1)
