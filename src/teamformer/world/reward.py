"""The reward of a team (eq. 1 of Boehme and Hollinger, "Teamformer", ICRA 2026)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@dataclass(frozen=True)
class Reward:
    """The weights of eq. 1.

    A team's reward for a step is `done` if it did a task in it and `-step` otherwise, plus `fit`
    times the share of its current task's requirements that it has, less what it has beyond them.
    """

    done: float = 7.0  # alpha
    step: float = 2.0  # delta
    fit: float = 1.0  # beta


@kernel
def reward_teams(world: World, weights: tuple[float, float, float], rewards: Array) -> None:
    """Write each team's reward of the step just made to `rewards` (robots,), by slot.

    The current task is the one pursued during the step; `weights` is (done, step, fit). Slots
    without a team get 0.
    """
    done, step, fit = weights
    for team in range(world.rules.robots):
        rewards[team] = -step if world.teams[team].size > 0 else 0.0
    for task in range(world.rules.tasks):
        if world.tasks[task].done_at == world.count.steps:
            rewards[world.tasks[task].done_by] = done
    for team in range(world.rules.robots):
        pursued = world.teams[team].pursued
        if world.teams[team].size > 0 and pursued != NOBODY:
            rewards[team] += fit * fit_to_task(world, team, pursued)


@kernel
def fit_to_task(world: World, team: int, task: int) -> float:
    """Return (|c+| - |c-|) / |q|: counts the task needs less counts it does not, over its needs."""
    useful = surplus = needed = 0
    for cap in range(world.has.shape[1]):
        have, need = world.has[team, cap], world.needs[task, cap]
        useful += min(have, need)
        surplus += max(have - need, 0)
        needed += need
    return (useful - surplus) / needed
