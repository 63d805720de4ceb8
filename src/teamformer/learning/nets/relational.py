"""The network for any fleet: tokens in relations, whole choices scored at once.

The choices are those of `policies.learned.macro_actions`. Nothing is tied to a capability, so one
set of weights serves any number of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor, nn

from teamformer.learning.nets.actor import REFUSED, OneChoice


class RelationTokens(NamedTuple):
    """What the network sees of each deciding team; padding is False in `is_team` and `is_task`."""

    own: Tensor  # (teams, own features)
    teams: Tensor  # (teams, seen, team features)
    tasks: Tensor  # (teams, tasks, task features)
    is_team: Tensor  # (teams, seen) bool
    is_task: Tensor  # (teams, tasks) bool
    is_legal: Tensor  # (teams, choices) bool


@dataclass(frozen=True)
class RelationalSettings:
    """Sizes of the network; the features are those of `policies.learned.relational_features`."""

    own_features: int
    team_features: int
    task_features: int
    own_choices: int = 4  # follow the script, maintain, halve, shed
    width: int = 48
    first_scores: tuple[float, ...] = (4.0, 2.0, 0.0, 0.0)  # of the own choices, untrained


class RelationalPolicy(OneChoice):
    """Scores every choice of every team, as (teams, choices); illegal ones are refused.

    Untrained it mostly follows the script, seldom keeps apart or joins others, and hardly ever
    splits, which costs a step and pays only if those who part keep apart.
    """

    def __init__(self, settings: RelationalSettings) -> None:
        super().__init__()
        d = settings.width
        self.settings = settings
        self.own_in = _two_layers(settings.own_features, d)
        self.team_in = _two_layers(settings.team_features, d)
        self.task_in = _two_layers(settings.task_features, d)
        self.context = _two_layers(5 * d, d)
        self.team_out = _Beside(d)
        self.task_out = _Beside(d)
        self.own_score = _score(2 * d, settings.own_choices)
        self.join_score = _score(d, 1)
        self.split_score = _score(d, 1)
        with torch.no_grad():
            self.own_score.bias.copy_(torch.tensor(settings.first_scores))

    def forward(self, *parts: Tensor) -> Tensor:
        """Return the scores of all choices: the own team's, then joins, then splits."""
        tokens = RelationTokens(*parts)
        own = self.own_in(tokens.own)  # (teams, d)
        teams = self.team_in(tokens.teams)  # (teams, seen, d)
        tasks = self.task_in(tokens.tasks)  # (teams, tasks, d)
        pools = [*_pools(teams, tokens.is_team), *_pools(tasks, tokens.is_task)]
        context = self.context(torch.cat([own, *pools], dim=-1))  # (teams, d)
        around = torch.cat([own, context], dim=-1)  # (teams, 2 d)
        join = self.join_score(self.team_out(teams, around)).squeeze(-1)  # (teams, seen)
        split = self.split_score(self.task_out(tasks, around)).squeeze(-1)  # (teams, tasks)
        scores = torch.cat([self.own_score(around), join, split], dim=-1)  # (teams, choices)
        return scores.masked_fill(~tokens.is_legal, REFUSED)


class _Beside(nn.Module):
    """Two layers on each token with what is around it beside it, as (teams, tokens, d)."""

    def __init__(self, d: int) -> None:
        super().__init__()
        self.of_token = nn.Linear(d, d)
        self.of_around = nn.Linear(2 * d, d, bias=False)
        self.out = nn.Linear(d, d)

    def forward(self, tokens: Tensor, around: Tensor) -> Tensor:
        hidden = torch.relu(self.of_token(tokens) + self.of_around(around).unsqueeze(1))
        return torch.relu(self.out(hidden))


def _two_layers(size: int, width: int) -> nn.Sequential:
    return nn.Sequential(nn.Linear(size, width), nn.ReLU(), nn.Linear(width, width), nn.ReLU())


def _score(size: int, choices: int) -> nn.Linear:
    score = nn.Linear(size, choices)
    nn.init.normal_(score.weight, std=0.01)
    nn.init.zeros_(score.bias)
    return score


def _pools(tokens: Tensor, is_there: Tensor) -> tuple[Tensor, Tensor]:
    """Return mean and maximum over the tokens that are there, each (teams, d)."""
    there = is_there.unsqueeze(-1).to(tokens.dtype)  # (teams, tokens, 1)
    count = there.sum(dim=1).clamp(min=1.0)  # (teams, 1)
    there_only = tokens * there  # tokens are not negative, so that zero is a fair maximum of none
    return there_only.sum(dim=1) / count, there_only.amax(dim=1)
