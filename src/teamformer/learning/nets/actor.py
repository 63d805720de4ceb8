"""What every policy network does: it acts, and says how likely an action was."""

from __future__ import annotations

from typing import Protocol

import torch
from torch import Tensor, nn

REFUSED = -1e9
"""The score of an illegal action."""


class Actor(Protocol):
    """A policy network over the tokens of its codec, each (teams, ...)."""

    def act(
        self, tokens: tuple[Tensor, ...], generator: torch.Generator | None
    ) -> tuple[Tensor, Tensor]:
        """Return an action (teams, ...) int64 and its log-probability (teams,).

        Actions are sampled with the generator; without one, each is the likeliest, greedily.
        """
        ...

    def prepare(self, tokens: tuple[Tensor, ...], action: Tensor) -> tuple[Tensor, ...]:
        """Return what `evaluate` reads of actions made earlier, each (teams, ...).

        No weight changes it, so it is worked out once for all passes over the same actions.
        """
        ...

    def evaluate(self, prepared: tuple[Tensor, ...]) -> tuple[Tensor, Tensor]:
        """Return log-probability and entropy, both (teams,), of actions made earlier.

        The entropy is exact where an action is one choice; where it is a sequence, it is the sum
        of the entropies of its steps along the action taken.
        """
        ...


class OneChoice(nn.Module):
    """An actor whose action is one of several: `forward` scores them, as (teams, actions)."""

    def act(
        self, tokens: tuple[Tensor, ...], generator: torch.Generator | None
    ) -> tuple[Tensor, Tensor]:
        """Return a choice (teams,) and its log-probability (teams,)."""
        log_probs = torch.log_softmax(self(*tokens), dim=-1)  # (teams, actions)
        if generator is None:
            action = log_probs.argmax(dim=-1)
        else:
            action = torch.multinomial(log_probs.exp(), 1, generator=generator)[:, 0]
        return action, log_probs.gather(1, action.unsqueeze(1))[:, 0]

    def prepare(self, tokens: tuple[Tensor, ...], action: Tensor) -> tuple[Tensor, ...]:
        """Return the tokens and the choices."""
        return (*tokens, action)

    def evaluate(self, prepared: tuple[Tensor, ...]) -> tuple[Tensor, Tensor]:
        """Return log-probability and entropy in nats, both (teams,)."""
        *tokens, action = prepared
        log_probs = torch.log_softmax(self(*tokens), dim=-1)  # (teams, actions)
        entropy = -(log_probs.exp() * log_probs).sum(dim=-1)
        return log_probs.gather(1, action.unsqueeze(1))[:, 0], entropy
