"""Delays: steps in which robots stand still, drawn from a seed that is part of the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.rules.chance import fraction, next_state
from teamformer.world.rules.constants import NOBODY

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


@kernel
def chance_of_delay(world: World, team: int) -> float:
    """Return with what probability a team stands still in a step."""
    walks = 1.0
    if world.rules.has_delays:
        for robot in range(team, world.rules.robots):
            if world.robots[robot].team == team:
                walks *= 1.0 - world.robots[robot].delay
    return 1.0 - walks
