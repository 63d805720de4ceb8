"""`teamformer train`: a policy from nothing, and a table of how it comes along."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.commands.console import announce_compiling, prepare_folder, print_json, say
from teamformer.errors import TeamformerError

if TYPE_CHECKING:
    from teamformer.train.trainer import Report, TrainSettings


def train(
    network: str,
    capabilities: int | None,
    iterations: int | None,
    minutes: float | None,
    worlds: int,
    held_out: int,
    reward: str,
    seed: int,
    device: str,
    folder: Path | None,
    as_json: bool,
) -> int:
    """Train, printing a row for each iteration; return the exit status."""
    settings = _settings(network, capabilities, iterations, minutes, worlds, reward, seed, device)
    from teamformer.train.session import run_session

    folder = folder or Path("runs", _name(network, capabilities, seed))
    prepare_folder(folder)
    announce_compiling()
    try:
        is_first = run_session(settings, held_out, folder, _Table(as_json).show)
    except KeyboardInterrupt:
        say(f"stopped; the same command goes on from {folder / 'last'}")
        return 1
    if is_first:
        say(f"the policy is in {folder}; run it with --policy {folder}")
    return 0


def _name(network: str, capabilities: int | None, seed: int) -> str:
    made_for = "" if capabilities is None else f"-c{capabilities}"
    return f"{network}{made_for}-{seed}"


def _settings(
    network: str,
    capabilities: int | None,
    iterations: int | None,
    minutes: float | None,
    worlds: int,
    reward: str,
    seed: int,
    device: str,
) -> TrainSettings:
    try:
        from teamformer.train.rewards import MissionReward, TeamReward
        from teamformer.train.trainer import TrainSettings
    except ModuleNotFoundError as error:
        hint = "pip install 'teamformer[train]'"
        raise TeamformerError(f"training needs {error.name}, which is missing", hint) from None
    return TrainSettings(
        network=network,
        capabilities=capabilities,
        seed=seed,
        iterations=iterations,
        minutes=minutes,
        worlds=worlds,
        mission_reward=MissionReward() if reward == "mission" else None,
        team_reward=TeamReward() if reward == "team" else None,
        device=device,
    )


HEADER = (
    " iter      steps  steps/s   return  ended  splits  entropy  clipped"
    "  | held out: steps in each setting (and of join-all's), failures"
)


class _Table:
    """Rows as they come, one for each iteration, with the exam's where there was one."""

    def __init__(self, as_json: bool) -> None:
        self._as_json = as_json
        self._rows = 0

    def show(self, report: Report) -> None:
        """Print a report."""
        from teamformer.train.board import figures

        if self._as_json:
            print_json({"iteration": report.progress.iteration, **figures(report)})
            return
        if self._rows % 20 == 0:
            print(HEADER)
        self._rows += 1
        print(_row(report), flush=True)


def _row(report: Report) -> str:
    update, score = report.update, report.score
    row = (
        f"{report.progress.iteration:5d} {report.progress.steps:10,d} "
        f"{report.steps_per_second:8,.0f} {report.reward:8.3f} {report.ended:6.1%} "
        f"{report.splits:7.2f} {update.entropy:8.3f} {update.clipped:8.3f}"
    )
    if score is None:
        return row
    settings = ", ".join(
        f"{steps:.1f} ({ratio:.3f})" for steps, ratio in zip(score.steps, score.ratios, strict=True)
    )
    return f"{row}  | {settings}; {score.failures} of {score.trials} failed"
