"""The critic: sees every team and every open task of a world; used in training only."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn


@dataclass(frozen=True)
class CriticSettings:
    """Sizes of the critic; the features are those of `train.outlook`."""

    team_features: int
    task_features: int
    world_features: int
    width: int = 64


class Critic(nn.Module):
    """Values whole worlds from all their teams and tasks, as (worlds,)."""

    def __init__(self, settings: CriticSettings) -> None:
        super().__init__()
        d = settings.width
        self.team_in = nn.Sequential(nn.Linear(settings.team_features, d), nn.ReLU())
        self.task_in = nn.Sequential(nn.Linear(settings.task_features, d), nn.ReLU())
        self.out = nn.Sequential(
            nn.Linear(4 * d + settings.world_features, d),
            nn.ReLU(),
            nn.Linear(d, d),
            nn.ReLU(),
            nn.Linear(d, 1),
        )

    def forward(
        self, teams: Tensor, is_team: Tensor, tasks: Tensor, is_task: Tensor, world: Tensor
    ) -> Tensor:
        """Return the value of each world.

        `teams` (worlds, teams, features), `tasks` (worlds, tasks, features), `world` (worlds,
        features); padding is False in `is_team` and `is_task`.
        """
        teams = self.team_in(teams)  # (worlds, teams, d)
        tasks = self.task_in(tasks)  # (worlds, tasks, d)
        parts = [*_pools(teams, is_team), *_pools(tasks, is_task), world]
        value: Tensor = self.out(torch.cat(parts, dim=-1)).squeeze(-1)
        return value


def _pools(tokens: Tensor, is_there: Tensor) -> tuple[Tensor, Tensor]:
    """Return mean and maximum over the tokens that are there, each (worlds, d)."""
    there_only = tokens * is_there.unsqueeze(-1).to(tokens.dtype)  # (worlds, tokens, d)
    count = is_there.sum(dim=1, keepdim=True).clamp(min=1)  # (worlds, 1)
    return there_only.sum(dim=1) / count, there_only.amax(dim=1)
