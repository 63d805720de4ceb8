"""`teamformer train`: a policy from nothing, and a table of how it comes along."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.base.extras import how_to_install
from teamformer.cli.terminal.console import prepare_folder, say
from teamformer.cli.terminal.interruption import Interruption

if TYPE_CHECKING:
    from teamformer.learning.evaluation import Score
    from teamformer.learning.trainer import IterationReport
    from teamformer.learning.training_settings import TrainSettings

OURS = {"last", "best", "tensorboard"}
"""What a training leaves in its folder."""


@dataclass(frozen=True)
class TrainOptions:
    """What the command line says; `settings` may be the folder of a training to go on with."""

    settings: str | None = None
    folder: Path | None = None
    minutes: float | None = None
    seed: int | None = None


def train(options: TrainOptions) -> int:
    """Train, printing a row for each iteration; return the exit status."""
    begun = time.perf_counter()  # its minutes count loading torch, too
    _refuse_without_torch()
    from teamformer.learning.session import run_session

    settings, folder = _begun(options) if _is_begun(options.settings) else _new(options)
    _prepare(folder)
    try:
        with Interruption():
            table = _Table()
            is_first = run_session(settings, folder, table.show, begun)
    except KeyboardInterrupt:
        say(_how_to_go_on(folder))
        return 1
    if is_first and not (folder / "last").exists():
        say("no iteration was made; nothing is kept")
        return 1
    if is_first and table.rows == 0:
        say("there is no time left for an iteration; --minutes counts all of its time")
    if is_first:
        say(f"the policy is in {folder}; run it with --method {folder}")
    return 0


def _new(options: TrainOptions) -> tuple[TrainSettings, Path]:
    """Return the settings that are asked for, and the folder that the training goes to.

    Raises `TeamformerError` if none are named, and for what is wrong with them.
    """
    from teamformer.learning.settings_files import load_settings, names_of_settings

    if options.settings is None:
        hint = f"name a file of your own, or one of {', '.join(names_of_settings())}"
        raise TeamformerError("which settings?", hint)
    settings = load_settings(options.settings)
    if options.minutes is not None:
        settings = replace(settings, minutes=options.minutes)
    if options.seed is not None:
        settings = replace(settings, seed=options.seed)
    name = f"{Path(options.settings).stem}-{settings.seed}"
    return settings, options.folder or Path("runs", name)


def _is_begun(settings: str | None) -> bool:
    """Say whether this is the folder of a training; settings that are shipped come first."""
    from teamformer.learning.settings_files import names_of_settings

    return settings is not None and settings not in names_of_settings() and Path(settings).is_dir()


def _begun(options: TrainOptions) -> tuple[TrainSettings, Path]:
    """Return the settings that the training in a folder began with, and the folder.

    The time that it may take is new. Raises `TeamformerError` for what is no training.
    """
    from teamformer.learning.checkpoint import read_about
    from teamformer.learning.settings_files import settings_of

    folder = Path(options.settings or "")
    for name, value in {"--out": options.folder, "--seed": options.seed}.items():
        if value is not None:
            what = f"the training in {folder} continues with its own settings"
            raise TeamformerError(what, f"leave {name} out")
    about = read_about(folder / "last")
    try:
        settings = settings_of(about["settings"], str(folder / "last"))
    except (KeyError, MissionError):
        raise TeamformerError(f"{folder / 'last'}: its settings cannot be read") from None
    return replace(settings, minutes=options.minutes), folder


def _prepare(folder: Path) -> None:
    """Make the folder; refuse one that holds what no training has left there."""
    others = {path.name for path in folder.iterdir()} - OURS if folder.is_dir() else set()
    if others:
        what = f"{folder}: holds files that are not of a training, {sorted(others)[0]} for example"
        raise TeamformerError(what, "name another folder with --out")
    prepare_folder(folder)


def _how_to_go_on(folder: Path) -> str:
    from teamformer.learning.checkpoint import ABOUT

    if not (folder / "last" / ABOUT).exists():
        return "stopped in the first iteration; nothing is kept"
    return (
        f"stopped; what the iterations so far have learned is in {folder / 'last'}: the same "
        f"command goes on from there, as does teamformer train {folder}"
    )


def _refuse_without_torch() -> None:
    try:
        import_module("teamformer.learning.trainer")
    except ModuleNotFoundError as error:
        hint = how_to_install("train")
        raise TeamformerError(f"training needs {error.name}, which is missing", hint) from None


class _Table:
    """Rows as they come, one for each iteration, with the exam's where there was one."""

    def __init__(self) -> None:
        self.rows = 0
        self._has_bars = False

    def show(self, report: IterationReport) -> None:
        """Print a report."""
        self.rows += 1
        if self.rows % 20 == 1:
            print(_header(report))
        if report.score is not None and not self._has_bars:
            self._has_bars = True
            print(_bars(report.score))
        print(_row(report), flush=True)


def _header(report: IterationReport) -> str:
    columns = "".join(f"  {name:>9}" for name in report.iteration.figures)
    held_out = "held out: steps in each setting (and of the bar's), failures"
    return f" iter      steps  steps/s{columns}  | {held_out}"


def _bars(score: Score) -> str:
    """Return what scripted policies take on the held-out worlds."""
    told = (
        f"{name} takes " + ", ".join(f"{steps:.1f}" for steps in taken)
        for name, taken in score.bars.items()
    )
    return f"held out: {'; '.join(told)}"


def _row(report: IterationReport) -> str:
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
