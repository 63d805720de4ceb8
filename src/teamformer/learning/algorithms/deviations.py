"""What single deviations gain: other offers tried in the states that the learner itself comes to.

Problems are given out by the network (and now and then at random). In some states several offers
are accepted by turns, and each time what is left is played out by the rule `soonest` a few times,
with the same noise. What an offer gains is by how much its futures are better, on average, than
those of the offers that were tried beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import torch
from torch import Tensor

from teamformer.base.array_types import Array
from teamformer.learning.algorithms.optimiser import Learner, descend, minibatches, set_rate
from teamformer.methods.learned.dispatch.forecast import DispatchForecast, forecast_of
from teamformer.methods.learned.dispatch.giving_out import Scorer, give_out_all, likeliest
from teamformer.methods.learned.dispatch.offers import MOST_OFFERS
from teamformer.mission.model import Mission
from teamformer.planning.dispatch.futures import take_back_from


@dataclass(frozen=True)
class DeviationSettings:
    """What is tried in each iteration and how it changes the weights."""

    share: float = 0.3  # of the states in which offers are tried
    offers: int = 6  # tried in each, that of the network and the soonest among them
    futures: int = 8  # played for each
    random: float = 0.15  # share of the offers that are accepted at random
    largest_gain: float = 2.0  # in what a task takes a robot; gains are clipped here
    learning_rate: float = 2e-3
    last_learning_rate: float = 2e-5  # falls linearly to this
    passes: int = 4
    minibatch: int = 256  # states
    largest_gradient: float = 1.0  # norm


@dataclass(frozen=True)
class Deviations:
    """States in which offers were tried; a row each."""

    features: Tensor  # (states, offers, features)
    is_offer: Tensor  # (states, offers) bool
    tried: Tensor  # (states, tries) which offers were tried
    gain: Tensor  # (states, tries) of each against the mean of the tries, clipped


@dataclass
class _States:
    """The same, as it grows state by state."""

    features: list[Array] = field(default_factory=list)
    count: list[int] = field(default_factory=list)
    tried: list[Array] = field(default_factory=list)
    gain: list[Array] = field(default_factory=list)


def try_deviations(
    score: Scorer,
    missions: Sequence[Mission],
    settings: DeviationSettings,
    rng: np.random.Generator,
) -> tuple[Deviations, int]:
    """Give out the tasks of missions and try other offers; return that and the tasks given out."""
    forecasts = [forecast_of(mission) for mission in missions]
    given, record = [one.given for one in forecasts], _States()

    def explore(rows: list[int], position: int, features: Array, scores: Array) -> Array:
        chosen = likeliest(rows, position, features, scores)
        for row, n in enumerate(rows):
            count = int(given[n].dispatcher.offers.made[0])
            if count > 2 and rng.random() < settings.share:
                others = _choose(scores[row, :count], settings.offers, rng)
                worth = _try(forecasts[n], others, position, settings.futures, rng)
                gain = np.clip(worth.mean() - worth, -settings.largest_gain, settings.largest_gain)
                record.features.append(features[row].copy())
                record.count.append(count)
                record.tried.append(others)
                record.gain.append(gain)
            if count and rng.random() < settings.random:
                chosen[row] = rng.integers(count)
        return chosen

    give_out_all(given, score, explore)
    return _as_tensors(record), sum(one.tasks for one in given)


def _choose(scores: Array, tries: int, rng: np.random.Generator) -> Array:
    """Return offers to try, (tries,): the network's, the soonest, others; some perhaps twice."""
    near = np.argsort(-scores, kind="stable")[: 3 * tries]
    others = rng.choice(near, max(0, tries - 2), replace=len(near) < tries)
    return np.array([near[0], 0, *others])[:tries]


def _try(
    forecast: DispatchForecast, offers: Array, position: int, futures: int, rng: np.random.Generator
) -> Array:
    """Return what each offer comes to if it is accepted at a position, (tries,)."""
    seed, worth = int(rng.integers(2**31)), np.zeros(len(offers))
    for turn, offer in enumerate(offers.tolist()):
        forecast.given.accept(offer, position)
        worth[turn] = forecast.worth(position + 1, futures, seed)
        take_back_from(forecast.given.schedule, position)
    return worth


def _as_tensors(record: _States) -> Deviations:
    is_offer = np.arange(MOST_OFFERS) < np.array(record.count)[:, None]
    return Deviations(
        torch.from_numpy(np.array(record.features)),
        torch.from_numpy(is_offer),
        torch.from_numpy(np.array(record.tried)),
        torch.from_numpy(np.array(record.gain, np.float32)),
    )


def fit(
    learner: Learner,
    seen: Deviations,
    settings: DeviationSettings,
    progress: float,
    generator: torch.Generator,
) -> float:
    """Fit differences of scores to differences of gains; return the mean square of the errors.

    The errors are those of the first pass, on what the network has not been fitted to yet.
    """
    set_rate(learner, settings.learning_rate, settings.last_learning_rate, progress)
    errors = 0.0
    for number in range(settings.passes):
        for rows in minibatches(len(seen.gain), settings.minibatch, generator, learner.device):
            wrong_by = _wrong_by(learner, seen, rows)
            loss = torch.nn.functional.smooth_l1_loss(
                wrong_by, torch.zeros_like(wrong_by), beta=0.5
            )
            descend(loss, learner.policy, learner.policy_optimizer, settings.largest_gradient)
            if number == 0:
                errors += wrong_by.detach().square().mean(dim=1).sum().item()
    return errors / max(1, len(seen.gain))


def _wrong_by(learner: Learner, seen: Deviations, rows: Tensor) -> Tensor:
    """Return by how much the network is wrong on some states, as (states, tries)."""
    device = learner.device
    scores = learner.policy(seen.features[rows].to(device), seen.is_offer[rows].to(device))
    promised = scores.gather(1, seen.tried[rows].to(device))
    gain = seen.gain[rows].to(device)
    wrong: Tensor = (promised - promised.mean(1, keepdim=True)) - (
        gain - gain.mean(1, keepdim=True)
    )
    return wrong


def torch_scorer(network: torch.nn.Module, device: str = "cpu") -> Scorer:
    """Return a scorer that asks a network in torch."""

    def score(features: Array, count: Array) -> Array:
        is_offer = torch.from_numpy(np.arange(MOST_OFFERS) < count[:, None]).to(device)
        with torch.no_grad():
            scores = network(torch.from_numpy(features).to(device), is_offer)
        scored: Array = scores.double().cpu().numpy()
        return scored

    return score
