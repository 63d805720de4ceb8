"""Learning by imitation: what a script wants becomes the likeliest decision."""

from __future__ import annotations

from dataclasses import dataclass

import torch

from teamformer.learning.algorithms.demonstrations import Demonstrations
from teamformer.learning.algorithms.optimiser import Learner, descend, minibatches, set_rate


@dataclass(frozen=True)
class ImitationSettings:
    """Whose states are learned from in each iteration, and how they change the weights."""

    by_script: float = 0.5  # share of the worlds that the script plays, in the first all of them
    share: float = 0.1  # of the decisions of teams with nobody to join that are learned from
    learning_rate: float = 4e-3
    last_learning_rate: float = 4e-5  # falls linearly to this
    passes: int = 2
    minibatch: int = 128
    largest_gradient: float = 1.0  # norm


def fit(
    learner: Learner,
    shown: Demonstrations,
    settings: ImitationSettings,
    progress: float,
    generator: torch.Generator,
) -> float:
    """Make the script's decisions likelier; return minus their mean log-probability.

    It is that of the first pass, of decisions that the network has not been fitted to yet.
    """
    set_rate(learner, settings.learning_rate, settings.last_learning_rate, progress)
    prepared = learner.actor.prepare(shown.tokens, shown.action)
    losses, count = 0.0, len(shown.action)
    for number in range(settings.passes):
        for rows in minibatches(count, settings.minibatch, generator, learner.device):
            given = tuple(part[rows].to(learner.device) for part in prepared)
            log_prob, _ = learner.actor.evaluate(given)
            loss = -log_prob.sum() / max(1, len(rows))
            descend(loss, learner.policy, learner.policy_optimizer, settings.largest_gradient)
            if number == 0:
                losses -= log_prob.detach().sum().item()
    return losses / max(1, count)
