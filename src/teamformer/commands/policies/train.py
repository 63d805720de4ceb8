"""`teamformer train`: a policy from nothing, and a table of how it comes along."""

from __future__ import annotations

from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.commands.compiling import announce_compiling
from teamformer.commands.console import ended_like_ctrl_c, prepare_folder, print_json, say
from teamformer.errors import TeamformerError

if TYPE_CHECKING:
    from teamformer.train.evaluation import Score
    from teamformer.train.trainer import Report
    from teamformer.train.training_settings import TrainSettings

OURS = {"last", "best", "tensorboard"}
"""What a training leaves in its folder."""


@dataclass(frozen=True)
class TrainOptions:
    """What the command line says; with `resume`, that folder says what it says nothing of."""

    network: str = "any"
    capabilities: int | None = None
    iterations: int | None = None
    minutes: float | None = None
    worlds: int = 256
    held_out: int = 48
    method: str | None = None
    reward: str = "mission"
    seed: int = 0
    device: str = "cpu"
    folder: Path | None = None
    resume: Path | None = None

    @property
    def place(self) -> Path:
        """Return the folder that the training goes to."""
        made_for = "" if self.capabilities is None else f"-c{self.capabilities}"
        name = f"{self.network}{made_for}-{self.seed}"
        return self.resume or self.folder or Path("runs", name)


def train(options: TrainOptions, as_json: bool) -> int:
    """Train, printing a row for each iteration; return the exit status."""
    _refuse_without_torch()
    from teamformer.train.session import run_session

    folder = options.place
    if options.resume is not None:
        options = _as_it_was(options)
    settings = _settings(options)
    _prepare(folder)
    announce_compiling()
    try:
        with ended_like_ctrl_c():
            table = _Table(as_json)
            is_first = run_session(settings, folder, table.show)
    except KeyboardInterrupt:
        say(_how_to_go_on(folder))
        return 1
    if is_first and not (folder / "last").exists():
        say("no iteration was made; nothing is kept")
        return 1
    if is_first and table.rows == 0:
        say("it has trained for as long already; --minutes counts all of its time")
    if is_first:
        say(f"the policy is in {folder}; run it with --method {folder}")
    return 0


def _prepare(folder: Path) -> None:
    """Make the folder; refuse one that holds what no training has left there."""
    others = {path.name for path in folder.iterdir()} - OURS if folder.is_dir() else set()
    if others:
        what = f"{folder}: holds what is no training's, {sorted(others)[0]} for example"
        raise TeamformerError(what, "name another folder with --out")
    prepare_folder(folder)


def _how_to_go_on(folder: Path) -> str:
    from teamformer.train.checkpoint import ABOUT

    if not (folder / "last" / ABOUT).exists():
        return "stopped in the first iteration; nothing is kept"
    return (
        f"stopped; what the iterations so far have learned is in {folder / 'last'}: the same "
        f"command goes on from there, as does teamformer train --resume {folder}"
    )


def _as_it_was(options: TrainOptions) -> TrainOptions:
    """Return the options that the training to be resumed began with; the limits are new."""
    from teamformer.train.checkpoint import read_about

    folder = options.place
    if not folder.is_dir():
        raise TeamformerError(f"{folder}: there is no such folder", "begin one with --out")
    try:
        begun = read_about(folder / "last")["settings"]
        return replace(
            options,
            network=begun["network"],
            capabilities=begun["capabilities"],
            iterations=begun["iterations"],
            worlds=begun["worlds"],
            held_out=begun.get("held_out", options.held_out),  # which older ones do not say
            method=begun["method"],
            reward="team" if begun["mission_reward"] is None else "mission",
            seed=begun["seed"],
        )
    except (KeyError, TypeError):
        raise TeamformerError(f"{folder / 'last'}: its settings cannot be read") from None


def _refuse_without_torch() -> None:
    try:
        import_module("teamformer.train.trainer")
    except ModuleNotFoundError as error:
        hint = "pip install 'teamformer[train]'"
        raise TeamformerError(f"training needs {error.name}, which is missing", hint) from None


def _settings(options: TrainOptions) -> TrainSettings:
    from teamformer.train.learning.reward_streams import MissionReward, TeamReward
    from teamformer.train.training_settings import TrainSettings

    return TrainSettings(
        network=options.network,
        capabilities=options.capabilities,
        seed=options.seed,
        iterations=options.iterations,
        minutes=options.minutes,
        worlds=options.worlds,
        held_out=options.held_out,
        method=options.method,
        mission_reward=MissionReward() if options.reward == "mission" else None,
        team_reward=TeamReward() if options.reward == "team" else None,
        device=options.device,
    )


class _Table:
    """Rows as they come, one for each iteration, with the exam's where there was one."""

    def __init__(self, as_json: bool) -> None:
        self._as_json = as_json
        self.rows = 0
        self._has_bars = False

    def show(self, report: Report) -> None:
        """Print a report."""
        from teamformer.train.tensorboard import figures

        self.rows += 1
        if self._as_json:
            print_json({"iteration": report.progress.iteration, **figures(report)})
            return
        if self.rows % 20 == 1:
            print(_header(report))
        if report.score is not None and not self._has_bars:
            self._has_bars = True
            print(_bars(report.score))
        print(_row(report), flush=True)


def _header(report: Report) -> str:
    columns = "".join(f"  {name:>9}" for name in report.iteration.figures)
    held_out = "held out: steps in each setting (and of join-all's), failures"
    return f" iter      steps  steps/s{columns}  | {held_out}"


def _bars(score: Score) -> str:
    """Return what scripted policies take on the held-out worlds."""
    bar = ", ".join(f"{steps:.1f}" for steps in score.bar)
    heuristic = ", ".join(f"{steps:.1f}" for steps in score.heuristic)
    return f"held out: join-all (with crews, crews) takes {bar}; heuristic {heuristic}"


def _row(report: Report) -> str:
    progress, score = report.progress, report.score
    columns = "".join(
        f"  {value:>{max(9, len(name))}.5g}" for name, value in report.iteration.figures.items()
    )
    row = f"{progress.iteration:5d} {progress.steps:10,d} {report.steps_per_second:8,.0f}{columns}"
    if score is None:
        return row
    settings = ", ".join(
        f"{steps:.1f} ({ratio:.3f})" for steps, ratio in zip(score.steps, score.ratios, strict=True)
    )
    return f"{row}  | {settings}; {score.failures} of {score.trials} failed"
