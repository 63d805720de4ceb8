"""Proximal policy optimisation (Schulman et al. 2017) on one rollout."""

from __future__ import annotations

from dataclasses import dataclass, replace

import torch
from torch import Tensor

from teamformer.learning.algorithms.advantages import Credit, credit, stream_values
from teamformer.learning.algorithms.optimiser import Learner, descend, minibatches, set_rate
from teamformer.learning.algorithms.rollout import Rollout


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
    there = _on(rollout, learner.device)
    learned = credit(there, learner.critic, settings.discount, settings.decay)
    gain = (learned.gain - learned.gain.mean()) / (learned.gain.std() + 1e-6)
    bonus = settings.entropy + progress * (settings.last_entropy - settings.entropy)
    set_rate(learner, settings.learning_rate, settings.last_learning_rate, progress)
    prepared = learner.actor.prepare(rollout.tokens, rollout.action)
    seen, value_losses = [], []
    for _ in range(settings.epochs):
        for rows in minibatches(len(gain), settings.minibatch, generator, learner.device):
            said = _said(learner, prepared, rows)
            before = rollout.log_prob[rows].to(learner.device)
            loss, about = _policy_loss(said, before, gain[rows].to(learner.device), settings, bonus)
            descend(loss, learner.policy, learner.policy_optimizer, settings.largest_gradient)
            seen.append(about)
        states = len(learned.target)
        for rows in minibatches(states, settings.minibatch, generator, learner.device):
            value_loss = _value_loss(learner, rollout, learned, rows)
            descend(value_loss, learner.critic, learner.critic_optimizer, settings.largest_gradient)
            value_losses.append(value_loss.item())
    policy_loss, entropy, clipped = torch.stack(seen).mean(dim=0).tolist()
    return Update(policy_loss, sum(value_losses) / len(value_losses), entropy, clipped)


def clipped_loss(ratio: Tensor, gain: Tensor, clip: float) -> Tensor:
    """Return the surrogate loss (eq. 7) of each decision."""
    return -torch.minimum(ratio * gain, ratio.clamp(1 - clip, 1 + clip) * gain)


def _said(learner: Learner, prepared: tuple[Tensor, ...], rows: Tensor) -> tuple[Tensor, Tensor]:
    """Return how likely decisions are now, and the entropies, both (rows,)."""
    given = tuple(part[rows].to(learner.device) for part in prepared)
    said: tuple[Tensor, Tensor] = learner.actor.evaluate(given)
    return said


def _policy_loss(
    said: tuple[Tensor, Tensor], before: Tensor, gain: Tensor, settings: PpoSettings, bonus: float
) -> tuple[Tensor, Tensor]:
    log_prob, entropy = said
    ratio = (log_prob - before).exp()
    loss = clipped_loss(ratio, gain, settings.clip).mean()
    clipped = ((ratio - 1).abs() > settings.clip).float().mean()
    about = torch.stack([loss.detach(), entropy.mean().detach(), clipped])
    return loss - bonus * entropy.mean(), about.cpu()


def _value_loss(learner: Learner, rollout: Rollout, learned: Credit, rows: Tensor) -> Tensor:
    said = learner.critic(*(part[rows].to(learner.device) for part in rollout.global_state))
    values = stream_values(said, rollout.value_of[rows])
    is_there = learned.is_there[rows].to(learner.device)
    wrong_by = (values - learned.target[rows].to(learner.device))[is_there]
    return wrong_by.square().mean()


def _on(rollout: Rollout, device: str) -> Rollout:
    """Return the rollout with what the critic values on a device."""
    if device == "cpu":
        return rollout
    return replace(
        rollout,
        global_state=tuple(part.to(device) for part in rollout.global_state),
        last_global_state=tuple(part.to(device) for part in rollout.last_global_state),
    )
