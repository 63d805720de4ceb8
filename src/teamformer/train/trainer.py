"""Training from nothing, or on from a checkpoint: clone a little, then PPO on fresh worlds."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
import torch

from teamformer.model import Scenario
from teamformer.nets.critic import Critic, CriticSettings
from teamformer.nets.relational import RelationalPolicy, RelationalSettings
from teamformer.policies import relations
from teamformer.sim.env import TeamFormation
from teamformer.train import outlook
from teamformer.train.checkpoint import ABOUT, Progress, load, load_weights, save
from teamformer.train.cloning import choose_as_join_all, clone
from teamformer.train.evaluation import Score, evaluate
from teamformer.train.ppo import Learner, PpoSettings, Update, set_rate, update
from teamformer.train.rollout import MissionReward, Rollout, play, sampler
from teamformer.train.worlds import Mixture, training_worlds


@dataclass(frozen=True)
class TrainSettings:
    """One training; the same settings give the same weights."""

    seed: int = 0
    iterations: int = 500
    worlds: int = 256  # in each iteration
    cloning: int = 10  # how many iterations at the start only imitate join-all
    width: int = 48
    mixture: Mixture = field(default_factory=Mixture)
    reward: MissionReward = field(default_factory=MissionReward)
    ppo: PpoSettings = field(default_factory=PpoSettings)
    evaluate_every: int = 20
    begin_from: str = ""  # folder of a checkpoint to take the first weights from


@dataclass(frozen=True)
class Report:
    """What there is to say after an iteration."""

    progress: Progress
    seconds: float
    reward: float  # mean sum of rewards of a world
    ended: float  # share of worlds whose tasks were all done
    decisions: int
    splits: float  # for each world
    update: Update | None  # None while cloning
    score: Score | None  # None where it was not evaluated


def make_learner(settings: TrainSettings) -> Learner:
    """Return fresh networks and optimisers, the same for the same seed."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(settings.seed)
        policy = RelationalPolicy(
            RelationalSettings(
                relations.OWN_FEATURES,
                relations.TEAM_FEATURES,
                relations.TASK_FEATURES,
                width=settings.width,
            )
        )
        critic = Critic(
            CriticSettings(outlook.TEAM_FEATURES, outlook.TASK_FEATURES, outlook.WORLD_FEATURES)
        )
    rate = settings.ppo.learning_rate
    return Learner(
        policy,
        critic,
        torch.optim.Adam(policy.parameters(), rate),
        torch.optim.Adam(critic.parameters(), rate),
    )


def train(
    settings: TrainSettings,
    folder: Path,
    held_out: Sequence[Sequence[Scenario]],
    on_report: Callable[[Report], None] = lambda report: None,
    until: int | None = None,
) -> Learner:
    """Train to the last iteration, or to `until`; go on where the folder's checkpoint stands.

    The folder gets `last`, to resume from, and `best`, the best on the held-out worlds.
    """
    learner, progress = make_learner(settings), Progress()
    described = json.loads(json.dumps(asdict(settings)))  # as a checkpoint gives it back
    if (folder / "last" / ABOUT).exists():
        progress = load(folder / "last", learner, described)
    elif settings.begin_from:
        load_weights(Path(settings.begin_from), learner)
    while progress.iteration < min(until or settings.iterations, settings.iterations):
        report = _iterate(learner, settings, progress)
        progress = report.progress
        is_last = progress.iteration == settings.iterations
        if progress.iteration % settings.evaluate_every == 0 or is_last:
            score = evaluate(learner.policy, held_out)
            report = replace(report, score=score)
            if score.failures == 0 and score.ratio < progress.best_ratio:
                progress = replace(progress, best_ratio=score.ratio)
                save(folder / "best", learner, described, progress)
            save(folder / "last", learner, described, progress)
        on_report(report)
    save(folder / "last", learner, described, progress)
    return learner


def _iterate(learner: Learner, settings: TrainSettings, progress: Progress) -> Report:
    """Play fresh worlds and learn from them; all randomness comes from seed and iteration."""
    begun = time.perf_counter()
    number = progress.iteration
    generator = torch.Generator().manual_seed(settings.seed * 1_000_003 + number)
    env = TeamFormation(training_worlds(settings.mixture, settings.worlds, settings.seed, number))
    is_cloning = number < settings.cloning
    choose = choose_as_join_all if is_cloning else sampler(learner.policy, generator)
    rollout = play(env, choose, settings.reward, settings.mixture.steps)
    seen = None
    if is_cloning:
        set_rate(learner, settings.ppo.learning_rate)
        clone(learner, rollout, settings.ppo.minibatch // 8, generator)
    else:
        share = (number - settings.cloning) / max(settings.iterations - settings.cloning, 1)
        seen = update(learner, rollout, settings.ppo, share, generator)
    return _report(env, rollout, progress, seen, time.perf_counter() - begun)


def _report(
    env: TeamFormation,
    rollout: Rollout,
    progress: Progress,
    seen: Update | None,
    seconds: float,
) -> Report:
    steps = int(rollout.is_running.sum())
    return Report(
        progress=replace(progress, iteration=progress.iteration + 1, steps=progress.steps + steps),
        seconds=seconds,
        reward=float(rollout.rewards.sum(axis=0).mean()),
        ended=float(rollout.has_ended.mean()),
        decisions=len(rollout.choice),
        splits=float(np.mean(env.worlds.count["splits"])),
        update=seen,
        score=None,
    )
