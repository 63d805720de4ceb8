"""Scenarios from the trees of their files (docs/reference/scenarios.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from teamformer.errors import ScenarioError
from teamformer.mission.costs import COST_PARTS
from teamformer.mission.rules import HOME
from teamformer.model import Arrivals, Robot, Scenario, World
from teamformer.plane import DECIMALS, Plane
from teamformer.roads import Roads
from teamformer.scenarios.trees.pins import Pinned, apply_pins, read_pins
from teamformer.scenarios.trees.reader import Reader
from teamformer.scenarios.trees.robots import Fleet, read_robots
from teamformer.scenarios.trees.tasks import read_tasks
from teamformer.scenarios.trees.world import read_at, read_world
from teamformer.scenarios.yaml.reader import Where

VERSION = 1

RECORD = "teamformer_replay"
"""The key that only records have."""

TOP_KEYS = {
    "teamformer": True,  # required
    "name": False,
    "world": True,
    "capabilities": True,
    "robots": True,
    "tasks": True,
    "teams": False,
    "sensing_radius": False,
    "join_radius": False,
    "forming_steps": False,
    "step_limit": False,
    "time": False,
    "ends": False,
    "forming": False,
    "cost": False,
    "finding_radius": False,
    "arrivals": False,
}

BY_METHOD = "delete it, and choose a method with --method"

BY_SUITE = "delete it; suites of bench can set it, under method_settings"

KEYS_OF_METHODS = {
    "order": BY_METHOD,
    "allocation": BY_METHOD,
    "new_tasks": BY_SUITE,
    "foresight": BY_SUITE,
}
"""What files said before methods did: how a mission is solved, not what it is; and what to do."""

ARRIVALS_KEYS = {"rate": True, "until": True, "needs": False, "duration": False}


def read_tree(reader: Reader, name: str, folder: Path | None) -> Scenario | None:
    """Return the scenario in a reader's tree, or None after noting what is wrong with it.

    `name` is for a scenario without one; map files are looked for in `folder`.
    """
    if isinstance(reader.tree.value, dict) and RECORD in reader.tree.value:
        what = "this is the record of a run, and no mission"
        reader.refuse((RECORD,), f"{what}; name a mission, or use `view`, `check` or `export`")
        return None
    top = reader.mapping((), _without_methods(reader), TOP_KEYS)
    if not _knows_version(reader, top):
        return None
    world = read_world(reader, top.get("world", {"grid": [1, 1]}), folder)
    rules = _read_rules(reader, top, world)
    fleet = read_robots(reader, top.get("robots", []), world)
    if isinstance(world, Plane) and "arrival_radius" not in top["world"]:
        world = _with_usual_radius(world, fleet.robots)
    mission = Pinned(
        capabilities=tuple(reader.names(("capabilities",), top.get("capabilities", []))),
        robots=fleet.robots,
        tasks=read_tasks(reader, top.get("tasks", []), world, rules.get("time")),
    )
    mission = _with_pins(reader, top, world, mission, fleet)
    parts = {
        "name": reader.text(("name",), top.get("name", name)),
        "world": world,
        "capabilities": mission.capabilities,
        "robots": mission.robots,
        "tasks": mission.tasks,
        "teams": _read_teams(reader, top.get("teams", []), fleet),
        **rules,
    }
    if not reader.is_faithful:  # the model would complain about what stands in for the mistakes
        return None
    try:
        return Scenario(**parts)
    except ScenarioError as error:
        told: dict[Where, Where] = {}
        for problem in error.problems:
            where = _in_file(problem.where, fleet.entries)
            if told.setdefault(where, problem.where) == problem.where:  # of robots alike, of one
                reader.refuse(where, problem.message)
        return None


def _in_file(where: Where, entries: Sequence[int]) -> Where:
    """Return where in the file something of the scenario is: an entry may be many robots."""
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
    reader: Reader, top: Mapping[str, Any], world: World, mission: Pinned, fleet: Fleet
) -> Pinned:
    """Return a mission with the pins of its tasks said in capabilities."""
    pins, any_are = [], False
    listed = top.get("tasks")
    for number, keys in enumerate(listed if isinstance(listed, list) else ()):
        said = keys if isinstance(keys, dict) else {}
        any_are |= "only" in said or "with" in said
        pins.append(read_pins(reader, ("tasks", number), said, fleet))
    if not any_are or not reader.is_faithful:
        return mission
    if "arrivals" in top:
        message = "tasks that appear at random may need anything, pins too"
        reader.refuse(("arrivals",), f"{message}; drop arrivals, or only and with of the tasks")
    return apply_pins(reader, world, mission, pins)


def _read_teams(reader: Reader, value: Any, fleet: Fleet) -> tuple[tuple[int, ...], ...]:
    parts = enumerate(reader.sequence(("teams",), value))
    return tuple(fleet.read_names(reader, ("teams", number), part) for number, part in parts)


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


def _read_rules(reader: Reader, top: Mapping[str, Any], world: World) -> dict[str, Any]:
    """Return the rules that the file sets; the others keep the model's defaults."""
    rules: dict[str, Any] = {}
    for key in ("sensing_radius", "join_radius", "finding_radius"):
        if key in top:
            rules[key] = reader.number((key,), top[key], can_be_infinite=True)
    for key, least in (("forming_steps", 0), ("step_limit", 1)):
        if key in top:
            rules[key] = reader.whole((key,), top[key], least)
    if "time" in top:
        rules["time"] = reader.word(top["time"])
    if "forming" in top:
        rules["forming"] = reader.number(("forming",), top["forming"])
    if "arrivals" in top:
        rules["arrivals"] = _read_arrivals(reader, top["arrivals"])
    if "cost" in top:
        rules["cost"] = _read_cost(reader, top["cost"])
    if "ends" in top:
        ends = top["ends"]
        is_name = isinstance(world, Roads) and ends != HOME
        is_place = isinstance(ends, list) or is_name
        rules["ends"] = read_at(reader, ("ends",), ends, world) if is_place else reader.word(ends)
    return rules


def _read_arrivals(reader: Reader, value: Any) -> Arrivals:
    said = reader.mapping(("arrivals",), value, ARRIVALS_KEYS)
    most = reader.whole(("arrivals", "needs"), said["needs"], 1) if "needs" in said else 0
    return Arrivals(
        reader.number(("arrivals", "rate"), said.get("rate", 0.0)),
        reader.whole(("arrivals", "until"), said.get("until", 0)),
        most,
        reader.whole(("arrivals", "duration"), said.get("duration", 0)),
    )


def _read_cost(reader: Reader, value: Any) -> dict[str, float]:
    weights = reader.mapping(("cost",), value, dict.fromkeys(COST_PARTS, False))
    return {name: reader.number(("cost", name), weight) for name, weight in weights.items()}
