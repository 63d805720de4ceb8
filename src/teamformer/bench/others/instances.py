"""Instances of others in folders, with the makespans that tables beside them tell."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_text
from teamformer.bench.others.published import (
    BEST,
    NUMBER,
    REPORTED_OF,
    Published,
    Reported,
    read_prizes,
    read_published,
)
from teamformer.files.imports import import_missions
from teamformer.files.imports.trees import read_json
from teamformer.mission.model import Mission

HINT = "name folders of them: teamformer bench others FOLDER"
LARGEST_TABLE = 1_000_000  # bytes


@dataclass(frozen=True)
class Instance:
    """A mission of others, the folder that it belongs to, and what is published of it.

    That are makespans, costs where plans are judged by a cost, or the prizes that are missed where
    tasks are optional.
    """

    collection: str
    mission: Mission
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
    those of HHCRSP, for which what `*best.md` says is read, in the folder or beside it, or Chao's
    `p*.txt`. A folder without instances stands for the folders in it.
    """
    collections = [inner for folder in _told_apart(folders) for inner in collections_in(folder)]
    found = [one for folder in _told_apart(collections) for one in _instances_in(folder)]
    if not found:
        raise TeamformerError(
            "there is no instance to measure",
            HINT,
        )
    return found


def reported_of(folder: Path) -> tuple[Reported, ...]:
    """Return what authors publish of all instances of the kind that a folder holds."""
    forms = (_form_of(path) for path in sorted(folder.iterdir(), key=_natural))
    return REPORTED_OF.get(next((form for form in forms if form), ""), ())


def _told_apart(folders: Sequence[Path]) -> Sequence[Path]:
    """Return folders as they are; raises `TeamformerError` if two have one name."""
    if len({folder.resolve().name for folder in folders}) < len(folders):
        raise TeamformerError("two of the folders have one name", "name each once")
    return folders


def collections_in(folder: Path) -> list[Path]:
    """Return a folder, or the folders in it if these hold instances and it holds none itself."""
    if not folder.is_dir():
        raise TeamformerError(f"{folder}: this is no folder", HINT)
    if any(_form_of(path) for path in folder.iterdir()):
        return [folder]
    inner = [path for path in sorted(folder.iterdir(), key=_natural) if path.is_dir()]
    return [path for path in inner if any(_form_of(each) for each in path.iterdir())]


def _instances_in(folder: Path) -> Iterator[Instance]:
    tables, best, prizes = read_published(folder), _read_best(folder), read_prizes(folder)
    for path in sorted(folder.iterdir(), key=_natural):
        form = _form_of(path)
        if form is None:
            continue
        number = re.fullmatch(r"(?:env|p)_(\d+)", path.stem)
        published = tables.get(int(number[1]), {}) if number else best.get(path.name, {})
        for mission in import_missions(form, path):
            assert isinstance(mission, Mission), "a site is no instance"
            if path.stem in prizes:
                published = {BEST: prize_of(mission) - prizes[path.stem]}
            yield Instance(folder.resolve().name, mission, published)


def _form_of(path: Path) -> str | None:
    """Return the format of what lies in a folder; None if it is no instance."""
    if path.is_dir() and (path / "graph.yaml").is_file():
        return "dcmrta"
    if re.fullmatch(r"p\d\.\d\.[a-z]\.txt", path.name):
        return "top"
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


def prize_of(mission: Mission) -> float:
    """Return what all optional tasks of a mission weigh together."""
    return sum(task.weight for task in mission.tasks if task.optional)
