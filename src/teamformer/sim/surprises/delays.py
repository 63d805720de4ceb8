"""Delays: steps in which robots stand still, drawn from a seed that is part of the truth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.jit import kernel
from teamformer.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.sim.arrays import World


def first_luck(seed: int) -> np.uint64:
    """Return the first state of a robot's random numbers."""
    return np.uint64((seed * 2654435769 + 88172645463325252) % 2**64)


@kernel
def delay_teams(world: World) -> None:
    """Say which teams stand still in this step: those of which one robot does at least.

    Every robot draws in every step, wherever it is (xorshift64, Marsaglia 2003).
    """
    for team in range(world.rules.robots):
        world.teams[team].is_delayed = False
    for robot in range(world.rules.robots):
        state = world.robots[robot].luck
        state ^= state << np.uint64(13)
        state ^= state >> np.uint64(7)
        state ^= state << np.uint64(17)
        world.robots[robot].luck = state
        is_still = np.float64(state >> np.uint64(11)) / 9007199254740992.0
        team = world.robots[robot].team
        if team != NOBODY and is_still < world.robots[robot].delay:
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
