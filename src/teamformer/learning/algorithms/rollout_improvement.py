"""Learning by rollouts: scores that say how many steps a choice gains on the script's.

One step of policy iteration with rollouts (Lagoudakis and Parr 2003), from the script on.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from teamformer.learning.algorithms.counterfactual import Trials
from teamformer.learning.algorithms.optimiser import Learner, descend, minibatches, set_rate
from teamformer.methods.learned.macro_actions import FOLLOW


@dataclass(frozen=True)
class RolloutImprovementSettings:
    """What is tried in each iteration and how it changes the weights."""

    share: float = 0.5  # of the steps in which something else is tried
    margin: float = 0.8  # steps that deviating from the script has to promise
    learning_rate: float = 2e-3
    last_learning_rate: float = 2e-5  # falls linearly to this
    passes: int = 4
    minibatch: int = 512
    largest_gradient: float = 1.0  # norm


def fit(
    learner: Learner,
    tried: Trials,
    settings: RolloutImprovementSettings,
    progress: float,
    generator: torch.Generator,
) -> float:
    """Fit differences of scores to gains by least squares; return the mean square of the errors.

    The errors are those of the first pass, on what the network has not been fitted to yet.
    """
    set_rate(learner, settings.learning_rate, settings.last_learning_rate, progress)
    errors = 0.0
    for number in range(settings.passes):
        for rows in minibatches(len(tried.gain), settings.minibatch, generator, learner.device):
            wrong_by = _wrong_by(learner, tried, rows, settings.margin)
            loss = wrong_by.square().sum() / max(1, len(rows))
            descend(loss, learner.policy, learner.policy_optimizer, settings.largest_gradient)
            if number == 0:
                errors += wrong_by.detach().square().sum().item()
    return errors / max(1, len(tried.gain))


def _wrong_by(learner: Learner, tried: Trials, rows: Tensor, margin: float) -> Tensor:
    """Return by how much the network is wrong on some rows, as (rows,)."""
    network: nn.Module = learner.policy
    scores = network(*(part[rows].to(learner.device) for part in tried.tokens))
    other = tried.other[rows].to(learner.device)
    gain = tried.gain[rows].to(learner.device)
    promised: Tensor = scores.gather(1, other[:, None])[:, 0] - scores[:, FOLLOW]
    return promised - (gain - margin)
