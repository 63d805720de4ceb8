"""What training rewards, as streams: what the world earns, or what each robot's team earns.

A stream is a sum over time that never breaks off when teams merge or split. With the mission
reward a world has one stream. With the paper's team reward each robot has one: in every step it
earns what its team earns (eq. 1), whichever team that is then.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from teamformer.base.array_types import Array
from teamformer.world.env import TeamFormation
from teamformer.world.reward import Reward
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View


class TrainingReward(Protocol):
    """Turns what happened in a step into rewards (worlds, streams)."""

    @property
    def is_per_team(self) -> bool:
        """Say whether the critic gives a value to each team, not to the world."""
        ...

    @property
    def of_environment(self) -> Reward:
        """Return what the environment has to reward."""
        ...

    def values_of(self, env: TeamFormation) -> Array:
        """Return which of the critic's values each stream has now, as (worlds, streams)."""
        ...

    def earned(self, env: TeamFormation, done_before: Array) -> Array:
        """Return what each stream earned in the step just made, as (worlds, streams).

        `done_before` (worlds,) are the tasks that were done before it.
        """
        ...

    def share_of(self, view: View, rows: Array, streams: int) -> Array:
        """Return each deciding team's share of each stream of its world, as (rows, streams)."""
        ...


@dataclass(frozen=True)
class MissionReward:
    """What a world's teams earn together in a step."""

    step: float = -0.1
    done: float = 0.5  # for each task done

    @property
    def is_per_team(self) -> bool:
        """One value for the whole world."""
        return False

    @property
    def of_environment(self) -> Reward:
        """Nothing is asked of the environment's own reward."""
        return Reward()

    def values_of(self, env: TeamFormation) -> Array:
        """Return the world's only value, as (worlds, 1)."""
        return np.zeros((len(env.missions), 1), dtype=np.int64)

    def earned(self, env: TeamFormation, done_before: Array) -> Array:
        """Return the rewards as (worlds, 1)."""
        done = env.worlds.count["done"] - done_before
        earned: Array = (self.step + self.done * done)[:, None]
        return earned

    def share_of(self, view: View, rows: Array, streams: int) -> Array:
        """Return one: every team is credited with all that its world earns."""
        return np.ones((len(rows), 1), dtype=np.float32)


@dataclass(frozen=True)
class TeamReward:
    """Eq. 1 for each team, earned by each of its robots, scaled to what a critic learns well.

    A team's decision is credited with the mean over its robots.
    """

    done: float = 7.0  # alpha
    step: float = 2.0  # delta
    fit: float = 1.0  # beta
    scale: float = 0.05

    @property
    def is_per_team(self) -> bool:
        """A value for each team."""
        return True

    @property
    def of_environment(self) -> Reward:
        """Return eq. 1 with these weights."""
        return Reward(self.done, self.step, self.fit)

    def values_of(self, env: TeamFormation) -> Array:
        """Return the slot of each robot's team, NOBODY for robots that are lost or padding."""
        return np.array(env.worlds.robots["team"], dtype=np.int64)

    def earned(self, env: TeamFormation, done_before: Array) -> Array:
        """Return what each robot's present team earned, as (worlds, robots)."""
        slot = self.values_of(env)
        of_team = np.take_along_axis(env.rewards, np.maximum(slot, 0), axis=1)
        return np.where(slot == NOBODY, 0.0, self.scale * of_team)

    def share_of(self, view: View, rows: Array, streams: int) -> Array:
        """Return one over the team's size for its members, as (rows, robots)."""
        shares = np.zeros((len(rows), streams), dtype=np.float32)
        for i, row in enumerate(rows):
            members = view.member[view.first_member[row] : view.first_member[row + 1]]
            shares[i, members] = 1.0 / len(members)
        return shares
