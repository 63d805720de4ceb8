"""Missions from the trees of their files (docs/reference/mission.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from teamformer.base.errors import MissionError
from teamformer.files.trees.pins import Pinned, Pins, apply_pins
from teamformer.files.trees.robots import read_robots
from teamformer.files.trees.tasks import read_tasks
from teamformer.files.trees.values import Given, read
from teamformer.files.trees.world import read_world
from teamformer.files.yaml.reader import Where
from teamformer.files.yaml.tree_reader import Reader
from teamformer.mission.keys.mission_keys import MISSION_KEYS, VERSION
from teamformer.mission.model import Mission, Robot, World
from teamformer.mission.parts.plane import DECIMALS, Plane

RECORD = "teamformer_record"
"""The key that only records have."""

READ_APART = ("teamformer", "world", "robots", "tasks")
"""Keys that are read before others, because the others need them, or by a file of their own."""

BY_METHOD = "delete it, and choose a method with --method"

BY_SUITE = "delete it; suites of bench can set it, under method_settings"

KEYS_OF_METHODS = {
    "order": BY_METHOD,
    "allocation": BY_METHOD,
    "new_tasks": BY_SUITE,
    "foresight": BY_SUITE,
}
"""What files said before methods did: how a mission is solved, not what it is; and what to do."""


def read_tree(reader: Reader, name: str, folder: Path | None) -> Mission | None:
    """Return the mission in a reader's tree, or None after noting what is wrong with it.

    `name` is for a mission without one; map files are looked for in `folder`.
    """
    if isinstance(reader.tree.value, dict) and RECORD in reader.tree.value:
        what = "this is the record of a run, and no mission"
        reader.refuse((RECORD,), f"{what}; name a mission, or use `view`, `check` or `export`")
        return None
    tree = _without_methods(reader)
    top = reader.mapping((), tree, {key.name: key.is_required for key in MISSION_KEYS})
    if not _knows_version(reader, top):
        return None
    world = read_world(reader, top.get("world", {"grid": [1, 1]}), folder)
    given = Given(world, top.get("time"))
    fleet = read_robots(reader, top.get("robots", []), given)
    if isinstance(world, Plane) and "arrival_radius" not in top["world"]:
        world = _with_usual_radius(world, fleet.robots)
    given = replace(given, world=world, named=fleet.named)
    tasks, pins = read_tasks(reader, top.get("tasks", []), given)
    parts: dict[str, Any] = {"name": name, "capabilities": (), "world": world}
    for key in MISSION_KEYS:
        if key.name in top and key.name not in READ_APART:
            parts[key.field] = read(key.kind, reader, (key.name,), top[key.name], given)
    mission = Pinned(parts["capabilities"], fleet.robots, tuple(tasks))
    parts |= vars(_with_pins(reader, top, world, mission, pins))
    if not reader.is_faithful:  # the model would complain about what stands in for the mistakes
        return None
    try:
        return Mission(**parts)
    except MissionError as error:
        told: dict[Where, Where] = {}
        for problem in error.problems:
            where = _in_file(problem.where, fleet.entries)
            if told.setdefault(where, problem.where) == problem.where:  # of robots alike, of one
                reader.refuse(where, problem.message)
        return None


def _in_file(where: Where, entries: Sequence[int]) -> Where:
    """Return where in the file something of the mission is: an entry may be many robots."""
    if len(where) < 2 or where[0] != "robots":
        return where
    return ("robots", entries[int(where[1])], *where[2:])


def _knows_version(reader: Reader, top: Mapping[str, Any]) -> bool:
    version = reader.whole(("teamformer",), top.get("teamformer", VERSION), least=1)
    if version > VERSION:
        reader.tree.problems.clear()  # keys unknown to us may be right there
        reader.refuse(
            ("teamformer",),
            f"this is format {version}, and this teamformer knows up to {VERSION}; "
            "install a newer one",
        )
    return version <= VERSION


def _with_usual_radius(plane: Plane, robots: tuple[Robot, ...]) -> Plane:
    """Let the places of a plane be no wider than what the slowest robot walks in a step."""
    slowest = min((plane.pace(robot.speed) for robot in robots), default=math.inf)
    if not 0 < slowest < plane.arrival_radius:
        return plane
    return replace(plane, arrival_radius=round(slowest, DECIMALS))


def _with_pins(
    reader: Reader, top: Mapping[str, Any], world: World, mission: Pinned, pins: Sequence[Pins]
) -> Pinned:
    """Return a mission with the pins of its tasks said in capabilities."""
    if not any(pin.only or pin.having for pin in pins) or not reader.is_faithful:
        return mission
    if "arrivals" in top:
        message = "tasks that appear at random may need anything, pins too"
        reader.refuse(("arrivals",), f"{message}; drop arrivals, or only and with of the tasks")
    return apply_pins(reader, world, mission, pins)


def _without_methods(reader: Reader) -> Any:
    """Return the file's tree without keys that say how to solve a mission; refuse those."""
    tree = reader.tree.value
    if not isinstance(tree, dict):
        return tree
    for key, remedy in KEYS_OF_METHODS.items():
        if key in tree:
            what = f"'{key}' says how to solve the mission, not what it is"
            reader.refuse((key,), f"{what}; {remedy}")
    return {key: value for key, value in tree.items() if key not in KEYS_OF_METHODS}
