"""A graph network with dynamic attention, GATv2 (Brody, Alon and Yahav, ICLR 2022).

The nodes are all that a team sees: itself, other teams, tasks. Each is joined to each.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from teamformer.learning.nets.actor import REFUSED, OneChoice
from teamformer.learning.nets.deepset import CombinationSettings, score_layers


class GraphNetwork(OneChoice):
    """Scores every combination, as (teams, actions); illegal ones are refused."""

    def __init__(self, settings: CombinationSettings) -> None:
        super().__init__()
        d = settings.width
        self.team_in = nn.Linear(settings.team_features, d)
        self.task_in = nn.Linear(settings.task_features, d)
        self.own_in = nn.Linear(settings.team_features, d)
        self.first = _Attention(d, settings.heads)
        self.second = _Attention(d, settings.heads)
        self.out = score_layers(2 * d, settings)

    def forward(self, *parts: Tensor) -> Tensor:
        """Return the scores; inputs are those of `DeepSet`."""
        teams, tasks, is_team, is_task, is_legal = parts
        own = self.own_in(teams[:, :1])  # (teams, 1, d)
        nodes = torch.cat([own, self.team_in(teams[:, 1:]), self.task_in(tasks)], dim=1)
        nodes = torch.relu(nodes)  # (teams, nodes, d)
        is_there = torch.cat([is_team, is_task], dim=1)  # (teams, nodes)
        nodes = nodes + self.first(nodes, nodes, is_there)
        gathered = self.second(nodes[:, :1], nodes, is_there)  # (teams, 1, d)
        read = torch.cat([nodes[:, 0], gathered[:, 0]], dim=-1)  # (teams, 2 d)
        scores: Tensor = self.out(read)
        return scores.masked_fill(~is_legal, REFUSED)


class _Attention(nn.Module):
    """What nodes are told by all nodes (eq. 7): the score is taken after the nonlinearity."""

    def __init__(self, d: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.of_receiver = nn.Linear(d, d)
        self.of_sender = nn.Linear(d, d)
        self.score = nn.Parameter(torch.randn(heads, d // heads) * 0.1)

    def forward(self, receivers: Tensor, senders: Tensor, is_there: Tensor) -> Tensor:
        """Return (teams, receivers, d) from (teams, receivers, d) and (teams, senders, d)."""
        split = (self.heads, -1)
        told = self.of_sender(senders).unflatten(-1, split)  # (teams, senders, heads, d / heads)
        asked = self.of_receiver(receivers).unflatten(-1, split)
        both = nn.functional.leaky_relu(asked.unsqueeze(2) + told.unsqueeze(1), 0.2)
        match = (both * self.score).sum(dim=-1)  # (teams, receivers, senders, heads)
        match = match.masked_fill(~is_there[:, None, :, None], REFUSED)
        weights = torch.softmax(match, dim=2)
        heard = torch.einsum("trsh,tshd->trhd", weights, told).flatten(2)
        return torch.relu(heard)
