"""What every policy network does: it acts, and says how likely an action was."""

from __future__ import annotations

from typing import Protocol

import torch
from torch import Tensor


class Actor(Protocol):
    """A policy network over the tokens of its codec, each (teams, ...)."""

    def act(
        self, tokens: tuple[Tensor, ...], generator: torch.Generator | None
    ) -> tuple[Tensor, Tensor]:
        """Return an action (teams, ...) int64 and its log-probability (teams,).

        Actions are sampled with the generator; without one, each is the likeliest, greedily.
        """
        ...

    def evaluate(self, tokens: tuple[Tensor, ...], action: Tensor) -> tuple[Tensor, Tensor]:
        """Return log-probability and entropy, both (teams,), of actions made earlier.

        The entropy is exact where an action is one choice; where it is a sequence, it is the sum
        of the entropies of its steps along the action taken.
        """
        ...
