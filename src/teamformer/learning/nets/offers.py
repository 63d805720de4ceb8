"""The network that scores offers: which task is given out next, and to whom."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from teamformer.learning.nets.actor import REFUSED


@dataclass(frozen=True)
class OfferSettings:
    """Sizes of the network."""

    features: int
    begins: int  # the feature that says how much later an offer begins than the first
    width: int = 64


class OfferNetwork(nn.Module):
    """Scores every offer of every state, as (states, offers); padding is refused.

    Untrained it prefers what can begin soonest: it is the rule `soonest`.
    """

    def __init__(self, settings: OfferSettings) -> None:
        super().__init__()
        d = settings.width
        self.begins = settings.begins
        self.offer_in = nn.Sequential(nn.Linear(settings.features, d), nn.ReLU(), nn.Linear(d, d))
        self.context = nn.Sequential(nn.Linear(2 * d, d), nn.ReLU())
        first, last = nn.Linear(2 * d, d), nn.Linear(d, 1)
        nn.init.zeros_(last.weight)
        nn.init.zeros_(last.bias)
        self.score = nn.Sequential(first, nn.ReLU(), last)
        self.haste = nn.Parameter(torch.ones(1))

    def forward(self, *parts: Tensor) -> Tensor:
        """Return the scores; parts are (states, offers, features), and which offers there are."""
        features, is_offer = parts
        there = is_offer.unsqueeze(-1)  # (states, offers, 1)
        offers = torch.relu(self.offer_in(features))  # (states, offers, d)
        total = (offers * there).sum(dim=1) / there.sum(dim=1).clamp(min=1)  # (states, d)
        most = offers.masked_fill(~there, 0.0).amax(dim=1)  # (states, d)
        context = self.context(torch.cat([total, most], dim=-1))  # (states, d)
        beside = context.unsqueeze(1).expand(-1, offers.shape[1], -1)
        scores: Tensor = self.score(torch.cat([offers, beside], dim=-1)).squeeze(-1)
        later = features[..., self.begins]
        return (scores - self.haste * later).masked_fill(~is_offer, REFUSED)
