"""Instances of others in folders, with the makespans that tables beside them tell."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from teamformer.errors import TeamformerError
from teamformer.model import Scenario
from teamformer.scenarios.file_access import read_text
from teamformer.scenarios.imports import import_missions
from teamformer.scenarios.imports.trees import read_json

Published = dict[str, float]
"""Makespans by method, or costs."""

HINT = "name folders of them: teamformer bench others FOLDER"
NUMBER = re.compile(r"\d+(\.\d*)?(e-?\d+)?")
LARGEST_TABLE = 1_000_000  # bytes
BEST = "best published"
SUMMARY = "best_known"
"""A column that only repeats the best of the others."""


@dataclass(frozen=True)
class Instance:
    """A mission of others, the folder that it belongs to, and what is published of it.

    That are makespans, or costs where plans are judged by a cost.
    """

    collection: str
    mission: Scenario
    published: Published

    @property
    def name(self) -> str:
        """Return a name that no instance of another folder has."""
        return f"{self.collection}/{self.mission.name}"

    @property
    def best(self) -> float | None:
        """Return the best published makespan."""
        return min(self.published.values(), default=None)


def read_instances(folders: Sequence[Path]) -> list[Instance]:
    """Return all instances in folders, each with what tables (`*.csv`) beside it say.

    A folder holds HeteroMRTA's `env_*.json`, DCMRTA's folders `env_*`, SADCHER's JSON files, or
    those of HHCRSP, for which what `*best.md` says is read, in the folder or beside it.
    """
    names = [folder.resolve().name for folder in folders]
    if len(set(names)) < len(names):
        raise TeamformerError("two of the folders have one name", "name each once")
    found = [one for folder in folders for one in _instances_in(folder)]
    if not found:
        raise TeamformerError(
            "there is no instance to measure",
            HINT,
        )
    return found


def _instances_in(folder: Path) -> Iterator[Instance]:
    if not folder.is_dir():
        raise TeamformerError(f"{folder}: this is no folder", HINT)
    tables, best = _read_tables(folder), _read_best(folder)
    for path in sorted(folder.iterdir(), key=_natural):
        form = _form_of(path)
        if form is None:
            continue
        number = re.fullmatch(r"env_(\d+)", path.stem)
        published = tables.get(int(number[1]), {}) if number else best.get(path.name, {})
        for mission in import_missions(form, path):
            yield Instance(folder.resolve().name, mission, published)


def _form_of(path: Path) -> str | None:
    """Return the format of what lies in a folder; None if it is no instance."""
    if path.is_dir() and (path / "graph.yaml").is_file():
        return "dcmrta"
    if path.suffix != ".json":
        return None
    if path.stem.startswith("env_"):
        return "hetero-mrta"
    tree = read_json(path)
    return "hhcrsp" if isinstance(tree.value, dict) and "patients" in tree.value else "sadcher"


def _natural(path: Path) -> tuple[str, int]:
    """Sort `env_2` before `env_10`."""
    number = re.search(r"\d+", path.stem)
    return re.sub(r"\d+", "", path.stem), int(number[0]) if number else 0


def _read_tables(folder: Path) -> dict[int, Published]:
    """Return what tables say, by instance: a column for a method, or a file with `makespan`."""
    told: dict[int, Published] = {}
    for path in sorted(folder.glob("*.csv")):
        for row in _rows(path):
            number = row.pop("env", None) or row.pop("", None) or ""
            if "makespan" in row:
                row = {path.stem: row["makespan"]}
            known = told.setdefault(int(number), {}) if number.isdigit() else {}
            known |= {
                name: float(value)
                for name, value in row.items()
                if name != SUMMARY and NUMBER.fullmatch(value or "")
            }
    return told


def _read_best(folder: Path) -> dict[str, Published]:
    """Return the best costs known by file, from Markdown tables in a folder or beside it."""
    told: dict[str, Published] = {}
    for path in sorted([*folder.glob("*best.md"), *folder.resolve().parent.glob("*_best.md")]):
        lines = read_text(path, LARGEST_TABLE).splitlines()
        rows = [[cell.strip() for cell in line.split("|")] for line in lines]
        for row in rows[1:]:
            told_of = dict(zip(rows[0], row, strict=False))
            if NUMBER.fullmatch(told_of.get("total_cost", "")):
                told[told_of.get("instance", "")] = {BEST: float(told_of["total_cost"])}
    return told


def _rows(path: Path) -> list[dict[str, str]]:
    try:
        with path.open(encoding="utf-8", newline="") as file:
            return [{k: v for k, v in row.items() if k is not None} for row in csv.DictReader(file)]
    except (csv.Error, UnicodeDecodeError):
        hint = "mend it, or take it out of the folder"
        raise TeamformerError(f"{path}: this is no table of commas", hint) from None
