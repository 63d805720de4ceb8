"""What whole plans are worth: several samples of each mission, each judged by their mean.

The tasks of a mission are given out several times by chance, as likely as the network finds each
offer. All offers of a plan are credited with by how much it is better than the mean of the
mission's plans (Kwon et al. 2020), and become likelier by that, within the clip of PPO.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import torch
from torch import Tensor

from teamformer.base.array_types import Array
from teamformer.learning.algorithms.optimiser import Learner, descend, minibatches, set_rate
from teamformer.learning.algorithms.ppo import clipped_loss
from teamformer.learning.nets.actor import REFUSED
from teamformer.methods.learned.dispatch.forecast import forecasts_of
from teamformer.methods.learned.dispatch.giving_out import (
    Scorer,
    are_choices,
    by_chance,
    give_out_all,
)
from teamformer.mission.model import Mission


@dataclass(frozen=True)
class SampleSettings:
    """How many plans are drawn of each mission, and how they change the weights."""

    plans: int = 16  # of each mission
    heat: float = 0.0125  # scores divided by it are logarithms of chances
    share: float = 0.5  # of the states that are learned from
    clip: float = 0.2
    learning_rate: float = 1e-4
    last_learning_rate: float = 1e-5  # falls linearly to this
    entropy: float = 0.001  # weight of the bonus; falls linearly to 0
    passes: int = 2
    minibatch: int = 256  # states
    largest_gradient: float = 1.0  # norm


@dataclass(frozen=True)
class SampledPlans:
    """States in which an offer was accepted; a row each."""

    features: Tensor  # (states, offers, features)
    is_offer: Tensor  # (states, offers) bool
    is_choice: Tensor  # (states, offers) bool
    chosen: Tensor  # (states,)
    log_prob: Tensor  # (states,) of the chosen offer
    gain: Tensor  # (states,) by how much its plan is better, in standard deviations


@dataclass
class _Drawn:
    """The same, as it grows position by position."""

    features: list[Array] = field(default_factory=list)
    count: list[Array] = field(default_factory=list)
    chosen: list[Array] = field(default_factory=list)
    log_prob: list[Array] = field(default_factory=list)
    plan: list[Array] = field(default_factory=list)  # which one it is of


def sample_plans(
    score: Scorer, missions: Sequence[Mission], settings: SampleSettings, rng: np.random.Generator
) -> tuple[SampledPlans, int, float]:
    """Give out the tasks of missions by chance, several times each.

    Returns what came up, how many tasks were given out, and the standard deviation of the
    logarithm of what plans of one mission cost.
    """
    forecasts = [one for mission in missions for one in forecasts_of(mission, settings.plans)]
    given, record = [one.given for one in forecasts], _Drawn()
    draw = by_chance(rng, settings.heat)

    def watch(rows: list[int], position: int, features: Array, scores: Array) -> Array:
        chosen = draw(rows, position, features, scores)
        count = np.array([given[n].dispatcher.offers.made[0] for n in rows])
        is_kept = (count > 2) & (rng.random(len(rows)) < settings.share)
        logits = torch.from_numpy(scores[is_kept] / settings.heat)
        taken = torch.from_numpy(chosen[is_kept])
        log_prob = logits.log_softmax(dim=1).gather(1, taken.unsqueeze(1))[:, 0]
        record.features.append(features[is_kept])
        record.count.append(count[is_kept])
        record.chosen.append(chosen[is_kept])
        record.log_prob.append(log_prob.numpy())
        record.plan.append(np.array(rows)[is_kept])
        return chosen

    could = give_out_all(given, score, watch)
    cost = [one.cost() if is_able else 1.0 for one, is_able in zip(forecasts, could, strict=True)]
    gain, spread = _gains(np.array(cost).reshape(len(missions), settings.plans))
    return _as_tensors(record, gain), sum(one.tasks for one in given), spread


def _gains(cost: Array) -> tuple[Array, float]:
    """Return by how much each plan is better than its mission's mean, flat, and the spread."""
    logs = np.log(cost)  # (missions, plans)
    gain = logs.mean(axis=1, keepdims=True) - logs
    spread = float(gain.std())
    return (gain / max(spread, 1e-9)).ravel(), spread


def _as_tensors(record: _Drawn, gain: Array) -> SampledPlans:
    features, count = np.concatenate(record.features), np.concatenate(record.count)
    is_offer = np.arange(features.shape[1]) < count[:, None]
    of_state = gain[np.concatenate(record.plan)]
    return SampledPlans(
        torch.from_numpy(features),
        torch.from_numpy(is_offer),
        torch.from_numpy(are_choices(features, count)),
        torch.from_numpy(np.concatenate(record.chosen)),
        torch.from_numpy(np.concatenate(record.log_prob).astype(np.float32)),
        torch.from_numpy(of_state.astype(np.float32)),
    )


def fit(
    learner: Learner,
    seen: SampledPlans,
    settings: SampleSettings,
    progress: float,
    generator: torch.Generator,
) -> tuple[float, float]:
    """Make offers of better plans likelier; return entropy, and how many ratios were clipped.

    Both are means over minibatches, the second a share of the states.
    """
    set_rate(learner, settings.learning_rate, settings.last_learning_rate, progress)
    bonus, about = settings.entropy * (1 - progress), []
    for _ in range(settings.passes):
        for rows in minibatches(len(seen.gain), settings.minibatch, generator, learner.device):
            log_probs = _log_probs(learner, seen, rows, settings.heat)  # (states, offers)
            chosen = seen.chosen[rows].to(learner.device).unsqueeze(1)
            before = seen.log_prob[rows].to(learner.device)
            ratio = (log_probs.gather(1, chosen)[:, 0] - before).exp()
            entropy = -(log_probs.exp() * log_probs).sum(dim=1).mean()
            loss = clipped_loss(ratio, seen.gain[rows].to(learner.device), settings.clip).mean()
            descend(
                loss - bonus * entropy,
                learner.policy,
                learner.policy_optimizer,
                settings.largest_gradient,
            )
            clipped = ((ratio.detach() - 1).abs() > settings.clip).float().mean()
            about.append((entropy.item(), clipped.item()))
    entropies, clips = zip(*about, strict=True)
    return float(np.mean(entropies)), float(np.mean(clips))


def _log_probs(learner: Learner, seen: SampledPlans, rows: Tensor, heat: float) -> Tensor:
    device = learner.device
    scores = learner.policy(seen.features[rows].to(device), seen.is_offer[rows].to(device)) / heat
    chosen = scores.masked_fill(~seen.is_choice[rows].to(device), REFUSED)
    said: Tensor = chosen.log_softmax(dim=1)
    return said
