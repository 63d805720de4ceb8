"""The critic: sees every team and every open task of a world; used in training only."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn


@dataclass(frozen=True)
class CriticSettings:
    """Sizes of the critic; the features are those of `train.learning.global_state`."""

    team_features: int
    task_features: int
    world_features: int
    is_per_team: bool = False  # one value for each team instead of one for the world
    width: int = 64


class Critic(nn.Module):
    """Values worlds, or each of their teams, from all teams and tasks."""

    def __init__(self, settings: CriticSettings) -> None:
        super().__init__()
        d = settings.width
        self.is_per_team = settings.is_per_team
        self.team_in = nn.Sequential(nn.Linear(settings.team_features, d), nn.ReLU())
        self.task_in = nn.Sequential(nn.Linear(settings.task_features, d), nn.ReLU())
        self.out = nn.Sequential(
            nn.Linear((4 + self.is_per_team) * d + settings.world_features, d),
            nn.ReLU(),
            nn.Linear(d, d),
            nn.ReLU(),
            nn.Linear(d, 1),
        )

    def forward(
        self, teams: Tensor, is_team: Tensor, tasks: Tensor, is_task: Tensor, world: Tensor
    ) -> Tensor:
        """Return values as (worlds, 1), or as (worlds, teams) with zeros for padding.

        `teams` (worlds, teams, features), `tasks` (worlds, tasks, features), `world` (worlds,
        features); padding is False in `is_team` and `is_task`.
        """
        each = self.team_in(teams[is_team])  # (all teams, d)
        parts = [
            *_pools(each, is_team),
            *_pools(self.task_in(tasks[is_task]), is_task),
            world,
        ]
        around = torch.cat(parts, dim=-1)  # (worlds, 4 d + features)
        if not self.is_per_team:
            of_worlds: Tensor = self.out(around)
            return of_worlds
        of_world = around[is_team.nonzero()[:, 0]]  # (all teams, 4 d + features)
        values = self.out(torch.cat([each, of_world], dim=-1)).squeeze(-1)  # (all teams,)
        spread: Tensor = values.new_zeros(is_team.shape).masked_scatter(is_team, values)
        return spread


def _pools(tokens: Tensor, is_there: Tensor) -> tuple[Tensor, Tensor]:
    """Return mean and maximum of each world's tokens, given without padding; each (worlds, d).

    Most of a batch is padding where a few worlds have many teams, so nothing is computed for it.
    """
    world = is_there.nonzero()[:, 0]  # (tokens,)
    none = tokens.new_zeros(len(is_there), tokens.shape[1])  # (worlds, d)
    count = is_there.sum(dim=1, keepdim=True).clamp(min=1)  # (worlds, 1)
    most = none.scatter_reduce(0, world.unsqueeze(1).expand_as(tokens), tokens, "amax")
    return none.index_add(0, world, tokens) / count, most
