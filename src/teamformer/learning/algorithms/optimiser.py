"""What learns, and its steps down a loss, in one process or many."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

import torch
from torch import Tensor, nn

from teamformer.learning.algorithms import distributed
from teamformer.learning.nets.actor import Actor
from teamformer.learning.nets.critic import Critic


@dataclass(frozen=True)
class Learner:
    """The two networks and their optimisers, on one device."""

    policy: nn.Module  # an Actor
    critic: Critic
    policy_optimizer: torch.optim.Adam
    critic_optimizer: torch.optim.Adam
    device: str = "cpu"

    @property
    def actor(self) -> Actor:
        """Return the policy as what is asked of it."""
        return cast("Actor", self.policy)


def set_rate(learner: Learner, first: float, last: float, progress: float) -> None:
    """Set the learning rate of both optimisers, between the first and the last."""
    for optimizer in (learner.policy_optimizer, learner.critic_optimizer):
        for group in optimizer.param_groups:
            group["lr"] = first + progress * (last - first)


def descend(
    loss: Tensor, network: nn.Module, optimizer: torch.optim.Adam, largest_gradient: float
) -> None:
    """Make a step down the mean loss of all processes; longer gradients are cut to the largest."""
    optimizer.zero_grad()
    loss.backward()  # type: ignore[no-untyped-call]
    distributed.average_gradients(network)
    nn.utils.clip_grad_norm_(network.parameters(), largest_gradient)
    optimizer.step()


def minibatches(
    count: int, size: int, generator: torch.Generator, device: str = "cpu"
) -> Iterator[Tensor]:
    """Yield shuffled row numbers in parts of about a size, equally many in every process."""
    parts = distributed.largest(max(1, round(count / size)), device)
    yield from torch.randperm(count, generator=generator).tensor_split(parts)
