"""Drafts of missions: checked with the words of the file reader, opened, written."""

from __future__ import annotations

import json
import math
import re
import secrets
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.maps.formats import is_map, read_coarse_map
from teamformer.files.mission_files import mission_from_tree, mission_to_tree, read_mission
from teamformer.files.trees.writer import world_to_tree
from teamformer.files.yaml import reader, writer
from teamformer.live.drawing.comments import rewrite
from teamformer.mission.checks.rules import rules_not_run
from teamformer.mission.keys.kinds import INFINITE
from teamformer.mission.model import Mission

Tree = dict[str, Any]

EMPTY: Tree = {
    "teamformer": 1,
    "name": "new mission",
    "world": {"grid": [16, 10]},
    "capabilities": ["lift", "scan"],
    "robots": [],
    "tasks": [],
}
EXAMPLE: Tree = EMPTY | {
    "name": "example",
    "robots": [
        {"name": "r1", "at": [1, 2], "can": ["lift"]},
        {"name": "r2", "at": [1, 4], "can": ["lift"]},
        {"name": "r3", "at": [1, 7], "can": ["scan"]},
    ],
    "tasks": [
        {"name": "t1", "at": [6, 7], "needs": ["scan"]},
        {"name": "t2", "at": [9, 2], "needs": {"lift": 2}, "duration": 3},
        {"name": "t3", "at": [13, 5], "needs": ["lift", "scan"]},
    ],
}
"""What the editor begins with: a mission that runs, to be changed."""


@dataclass(frozen=True)
class Draft:
    """What is drawn: the tree of a mission file, the name of its file, and its text if YAML.

    `id` is the drawing's own: pages say by it on what they have drawn.
    """

    tree: Any
    file: str = "mission.yaml"
    text: str = ""
    id: str = field(default_factory=lambda: secrets.token_hex(8))


FILE_NAME = re.compile(r"[\w-][\w .-]{0,99}\.(yaml|yml|json)")


def problems_of(tree: object) -> list[Tree]:
    """Return what is wrong with a draft, each with its place in the tree; nothing if it is good."""
    try:
        problems = list(rules_not_run(mission_from_tree(tree)))
    except MissionError as error:
        problems = list(error.problems)
    return [{"where": list(p.where), "message": p.message} for p in problems]


def can_be_drawn(tree: object) -> bool:
    """Say whether a draft, however wrong, has the parts that a page needs to draw it."""
    if not isinstance(tree, dict) or not isinstance(tree.get("world"), dict):
        return False
    lists = [tree.get(key) for key in ("capabilities", "robots", "tasks")]
    return all(isinstance(part, list) for part in lists) and all(
        isinstance(thing, dict) and isinstance(thing.get("at"), list)
        for part in lists[1:]
        for thing in part or ()
    )


def read_draft(tree: object) -> Mission:
    """Return the mission of a draft that can be run; TeamformerError says why it cannot."""
    problems = problems_of(tree)
    if problems:
        raise TeamformerError("; ".join(problem["message"] for problem in problems))
    return mission_from_tree(tree)


def open_draft(name: str, text: str, beside: Mapping[str, bytes] | None = None) -> Tree:
    """Return the draft in the text of a mission file, or an empty one on a map.

    `beside` holds the other files that were chosen with it, by name: the image of a ROS map, the
    map that a mission names. The tree is as the file has it, without what it left out, but with
    the map in place of its file.
    """
    kind = Path(name).suffix.lower()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"draft{kind}"
        path.write_text(text, encoding="utf-8")
        for other, content in (beside or {}).items():
            (Path(folder) / Path(other).name).write_bytes(content)
        try:
            if is_map(name, text):
                return EMPTY | {
                    "name": Path(name).stem,
                    "world": dict(world_to_tree(read_coarse_map(path))),
                }
            return draft_of_file(path, Path(name).stem)
        except TeamformerError as error:
            message = str(error).replace(str(path), name).replace(f"{folder}/", "")
            raise TeamformerError(message, error.hint) from None


def draft_of_file(path: Path, name: str) -> Tree:
    """Return the draft in a mission file, of that name if the file has none.

    TeamformerError says what is wrong with the file.
    """
    mission = read_mission(path)
    text = path.read_text(encoding="utf-8")
    tree = reader.parse_json(text) if path.suffix.lower() == ".json" else reader.parse(text)
    assert isinstance(tree.value, dict)  # or it would have been refused
    draft = {"name": name} | tree.value
    if "map" in draft["world"]:
        draft["world"] = mission_to_tree(mission)["world"]
    return _plain(draft)


def write_draft(tree: Mapping[str, Any], name: object, folder: Path, opened: str = "") -> Path:
    """Write a good draft into a folder, as it is, without defaults that nobody chose.

    `opened` is the text of the YAML file that it comes from, whose comments are kept.
    """
    if not isinstance(name, str) or not FILE_NAME.fullmatch(name):
        raise TeamformerError(
            "name a file in the folder, such as mission.yaml: letters, digits, '-', '_' and a dot"
        )
    read_draft(tree)
    path = folder / name
    if path.suffix == ".json":
        text = json.dumps(tree, indent=1, ensure_ascii=False)
    else:
        text = (opened and rewrite(opened, tree)) or writer.to_text(dict(tree))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise TeamformerError(f"{path}: cannot be written: {error.strerror}") from None
    return path


def _plain(tree: Tree) -> Tree:
    """Return a file's tree in the one form of several that pages and the writer know."""
    radii = {
        key: INFINITE for key in ("sensing_radius", "join_radius") if tree.get(key) == math.inf
    }
    world = tree["world"]
    if isinstance(world.get("rows"), str):
        world = world | {"rows": world["rows"].split()}
    return tree | radii | {"world": world}
