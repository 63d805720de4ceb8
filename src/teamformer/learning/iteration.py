"""Iterations: what one of a training plays and learns, by any of the methods.

All randomness comes from the seed, the process's rank and the iteration's number.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import torch

from teamformer.learning.algorithms import deviations, distributed, imitation, sampled_plans
from teamformer.learning.algorithms.counterfactual import try_others
from teamformer.learning.algorithms.demonstrations import demonstrate
from teamformer.learning.algorithms.optimiser import Learner
from teamformer.learning.algorithms.ppo import update
from teamformer.learning.algorithms.rollout import play, sampler
from teamformer.learning.algorithms.rollout_improvement import fit
from teamformer.learning.task_worlds import task_worlds
from teamformer.learning.training_settings import TrainSettings
from teamformer.learning.training_worlds import training_worlds
from teamformer.methods.learned.codec import ImitatingCodec
from teamformer.mission.model import Mission
from teamformer.world.env import TeamFormation


@dataclass(frozen=True)
class Iteration:
    """What there is to say of an iteration."""

    steps: int  # of worlds, in all processes
    figures: Mapping[str, float]


def learn_from_rewards(
    learner: Learner, settings: TrainSettings, number: int, progress: float
) -> Iteration:
    """Play fresh worlds, and improve policy and critic by PPO on the rewards that came."""
    worlds, seed = _worlds(settings, number)
    env = TeamFormation(worlds, settings.reward.of_environment)
    codec = settings.architecture.codec_for(settings.capabilities)
    generator = torch.Generator(settings.device).manual_seed(seed)
    choose = sampler(learner.policy, generator, settings.device)  # type: ignore[arg-type]
    rollout = play(env, codec, choose, settings.reward, settings.worlds_from.steps)
    seen = update(learner, rollout, settings.update, progress, torch.Generator().manual_seed(seed))
    figures = {
        "reward": float(rollout.rewards.sum(axis=0).mean()),  # of a stream
        "ended": float(rollout.has_ended.mean()),  # share of worlds
        "splits": float(np.mean(env.worlds.count["splits"])),
        "entropy": seen.entropy,
        "clipped": seen.clipped,
        "policy loss": seen.policy_loss,
        "value loss": seen.value_loss,
    }
    return Iteration(int(rollout.is_running.sum()) * distributed.count(), figures)


def learn_by_rollouts(
    learner: Learner, settings: TrainSettings, number: int, progress: float
) -> Iteration:
    """Play fresh worlds by the script, try other choices, and learn what they gain."""
    worlds, seed = _worlds(settings, number)
    codec = settings.architecture.codec_for(settings.capabilities)
    rng = np.random.default_rng(seed)
    tried, steps = try_others(codec, worlds, rng, settings.rollouts.share)
    generator = torch.Generator().manual_seed(seed)
    error = fit(learner, tried, settings.rollouts, progress, generator)
    count = max(1, len(tried.gain))
    variance = float((tried.gain - tried.gain.sum() / count).square().sum()) / count
    figures = {
        "tried": float(len(tried.gain)),
        "gained": float((tried.gain > 0).sum()) / count,
        "explained": 1.0 - error / variance if variance > 0 else 0.0,  # share of the variance
    }
    return Iteration(steps * distributed.count(), figures)


def learn_by_imitation(
    learner: Learner, settings: TrainSettings, number: int, progress: float
) -> Iteration:
    """Play fresh worlds, and learn what the script wants in the states that come up."""
    worlds, seed = _worlds(settings, number)
    codec = settings.architecture.codec_for(settings.capabilities)
    assert isinstance(codec, ImitatingCodec)  # TrainSettings has seen to it
    choose = sampler(learner.policy, None, settings.device)  # type: ignore[arg-type]
    how = settings.imitation
    by_script = how.by_script if number > 0 else 1.0  # what knows nothing leads nowhere
    rng = np.random.default_rng(seed)
    shown, steps = demonstrate(codec, choose, worlds, rng, by_script, how.share)
    generator = torch.Generator().manual_seed(seed)
    loss = imitation.fit(learner, shown, how, progress, generator)
    figures = {
        "shown": float(len(shown.action)),
        "agreed": shown.agreed,  # share of the network's own decisions
        "ended": shown.ended,  # share of the worlds that it played
        "loss": loss,
    }
    return Iteration(steps * distributed.count(), figures)


def learn_by_deviations(
    learner: Learner, settings: TrainSettings, number: int, progress: float
) -> Iteration:
    """Give out the tasks of fresh missions, try other offers, and learn what they gain."""
    rank = distributed.rank()
    missions = task_worlds(settings.worlds, (settings.seed, number, rank))
    rng = np.random.default_rng(_seed(settings, number))
    score = deviations.torch_scorer(learner.policy, settings.device)
    seen, steps = deviations.try_deviations(score, missions, settings.deviations, rng)
    generator = torch.Generator().manual_seed(_seed(settings, number))
    error = deviations.fit(learner, seen, settings.deviations, progress, generator)
    variance = float(seen.gain.square().mean())
    figures = {
        "states": float(len(seen.gain)),
        "first": float((seen.gain[:, 0]).mean()),  # what the network's own offer gains
        "explained": 1.0 - error / variance if variance > 0 else 0.0,  # share of the variance
    }
    return Iteration(steps * distributed.count(), figures)


def learn_by_samples(
    learner: Learner, settings: TrainSettings, number: int, progress: float
) -> Iteration:
    """Give out the tasks of fresh missions by chance, and make what better plans chose likelier."""
    missions = task_worlds(settings.worlds, (settings.seed, number, distributed.rank()))
    rng = np.random.default_rng(_seed(settings, number))
    score = deviations.torch_scorer(learner.policy, settings.device)
    seen, steps, spread = sampled_plans.sample_plans(score, missions, settings.samples, rng)
    generator = torch.Generator().manual_seed(_seed(settings, number))
    entropy, clipped = sampled_plans.fit(learner, seen, settings.samples, progress, generator)
    figures = {
        "states": float(len(seen.gain)),
        "spread": spread,  # of the logarithm of what plans of one mission cost
        "entropy": entropy,
        "clipped": clipped,
    }
    return Iteration(steps * distributed.count(), figures)


METHODS: Mapping[str, Callable[[Learner, TrainSettings, int, float], Iteration]] = {
    "ppo": learn_from_rewards,
    "rollouts": learn_by_rollouts,
    "imitation": learn_by_imitation,
    "deviations": learn_by_deviations,
    "samples": learn_by_samples,
}


def _worlds(settings: TrainSettings, number: int) -> tuple[list[Mission], int]:
    """Return this process's worlds of an iteration, and a seed for all else."""
    rank = distributed.rank()
    worlds = training_worlds(settings.worlds_from, settings.worlds, (settings.seed, number, rank))
    return worlds, _seed(settings, number)


def _seed(settings: TrainSettings, number: int) -> int:
    return settings.seed * 1_000_003 + number + distributed.rank() * 7_919_993
