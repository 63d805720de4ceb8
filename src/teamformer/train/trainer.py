"""Training from nothing, or on from a checkpoint: PPO on fresh worlds, selection on others."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import torch

from teamformer.model import Scenario
from teamformer.nets.critic import Critic, CriticSettings
from teamformer.policies.trained import About, describe_policy
from teamformer.sim.env import TeamFormation
from teamformer.train import outlook, ranks
from teamformer.train.checkpoint import ABOUT, Progress, load, load_weights, save
from teamformer.train.evaluation import Exam, Score, examine, prepare_exam
from teamformer.train.families import Family, find_family
from teamformer.train.ppo import Learner, PpoSettings, Update, update
from teamformer.train.rewards import MissionReward, TeamReward
from teamformer.train.rollout import Rollout, play, sampler
from teamformer.train.worlds import Mixture, training_worlds

ITERATIONS, NO_LIMIT = 60, 10**9


@dataclass(frozen=True)
class TrainSettings:
    """One training; the same settings give the same weights, if no clock ends it."""

    network: str = "any"
    capabilities: int | None = None  # None: any number
    seed: int = 0
    iterations: int | None = None  # None: as many as the minutes allow, else 60
    minutes: float | None = None  # ends the training, where that is earlier
    worlds: int = 256  # in each iteration and process
    mixture: Mixture | None = None  # None: the network's own
    mission_reward: MissionReward | None = field(default_factory=MissionReward)
    team_reward: TeamReward | None = None  # instead, if mission_reward is None
    ppo: PpoSettings = field(default_factory=PpoSettings)
    evaluate_every: int = 10
    begin_from: str = ""  # folder of a checkpoint to take the first weights from
    device: str = "cpu"

    def __post_init__(self) -> None:
        find_family(self.network, self.capabilities)

    @property
    def last_iteration(self) -> int:
        """Return how many iterations there are at most."""
        if self.iterations is not None:
            return self.iterations
        return ITERATIONS if self.minutes is None else NO_LIMIT

    @property
    def family(self) -> Family:
        """Return the network's kind."""
        return find_family(self.network, self.capabilities)

    @property
    def worlds_from(self) -> Mixture:
        """Return where training worlds are drawn from."""
        return self.mixture or self.family.mixture(self.capabilities)

    @property
    def reward(self) -> MissionReward | TeamReward:
        """Return the one reward that is set."""
        if self.mission_reward is None:
            return self.team_reward or TeamReward()
        return self.mission_reward


@dataclass(frozen=True)
class Report:
    """What there is to say after an iteration."""

    progress: Progress
    steps_per_second: float  # of worlds, playing and learning
    reward: float  # mean sum of rewards of a stream
    ended: float  # share of worlds whose tasks were all done
    decisions: int
    splits: float  # for each world
    update: Update
    score: Score | None  # None where it was not evaluated


def make_learner(settings: TrainSettings) -> Learner:
    """Return fresh networks and optimisers, the same for the same seed."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(settings.seed)
        policy = settings.family.make(settings.capabilities)
        critic = Critic(
            CriticSettings(
                outlook.TEAM_FEATURES,
                outlook.TASK_FEATURES,
                outlook.WORLD_FEATURES,
                settings.reward.is_per_team,
            )
        )
    policy.to(settings.device)
    critic.to(settings.device)
    rate = settings.ppo.learning_rate
    return Learner(
        policy,
        critic,
        torch.optim.Adam(policy.parameters(), rate),
        torch.optim.Adam(critic.parameters(), rate),
        settings.device,
    )


def train(
    settings: TrainSettings,
    folder: Path,
    held_out: Sequence[Sequence[Scenario]],
    on_report: Callable[[Report], None] = lambda report: None,
    until: int | None = None,
    exports: bool = True,
) -> Learner:
    """Train to the last iteration or minute, or to `until`; go on where the folder stands.

    The folder gets `last`, to resume from, and `best`, the best on the held-out worlds; with
    `exports` both hold the policy as it runs without torch, too.
    """
    learner, progress = _begin(settings, folder)
    exam = prepare_exam(held_out)
    while not _is_over(settings, progress, until):
        report = _iterate(learner, settings, progress)
        progress = report.progress
        is_last = _is_over(settings, progress, None)
        if progress.iteration % settings.evaluate_every == 0 or is_last:
            score = _examine(learner, settings, exam)
            report = replace(report, score=score)
            if _is_better(score, progress):
                progress = replace(progress, best_ratio=score.ratio, best_failures=score.failures)
                _keep(folder / "best", learner, settings, progress)
                if exports:
                    _export(folder / "best", learner, settings)
        _keep(folder / "last", learner, settings, progress)
        on_report(report)
    if exports:
        _export(folder / "last", learner, settings)
    return learner


def _examine(learner: Learner, settings: TrainSettings, exam: Exam) -> Score:
    codec = settings.family.codec(settings.capabilities)
    return examine(learner.policy, codec, exam, settings.device)  # type: ignore[arg-type]


def _begin(settings: TrainSettings, folder: Path) -> tuple[Learner, Progress]:
    learner = make_learner(settings)
    if (folder / "last" / ABOUT).exists():
        return learner, load(folder / "last", learner, _described(settings))
    if settings.begin_from:
        load_weights(Path(settings.begin_from), learner)
    return learner, Progress()


def _described(settings: TrainSettings) -> dict[str, object]:
    """Return the settings that make a training what it is, as a checkpoint gives them back."""
    described: dict[str, object] = json.loads(json.dumps(asdict(settings)))
    del described["device"], described["minutes"]  # may change when it goes on
    return described


def _is_over(settings: TrainSettings, progress: Progress, until: int | None) -> bool:
    last = min(until or settings.last_iteration, settings.last_iteration)
    out_of_time = settings.minutes is not None and progress.seconds >= 60 * settings.minutes
    return progress.iteration >= last or out_of_time


def _is_better(score: Score, progress: Progress) -> bool:
    """Say whether a score has fewer failures than the best, or as many and fewer steps."""
    return (score.failures, score.ratio) < (progress.best_failures, progress.best_ratio)


def _keep(folder: Path, learner: Learner, settings: TrainSettings, progress: Progress) -> None:
    """Write a checkpoint; the first process does."""
    if ranks.rank() == 0:
        save(folder, learner, _described(settings), progress)


def _export(folder: Path, learner: Learner, settings: TrainSettings) -> None:
    """Write the policy beside the checkpoint, as it runs without torch; all its files or none."""
    if ranks.rank() > 0:
        return
    with TemporaryDirectory(dir=folder) as name:
        settings.family.export(learner.policy, settings.capabilities, Path(name))
        describe_policy(About(settings.network, settings.capabilities), Path(name))
        for file in Path(name).iterdir():
            file.replace(folder / file.name)
    learner.policy.to(settings.device)


def _iterate(learner: Learner, settings: TrainSettings, progress: Progress) -> Report:
    """Play fresh worlds and learn from them; all randomness comes from seed, rank and iteration."""
    begun = time.perf_counter()
    number, mixture = progress.iteration, settings.worlds_from
    seed = settings.seed * 1_000_003 + number + ranks.rank() * 7_919_993
    generator = torch.Generator(settings.device).manual_seed(seed)
    worlds = training_worlds(mixture, settings.worlds, (settings.seed, number, ranks.rank()))
    env = TeamFormation(worlds, settings.reward.of_environment)
    codec = settings.family.codec(settings.capabilities)
    choose = sampler(learner.policy, generator, settings.device)  # type: ignore[arg-type]
    rollout = play(env, codec, choose, settings.reward, mixture.steps)
    shuffling = torch.Generator().manual_seed(seed)
    seen = update(learner, rollout, settings.ppo, _share(settings, progress), shuffling)
    [seconds] = ranks.agreed([time.perf_counter() - begun], settings.device)
    return _report(env, rollout, progress, seen, seconds)


def _share(settings: TrainSettings, progress: Progress) -> float:
    """Return how much of the training is over, from 0 to 1."""
    of_iterations = progress.iteration / settings.last_iteration
    if settings.minutes is None:
        return of_iterations
    return min(1.0, max(of_iterations, progress.seconds / (60 * settings.minutes)))


def _report(
    env: TeamFormation,
    rollout: Rollout,
    progress: Progress,
    seen: Update,
    seconds: float,
) -> Report:
    steps = int(rollout.is_running.sum()) * ranks.count()
    return Report(
        progress=replace(
            progress,
            iteration=progress.iteration + 1,
            steps=progress.steps + steps,
            seconds=progress.seconds + seconds,
        ),
        steps_per_second=steps / seconds,
        reward=float(rollout.rewards.sum(axis=0).mean()),
        ended=float(rollout.has_ended.mean()),
        decisions=len(rollout.action),
        splits=float(np.mean(env.worlds.count["splits"])),
        update=seen,
        score=None,
    )
