"""Mission files: YAML or JSON in and out (docs/reference/mission.md)."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from teamformer.base.errors import MissionError, Problem, TeamformerError
from teamformer.base.file_access import read_text
from teamformer.base.whole_files import own_number, write_whole
from teamformer.files.trees.mission import read_tree
from teamformer.files.trees.world import read_world
from teamformer.files.trees.writer import mission_to_tree
from teamformer.files.yaml import reader, writer
from teamformer.files.yaml.reader import StopReadingError
from teamformer.files.yaml.tree_reader import Reader
from teamformer.mission.checks.optional import find_hopeless_until
from teamformer.mission.checks.windows import find_hopeless_windows
from teamformer.mission.model import Mission, World

__all__ = [
    "mission_from_tree",
    "mission_to_tree",
    "read_content",
    "read_mission",
    "read_world_of",
    "write_mission",
    "write_tree",
]

LARGEST_FILE = 20_000_000  # bytes
"""A mission of a hundred thousand robots fits; anything larger is not a mission."""
MOST_LINES = 50
"""How many problems are told; nobody mends more at a time."""


Finder = Callable[[Mission], Iterable[Problem]]
"""Finds what keeps a mission from being used for something."""


def read_mission(path: Path, *finders: Finder) -> Mission:
    """Read a mission file; raises `MissionError` with every problem in it, each by line.

    Maps are looked for beside the file. `finders` look for more in a mission that is good.
    """
    return _checked(_parsed(path), path, *finders)


def read_content(content: str | Mapping[str, Any], path: Path) -> Mission:
    """Return the mission that a file would hold, given its text or its tree; writes nothing.

    Raises `MissionError` as `read_mission` does; a tree has no lines.
    """
    if isinstance(content, str):
        return _checked(_parsed_text(content, path), path)
    return _checked(reader.from_value(content), path)


def _checked(tree: reader.Tree, path: Path, *finders: Finder) -> Mission:
    mission = _read(tree, str(path), path.stem, path.parent)
    for find in (find_hopeless_windows, find_hopeless_until, *finders):
        for problem in find(mission):
            tree.refuse(problem.where, problem.message)
    if tree.problems:
        raise error_of(tree, str(path))
    return mission


def read_world_of(path: Path) -> World:
    """Read the world of a mission file, whatever is wrong with its other parts."""
    tree = _parsed(path)
    value = tree.value if isinstance(tree.value, dict) else {}
    world = None
    with suppress(StopReadingError):
        world = read_world(Reader(tree), value.get("world"), path.parent)
    if world is None or tree.problems:
        raise error_of(tree, str(path))
    return world


def _parsed(path: Path) -> reader.Tree:
    hint = "`teamformer generate -o FILE` writes a mission to start from"
    return _parsed_text(read_text(path, LARGEST_FILE, hint), path)


def _parsed_text(text: str, path: Path) -> reader.Tree:
    is_json = path.suffix.lower() == ".json"
    return reader.parse_json(text) if is_json else reader.parse(text)


def mission_from_tree(value: Any, source: str = "mission") -> Mission:
    """Build a mission from a tree that is in memory already; `source` names it in errors."""
    return _read(reader.from_value(value), source, "unnamed", None)


def write_mission(mission: Mission, path: Path, head: str = "") -> None:
    """Write a mission that needs no other file; JSON if the name ends so, else YAML.

    `head` is a line of comment for the beginning of a YAML file.
    """
    write_tree(mission_to_tree(mission), path, head)


def write_tree(tree: Mapping[str, Any], path: Path, head: str = "") -> None:
    """Write the tree of a mission's file, be it that the mission is not complete yet."""
    if path.suffix.lower() == ".json":
        text = json.dumps(tree, indent=1, ensure_ascii=False, allow_nan=False, default=own_number)
        text += "\n"
    else:
        text = f"{head}\n" * bool(head) + writer.to_text(tree)
    try:
        write_whole(path, text)
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        reason = getattr(error, "strerror", None) or error
        raise TeamformerError(
            f"{path}: cannot be written: {reason}", "name a file in a folder that is there"
        ) from None


def _read(tree: reader.Tree, source: str, name: str, folder: Path | None) -> Mission:
    mission = None
    if tree.value is not None or not tree.problems:  # else it has no value because it is broken
        with suppress(StopReadingError):
            mission = read_tree(Reader(tree), name, folder)
    if mission is None or tree.problems:
        raise error_of(tree, source)
    return mission


def error_of(tree: reader.Tree, source: str) -> MissionError:
    """Return what is wrong with a tree, line by line, as an error of its file."""
    found = sorted(dict.fromkeys(tree.problems), key=lambda at: at[0])
    lines = [
        f"{source}:{line}: {problem.message}"
        if tree.is_from_text
        else f"{source}: {problem.message}"
        for line, problem in found[:MOST_LINES]
    ]
    if len(found) > MOST_LINES:
        lines.append(f"{source}: and {len(found) - MOST_LINES} problems more")
    numbered = [replace(it, line=line if tree.is_from_text else None) for line, it in found]
    return MissionError(numbered, lines)
