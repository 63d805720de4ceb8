"""Proximal policy optimisation (Schulman et al. 2017) on one rollout."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import torch
from torch import Tensor, nn

from teamformer.nets.critic import Critic
from teamformer.nets.relational import RelationalPolicy, Tokens
from teamformer.train.rollout import Rollout, credit


@dataclass(frozen=True)
class PpoSettings:
    """How one rollout changes the weights."""

    clip: float = 0.2
    learning_rate: float = 5e-4
    last_learning_rate: float = 1e-4  # falls linearly to this
    epochs: int = 2
    discount: float = 0.99  # gamma
    decay: float = 0.95  # lambda
    entropy: float = 0.02  # weight of the bonus
    last_entropy: float = 0.001  # falls linearly to this
    minibatch: int = 2048
    largest_gradient: float = 0.5  # norm


@dataclass(frozen=True)
class Learner:
    """The two networks and their optimisers."""

    policy: RelationalPolicy
    critic: Critic
    policy_optimizer: torch.optim.Adam
    critic_optimizer: torch.optim.Adam


@dataclass(frozen=True)
class Update:
    """What an update saw, as means over its minibatches."""

    policy_loss: float
    value_loss: float
    entropy: float
    clipped: float  # share of decisions whose ratio was beyond the clip


def update(
    learner: Learner,
    rollout: Rollout,
    settings: PpoSettings,
    progress: float,
    generator: torch.Generator,
) -> Update:
    """Improve policy and critic on a rollout; `progress` goes from 0 to 1 over the training."""
    gains, targets = credit(rollout, learner.critic, settings.discount, settings.decay)
    gain = gains[rollout.state]  # (decisions,) every team of a world gets its world's
    gain = (gain - gain.mean()) / (gain.std() + 1e-6)
    bonus = settings.entropy + progress * (settings.last_entropy - settings.entropy)
    rate = settings.learning_rate
    set_rate(learner, rate + progress * (settings.last_learning_rate - rate))
    seen, value_losses = [], []
    for _ in range(settings.epochs):
        for rows in _minibatches(len(gain), settings.minibatch, generator):
            loss, about = _policy_loss(learner.policy, rollout, rows, gain[rows], settings, bonus)
            _descend(loss, learner.policy, learner.policy_optimizer, settings)
            seen.append(about)
        for rows in _minibatches(len(targets), settings.minibatch, generator):
            values = learner.critic(*(part[rows] for part in rollout.outlook))
            value_loss = nn.functional.mse_loss(values, targets[rows])
            _descend(value_loss, learner.critic, learner.critic_optimizer, settings)
            value_losses.append(value_loss.item())
    policy_loss, entropy, clipped = torch.stack(seen).mean(dim=0).tolist()
    return Update(policy_loss, sum(value_losses) / len(value_losses), entropy, clipped)


def set_rate(learner: Learner, rate: float) -> None:
    """Set the learning rate of both optimisers."""
    for optimizer in (learner.policy_optimizer, learner.critic_optimizer):
        for group in optimizer.param_groups:
            group["lr"] = rate


def log_probs_and_entropy(scores: Tensor, choice: Tensor) -> tuple[Tensor, Tensor]:
    """Return the log-probability of each choice and each distribution's entropy, in nats."""
    log_probs = torch.log_softmax(scores, dim=-1)  # (decisions, choices)
    entropy = -(log_probs.exp() * log_probs).sum(dim=-1)
    return log_probs.gather(1, choice.unsqueeze(1)).squeeze(1), entropy


def clipped_loss(ratio: Tensor, gain: Tensor, clip: float) -> Tensor:
    """Return the surrogate loss (eq. 7) of each decision."""
    return -torch.minimum(ratio * gain, ratio.clamp(1 - clip, 1 + clip) * gain)


def _policy_loss(
    policy: RelationalPolicy,
    rollout: Rollout,
    rows: Tensor,
    gain: Tensor,
    settings: PpoSettings,
    bonus: float,
) -> tuple[Tensor, Tensor]:
    scores = policy(Tokens(*(part[rows] for part in rollout.tokens)))
    log_prob, entropy = log_probs_and_entropy(scores, rollout.choice[rows])
    ratio = (log_prob - rollout.log_prob[rows]).exp()
    loss = clipped_loss(ratio, gain, settings.clip).mean()
    clipped = ((ratio - 1).abs() > settings.clip).float().mean()
    about = torch.stack([loss.detach(), entropy.mean().detach(), clipped])
    return loss - bonus * entropy.mean(), about


def _descend(
    loss: Tensor, network: nn.Module, optimizer: torch.optim.Adam, settings: PpoSettings
) -> None:
    optimizer.zero_grad()
    loss.backward()  # type: ignore[no-untyped-call]
    nn.utils.clip_grad_norm_(network.parameters(), settings.largest_gradient)
    optimizer.step()


def _minibatches(count: int, size: int, generator: torch.Generator) -> Iterator[Tensor]:
    """Yield shuffled row numbers in parts of about `size`."""
    parts = max(1, round(count / size))
    yield from torch.randperm(count, generator=generator).tensor_split(parts)
