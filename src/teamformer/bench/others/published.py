"""What others publish of instances: tables of commas in a folder, or beside it for its name."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from teamformer.base.errors import TeamformerError

Published = dict[str, float]
"""Makespans by method, or costs."""

NUMBER = re.compile(r"\d+(\.\d*)?(e-?\d+)?")
BEST = "best published"
SUMMARY = "best_known"
"""A column that only repeats the best of the others, or a file with the best of each instance."""

SETTING = "setting"
"""The column that names the folder which a row is about."""

ABOVE = "percent_above_best_known"
"""The column of a table in which others report means over a folder."""


@dataclass(frozen=True)
class Reported:
    """A mean over a folder that others report: percent above the best known, and what it took.

    None where they do not say what it took.
    """

    method: str
    cores: float | None
    seconds: float | None
    percent: float
    is_gap: bool = False  # above the optimum instead

    @property
    def label(self) -> str:
        """Return the method with what it took: two rows may be of one method."""
        if self.cores is None or self.seconds is None:
            return self.method
        return f"{self.method}, {self.cores:g} x {self.seconds:g} s"


REPORTED_OF = {
    "sadcher": (
        Reported("SADCHER, greedy", None, None, 6.8, is_gap=True),
        Reported("SADCHER, sampled", None, None, 3.8, is_gap=True),
    )
}
"""Means above the optimum that authors publish of all instances of their kind (SADCHER: of 500)."""


def read_published(folder: Path) -> dict[int, Published]:
    """Return what tables say of a folder's instances, by number.

    A table has a column for each method, or it is named after its method and has `makespan`.
    """
    told: dict[int, Published] = {}
    for path, _, row in _rows_about(folder):
        number = (row.pop("env", None) or row.pop("", None) or "").removeprefix("env_")
        if not number.isdigit():
            continue
        if "makespan" in row:
            row = {BEST if path.stem == SUMMARY else path.stem: row["makespan"]}
        told.setdefault(int(number), {}).update(
            (name, float(value))
            for name, value in row.items()
            if name != SUMMARY and NUMBER.fullmatch(value or "")
        )
    return told


def read_prizes(folder: Path) -> dict[str, float]:
    """Return the best prizes known by instance, from tables with `instance` and `prize`."""
    return {
        row["instance"]: _number(path, line, row, "prize")
        for path, line, row in _rows_about(folder)
        if {"instance", "prize"} <= row.keys()
    }


def read_reported(folder: Path) -> tuple[Reported, ...]:
    """Return the means that others report of a folder."""
    return tuple(
        Reported(
            method=row.get("method") or path.stem,
            cores=_number(path, line, row, "cores"),
            seconds=_number(path, line, row, "seconds"),
            percent=_number(path, line, row, ABOVE),
        )
        for path, line, row in _rows_about(folder)
        if ABOVE in row
    )


def _number(path: Path, line: int, row: dict[str, str], column: str) -> float:
    try:
        number = float(row[column])
    except (KeyError, TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        message = f"{path}:{line}: the column '{column}' holds no number"
        raise TeamformerError(message, "mend it, or take the row out")
    return number


def _rows_about(folder: Path) -> Iterator[tuple[Path, int, dict[str, str]]]:
    """Yield the rows of tables in a folder and, if they name it, of those beside the folder.

    Each comes with its file and its line.
    """
    own, parent = folder.resolve(), folder.resolve().parent
    beside = [path for path in parent.glob("*.csv") if SETTING in _head(path)]
    for path in [*sorted(folder.glob("*.csv")), *sorted(beside)]:
        for line, row in _rows(path):
            if row.pop(SETTING, own.name) == own.name:
                yield path, line, row


def _head(path: Path) -> list[str]:
    """Return the columns that a file of commas begins with."""
    with path.open("rb") as file:
        return file.readline(10_000).decode(errors="replace").strip().split(",")


def _rows(path: Path) -> list[tuple[int, dict[str, str]]]:
    try:
        with path.open(encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            return [
                (reader.line_num, {k: v for k, v in row.items() if k is not None}) for row in reader
            ]
    except (csv.Error, UnicodeDecodeError):
        hint = "mend it, or take it out of the folder"
        raise TeamformerError(f"{path}: this is no table of commas", hint) from None
