"""Training, new or resumed: iterations on fresh worlds, selection on others."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import torch

from teamformer.learning.algorithms import distributed, global_state
from teamformer.learning.algorithms.optimiser import Learner
from teamformer.learning.budget import Budget
from teamformer.learning.checkpoint import ABOUT, TrainingProgress, load, load_weights, save
from teamformer.learning.evaluation import Exam, Score, examine, prepare_exam
from teamformer.learning.iteration import METHODS, Iteration
from teamformer.learning.nets.critic import Critic, CriticSettings
from teamformer.learning.nets.teamformer import Teamformer
from teamformer.learning.task_exam import TaskExam, examine_tasks, prepare_task_exam
from teamformer.learning.training_settings import TrainSettings
from teamformer.methods.trained_folder import PolicyDescription, describe_policy
from teamformer.mission.model import Mission


@dataclass(frozen=True)
class IterationReport:
    """What there is to say after an iteration."""

    progress: TrainingProgress
    steps_per_second: float  # of worlds, playing and learning
    iteration: Iteration
    score: Score | None  # None where it was not evaluated


def make_learner(settings: TrainSettings) -> Learner:
    """Return fresh networks and optimisers, the same for the same seed."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(settings.seed)
        policy = settings.architecture.make(settings.capabilities)
        if settings.learns_by == "imitation" and isinstance(policy, Teamformer):
            policy.begin_by_copying()
        critic = Critic(
            CriticSettings(
                global_state.TEAM_FEATURES,
                global_state.TASK_FEATURES,
                global_state.WORLD_FEATURES,
                settings.reward.is_per_team,
            )
        )
    policy.to(settings.device)
    critic.to(settings.device)
    rate = settings.update.learning_rate
    return Learner(
        policy,
        critic,
        torch.optim.Adam(policy.parameters(), rate, fused=True),
        torch.optim.Adam(critic.parameters(), rate, fused=True),
        settings.device,
    )


def train(
    settings: TrainSettings,
    folder: Path,
    held_out: Sequence[Sequence[Mission]],
    on_report: Callable[[IterationReport], None] = lambda report: None,
    until: int | None = None,
    exports: bool = True,
    begun: float | None = None,
) -> Learner:
    """Train to the last iteration or minute, or to `until`; go on where the folder stands.

    The folder gets `last`, to resume from, and `best`, the best on the held-out worlds; with
    `exports` both hold the policy as it runs without torch, too. The minutes are counted from
    `begun` on, by `time.perf_counter`, from now if it is None, and what is still to be examined
    and exported counts as well.
    """
    budget = Budget(settings.minutes, settings.device, begun)
    learner, progress = _begin(settings, folder)
    budget.before = progress.seconds
    stop = settings.last_iteration if until is None else until
    is_last = _is_over(settings, progress, budget)
    if is_last or progress.iteration >= stop:
        return learner
    with budget.spent_on("exam"):  # scripted policies sit it, the learned one will
        exam = _prepare(settings, held_out)
    is_exported = False
    while not is_last and progress.iteration < stop:
        report = _iterate(learner, settings, progress, budget)
        progress = report.progress
        is_last = _is_over(settings, progress, budget)
        if progress.iteration % settings.evaluate_every == 0 or is_last:
            with budget.spent_on("exam"):
                score = _examine(learner, settings, exam)
            report = replace(report, score=score)
            if _is_better(score, progress):
                progress = replace(progress, best_cost=score.cost, best_failures=score.failures)
                _keep(folder / "best", learner, settings, progress)
                is_exported = is_last
                if exports:
                    with budget.spent_on("export"):
                        _export(learner, settings, folder / "best", *([folder / "last"] * is_last))
            progress = replace(progress, seconds=budget.seconds)
        _keep(folder / "last", learner, settings, progress)
        on_report(report)
    if exports and not is_exported:
        _export(learner, settings, folder / "last")
    return learner


def _prepare(settings: TrainSettings, held_out: Sequence[Sequence[Mission]]) -> Exam | TaskExam:
    """Return the exam that suits the network: one that reads views plays its worlds."""
    is_dispatching = settings.architecture.codec is None
    return prepare_task_exam(held_out) if is_dispatching else prepare_exam(held_out)


def _examine(learner: Learner, settings: TrainSettings, exam: Exam | TaskExam) -> Score:
    if isinstance(exam, TaskExam):
        return examine_tasks(learner.policy, exam, settings.device)
    codec = settings.architecture.codec_for(settings.capabilities)
    return examine(learner.policy, codec, exam, settings.device)  # type: ignore[arg-type]


def _begin(settings: TrainSettings, folder: Path) -> tuple[Learner, TrainingProgress]:
    learner = make_learner(settings)
    if (folder / "last" / ABOUT).exists():
        return learner, load(folder / "last", learner, _described(settings))
    if settings.begin_from:
        load_weights(Path(settings.begin_from), learner)
    return learner, TrainingProgress()


def _described(settings: TrainSettings) -> dict[str, object]:
    """Return the settings that make a training what it is, as a checkpoint gives them back."""
    described: dict[str, object] = json.loads(json.dumps(asdict(settings)))
    del described["device"], described["minutes"]  # may change when it goes on
    return described


def _is_over(settings: TrainSettings, progress: TrainingProgress, budget: Budget) -> bool:
    """Say whether the last iteration is made, or time allows no other with all that follows it.

    A training that has any time makes one iteration in any case.
    """
    if progress.iteration >= settings.last_iteration:
        return True
    to_come = ("iteration", "exam", "export") if progress.iteration else ()
    return budget.is_spent(*to_come)


def _is_better(score: Score, progress: TrainingProgress) -> bool:
    """Say whether a score has fewer failures than the best, or as many and costs less."""
    return (score.failures, score.cost) < (progress.best_failures, progress.best_cost)


def _keep(
    folder: Path, learner: Learner, settings: TrainSettings, progress: TrainingProgress
) -> None:
    """Write a checkpoint; the first process does."""
    if distributed.rank() == 0:
        said = _described(settings) | {"device": settings.device}
        save(folder, learner, said, progress)


def _export(learner: Learner, settings: TrainSettings, *folders: Path) -> None:
    """Write the policy into folders, as it runs without torch; into each all its files or none."""
    if distributed.rank() > 0:
        return
    with TemporaryDirectory() as name:
        settings.architecture.export(learner.policy, settings.capabilities, Path(name))
        describe_policy(PolicyDescription(settings.network, settings.capabilities), Path(name))
        for folder in folders:
            folder.mkdir(exist_ok=True)
            with TemporaryDirectory(dir=folder) as copied:
                for file in Path(name).iterdir():
                    shutil.copy(file, copied)
                for file in Path(copied).iterdir():
                    file.replace(folder / file.name)
    learner.policy.to(settings.device)


def _iterate(
    learner: Learner, settings: TrainSettings, progress: TrainingProgress, budget: Budget
) -> IterationReport:
    begun = budget.seconds
    done = settings.share_done(progress.iteration, begun)
    with budget.spent_on("iteration"):
        iteration = METHODS[settings.learns_by](learner, settings, progress.iteration, done)
    now = budget.seconds
    progress = replace(
        progress,
        iteration=progress.iteration + 1,
        steps=progress.steps + iteration.steps,
        seconds=now,
    )
    return IterationReport(progress, iteration.steps / (now - begun), iteration, score=None)
