"""What the commands share: where words go, folders to write to, progress."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from teamformer.base.errors import ReaderGoneError, TeamformerError
from teamformer.base.whole_files import write_whole

UNFOLDED = 1000  # columns, where no terminal folds the lines


class _Output(Console):
    """A console that says when its reader has left, where Rich would end the process as failed."""

    def on_broken_pipe(self) -> None:
        raise ReaderGoneError


out = _Output(highlight=False, soft_wrap=True, width=None if sys.stdout.isatty() else UNFOLDED)
wide = _Output(highlight=False, width=200)
"""For tables of many columns: a terminal folds their lines, Rich would cut words."""
err = Console(stderr=True, highlight=False, soft_wrap=True)

PATIENCE = 1.0  # seconds before progress is shown
LONG_PATIENCE = 30.0  # seconds between lines where there is no terminal to show it on


def say(message: str) -> None:
    """Tell the person something that is not data."""
    err.print(message, markup=False)


def print_json(row: Mapping[str, Any]) -> None:
    """Print one JSON object on one line."""
    try:
        print(json.dumps(row))
    except BrokenPipeError:
        raise ReaderGoneError from None


def prepare_folder(folder: Path) -> None:
    """Make a folder, and make sure that files can be written there before any work is done."""
    probe = folder / ".teamformer-writes-here"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.touch()
        probe.unlink()
    except (FileExistsError, NotADirectoryError):
        raise TeamformerError(f"{folder}: this is no folder", "name another one") from None
    except OSError as error:
        hint = "name another folder"
        raise TeamformerError(f"{folder}: cannot be written: {error.strerror}", hint) from None


def refuse_existing(path: Path) -> None:
    """Raise `TeamformerError` for a file that is there, as somebody may have written it by hand."""
    if path.exists():
        raise TeamformerError(f"{path}: there is such a file", "remove it, or name another")


def processors() -> int:
    """Return how many processors this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def write_rows(rows: Iterable[Mapping[str, Any]], path: Path) -> None:
    """Write rows as JSON, one a line, and say where they are."""
    write_whole(path, "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows))
    say(f"written: {path}")


def prepare_file(path: Path) -> None:
    """Make sure that a file can be written before any work is done."""
    if path.is_dir():
        raise TeamformerError(f"{path}: this is a folder", "name a file in it")
    prepare_folder(path.parent)


class _Bar:
    """A bar that appears on a terminal once something has taken a while."""

    def __init__(self, *columns: ProgressColumn) -> None:
        self._begun = time.monotonic()
        self._bar = Progress(*columns, console=err, transient=True)
        self._task = self._bar.add_task("", total=None, steps=0)

    def _show(self, completed: int, total: int, steps: int = 0) -> None:
        if not err.is_terminal:  # a bar that is not drawn still ends its line
            return
        self._bar.update(self._task, completed=completed, total=total, steps=steps)
        if not self._bar.live.is_started and time.monotonic() - self._begun > PATIENCE:
            self._bar.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar.live.is_started:
            self._bar.stop()


class Waiting(_Bar):
    """A line that moves on a terminal for as long as something takes: what it is, and seconds."""

    def __init__(self, what: str) -> None:
        super().__init__(SpinnerColumn("line"), TextColumn(what), TimeElapsedColumn())
        if err.is_terminal:
            self._bar.start()


class StepProgress(_Bar):
    """A bar of tasks done that appears on a terminal once a trial has taken a while."""

    def __init__(self, total: int) -> None:
        done = TextColumn("{task.completed}/{task.total} tasks done")
        super().__init__(TextColumn("step {task.fields[steps]}"), BarColumn(), done)
        self._total = total

    def update(self, steps: int, tasks_done: int) -> None:
        """Show how far the trial is."""
        self._show(tasks_done, self._total, steps=steps)


class Counting(_Bar):
    """A bar of how many of something are done, once that has taken a while.

    Where there is no terminal, a line now and then.
    """

    def __init__(self, what: str) -> None:
        many = TextColumn("{task.completed}/{task.total} " + what)
        super().__init__(BarColumn(), many, TimeRemainingColumn())
        self._what, self._told = what, self._begun

    def update(self, done: int, total: int) -> None:
        """Show how many are done."""
        now = time.monotonic()
        if not err.is_terminal and now - self._told > LONG_PATIENCE:
            self._told = now
            say(f"{done}/{total} {self._what}")
        self._show(done, total)


class TimeBar(_Bar):
    """A bar of the time that something takes, which counts it down, with how much is done by now.

    Where there is no terminal, a line now and then.
    """

    def __init__(self, what: str, seconds: float) -> None:
        many = TextColumn("{task.fields[steps]} " + what)
        super().__init__(BarColumn(), many, _SecondsLeft())
        self._what, self._told = what, self._begun
        self._show(0, round(seconds))
        if err.is_terminal:
            self._bar.start()

    def update(self, done: int, seconds_left: float) -> None:
        """Show how much is done, and for how many seconds more it goes on."""
        now = time.monotonic()
        if not err.is_terminal and now - self._told > LONG_PATIENCE:
            self._told = now
            say(f"{done} {self._what}, {seconds_left:.0f} s left")
        spent = now - self._begun
        self._show(round(spent), round(spent + seconds_left), steps=done)


class _SecondsLeft(ProgressColumn):
    """The seconds until the end of a bar of time."""

    def render(self, task: Task) -> Text:
        return Text(f"{max(0.0, (task.total or 0.0) - (task.elapsed or 0.0)):.0f} s left")
