"""The folder of a benchmark: rows appended as they come, one benchmark at a time, resumable."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_text
from teamformer.base.naming import listed
from teamformer.bench.rows import Key, Row, row_of, with_bars

ROWS, BROKEN, ABOUT, LOCK = "rows.jsonl", "broken-rows.txt", "bench.json", ".lock"
FORMAT = 2
LARGEST_ROWS = 2_000_000_000  # bytes


@dataclass(frozen=True)
class BenchmarkDescription:
    """What all rows of a folder have in common; trials and methods may be added later."""

    suite: str
    first_seed: int
    rules: dict[str, Any]
    worlds: str = ""  # stamp of the files that worlds were read from
    format: int = FORMAT


class Store:
    """Rows in a folder; use it in a `with` statement, which keeps others out.

    Entering raises `TeamformerError` if the folder belongs to another benchmark or is in use.
    Lines that are no rows are set aside into `broken-rows.txt`, and `say` is told.
    """

    def __init__(
        self, folder: Path, about: BenchmarkDescription, say: Callable[[str], None]
    ) -> None:
        self.folder = folder
        self.rows: dict[Key, Row] = {}
        self._about, self._say = about, say
        self._lock = self._file = -1

    def __enter__(self) -> Store:
        self._lock = lock_folder(self.folder)
        try:
            self._begin()
        except BaseException:
            os.close(self._lock)
            raise
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._file)
        os.close(self._lock)  # and with it the lock goes

    def add(self, rows: Iterable[Row]) -> None:
        """Append rows, each in one write; what was there already stays as it was."""
        for row in rows:
            if row.key not in self.rows:
                self.rows[row.key] = row
                _write_all(self._file, row.to_line().encode())

    def forget(self, keys: Iterable[Key]) -> None:
        """Take rows out, so that their trials are run again."""
        for key in keys:
            del self.rows[key]
        self._rewrite()

    def finish(self, order: Callable[[Row], Any]) -> None:
        """Put all rows in order, with best makespans and bounds filled in."""
        rows = with_bars(sorted(self.rows.values(), key=order))
        self.rows = {row.key: row for row in rows}
        self._rewrite()

    def _begin(self) -> None:
        self._check_about()
        if self._read_rows():
            self._rewrite()
        else:
            self._open()

    def _open(self) -> None:
        flags = os.O_CREAT | os.O_WRONLY | os.O_APPEND
        self._file = os.open(self.folder / ROWS, flags, 0o644)

    def _check_about(self) -> None:
        """Refuse a folder of another benchmark; sign one that is new."""
        path, ours = self.folder / ABOUT, asdict(self._about)
        if not path.exists():
            if (self.folder / ROWS).exists():
                what = f"{self.folder}: holds rows, but no {ABOUT} that says what they are"
                raise TeamformerError(what, "name another folder")
            replace_text(path, json.dumps(ours, indent=1) + "\n")
            return
        try:
            theirs = json.loads(read_text(path, 1_000_000))
            differing = [key for key in ours if theirs.get(key) != ours[key]]
        except (ValueError, AttributeError):
            raise TeamformerError(f"{path}: cannot be understood", "name another folder") from None
        if differing:
            told = [f"{key} {theirs.get(key)!r}, not {ours[key]!r}" for key in differing]
            what = f"{self.folder}: holds rows of another benchmark: {'; '.join(told)}"
            raise TeamformerError(what, "name another folder, or ask for the same again")

    def _read_rows(self) -> bool:
        """Read the rows there are; return whether the file has to be put in order."""
        path = self.folder / ROWS
        if not path.exists():
            return False
        text = path.read_bytes().decode("utf-8", errors="replace")
        lines = text.split("\n")
        broken = []
        for number, line in enumerate(lines, start=1):
            row = row_of(line)
            if row is not None:
                self.rows.setdefault(row.key, row)
            elif line:
                broken.append((number, line))
        if broken:
            set_aside(path, broken, self._say)
        return bool(broken) or not text.endswith("\n")

    def _rewrite(self) -> None:
        replace_text(self.folder / ROWS, "".join(row.to_line() for row in self.rows.values()))
        if self._file != -1:
            os.close(self._file)
        self._open()


def read_folder(folder: Path) -> tuple[BenchmarkDescription, list[Row]]:
    """Return what a finished benchmark's folder holds."""
    try:
        about = BenchmarkDescription(**json.loads(read_text(folder / ABOUT, 1_000_000)))
    except (ValueError, TypeError):
        raise TeamformerError(f"{folder / ABOUT}: cannot be understood") from None
    lines = read_text(folder / ROWS, LARGEST_ROWS).splitlines()
    return about, [row for row in map(row_of, lines) if row]


def folders_beside(folder: Path) -> list[Path]:
    """Return the folders of benchmarks of other suites beside a benchmark's folder.

    Raises `TeamformerError` for one that cannot be read.
    """
    others = sorted(about.parent for about in folder.resolve().parent.glob(f"*/{ABOUT}"))
    others = [other for other in others if other != folder.resolve()]
    suites = {other: read_folder(other)[0].suite for other in others}
    ours = read_folder(folder)[0].suite if (folder / ABOUT).exists() else ""
    return [other for other, suite in suites.items() if suite != ours]


def lock_folder(folder: Path) -> int:
    """Keep other benchmarks out of a folder until the descriptor that is returned is closed.

    Raises `TeamformerError` if another one is at work in it.
    """
    lock = os.open(folder / LOCK, os.O_CREAT | os.O_RDWR, 0o644)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(lock)
        hint = "wait until it is done, or name another folder"
        raise TeamformerError(f"{folder}: another bench is at work here", hint) from None
    return lock


def set_aside(path: Path, broken: Sequence[tuple[int, str]], say: Callable[[str], None]) -> None:
    """Keep lines of a file that are no rows, with their numbers, beside it, and say so."""
    beside = path.with_name(BROKEN)
    with beside.open("a", encoding="utf-8") as file:
        file.writelines(f"{path.name}:{number}: {line}\n" for number, line in broken)
    numbers = listed((number for number, _ in broken), 5)
    plural = "s" if len(broken) > 1 else ""
    say(
        f"{path}: line{plural} {numbers} cannot be read; set aside into "
        f"{beside.name}, and the trial{plural} will be run again"
    )


def replace_text(path: Path, text: str) -> None:
    """Write a file such that there is always either the old one or all of the new one."""
    draft = path.with_name(f".{path.name}.new")
    with suppress(FileNotFoundError):
        draft.unlink()
    with draft.open("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        os.fsync(file.fileno())
    draft.replace(path)


def _write_all(file: int, data: bytes) -> None:
    while data:
        data = data[os.write(file, data) :]
