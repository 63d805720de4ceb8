"""A deep set with attention, after Hsu et al., "Scalable Reinforcement Learning Policies for
Multi-Agent Control" (IROS 2021): each set of tokens is pooled by attention from the own team.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from teamformer.learning.nets.actor import REFUSED, OneChoice


@dataclass(frozen=True)
class CombinationSettings:
    """Sizes of a network over combinations, the deep set's and the graph network's."""

    team_features: int
    task_features: int
    actions: int
    width: int = 64
    heads: int = 4
    maintain_bias: float = 3.0  # the score that maintaining begins with


class DeepSet(OneChoice):
    """Scores every combination, as (teams, actions); illegal ones are refused."""

    def __init__(self, settings: CombinationSettings) -> None:
        super().__init__()
        d = settings.width
        self.own_in = _two_layers(settings.team_features, d)
        self.teams = _Pool(settings.team_features, d)
        self.tasks = _Pool(settings.task_features, d)
        self.out = score_layers(3 * d, settings)

    def forward(self, *parts: Tensor) -> Tensor:
        """Return the scores.

        Inputs are teams (teams, 1 + seen, features), the own one first, tasks (teams, tasks,
        features), which of both are there (False for padding) and what is legal (teams, actions).
        """
        teams, tasks, is_team, is_task, is_legal = parts
        own = self.own_in(teams[:, 0])  # (teams, d)
        pools = [self.teams(own, teams, is_team), self.tasks(own, tasks, is_task)]
        scores: Tensor = self.out(torch.cat([own, *pools], dim=-1))  # (teams, actions)
        return scores.masked_fill(~is_legal, REFUSED)


class _Pool(nn.Module):
    """One set, embedded token by token and added up with the own team's attention."""

    def __init__(self, features: int, d: int) -> None:
        super().__init__()
        self.embed = _two_layers(features, d)
        self.asks = nn.Linear(d, d)
        self.answers = nn.Linear(d, d)

    def forward(self, own: Tensor, tokens: Tensor, is_there: Tensor) -> Tensor:
        embedded = self.embed(tokens)  # (teams, tokens, d)
        match = (self.answers(embedded) * self.asks(own).unsqueeze(1)).sum(dim=-1)
        match = (match / own.shape[-1] ** 0.5).masked_fill(~is_there, REFUSED)  # (teams, tokens)
        weights = torch.softmax(match, dim=-1) * is_there
        pooled: Tensor = (weights.unsqueeze(-1) * embedded).sum(dim=1)
        return pooled


def score_layers(size: int, settings: CombinationSettings) -> nn.Sequential:
    """Return two layers that score actions, at first all alike but for maintaining."""
    last = nn.Linear(settings.width, settings.actions)
    nn.init.normal_(last.weight, std=0.01)
    nn.init.zeros_(last.bias)
    with torch.no_grad():
        last.bias[0] = settings.maintain_bias
    return nn.Sequential(nn.Linear(size, settings.width), nn.ReLU(), last)


def _two_layers(size: int, width: int) -> nn.Sequential:
    return nn.Sequential(nn.Linear(size, width), nn.ReLU(), nn.Linear(width, width), nn.ReLU())
