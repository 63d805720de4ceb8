"""Scenario files: YAML or JSON in and out (docs/scenarios.md)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from teamformer.errors import Problem, ScenarioError, TeamformerError
from teamformer.model import Grid, Robot, Scenario, Task
from teamformer.scenarios import yaml_tree
from teamformer.scenarios.reading import Reader
from teamformer.scenarios.worlds import read_world

VERSION = 1
LARGEST_FILE = 20_000_000  # bytes
"""A scenario of a million robots fits; anything larger is not a scenario."""

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
    "order": False,
    "new_tasks": False,
    "allocation": False,
}
ROBOT_KEYS = {"name": False, "at": True, "can": True, "speed": False, "lost": False}
TASK_KEYS = {"name": False, "at": True, "needs": True, "duration": False, "appears": False}


def read_scenario(path: Path) -> Scenario:
    """Read a scenario file; raises `ScenarioError` with every problem in it, each by line.

    Maps are looked for beside the file.
    """
    tree = yaml_tree.parse(_read_text(path))
    return _build(tree, str(path), path.parent)


def scenario_from_tree(value: Any, source: str) -> Scenario:
    """Build a scenario from a tree that is in memory already; `source` names it in errors."""
    return _build(yaml_tree.from_value(value), source, None)


def write_scenario(scenario: Scenario, path: Path) -> None:
    """Write a scenario that needs no other file; JSON if the name ends so, else YAML."""
    tree = scenario_to_tree(scenario)
    if path.suffix == ".json":
        text = json.dumps(tree, indent=1, ensure_ascii=False) + "\n"
    else:
        text = yaml.safe_dump(tree, sort_keys=False, allow_unicode=True, default_flow_style=None)
    path.write_text(text, encoding="utf-8")


def scenario_to_tree(scenario: Scenario) -> dict[str, Any]:
    """Return the tree of a scenario's file, with maps written out as rows."""
    return {
        "teamformer": VERSION,
        "name": scenario.name,
        "world": _world_to_tree(scenario.world),
        "capabilities": list(scenario.capabilities),
        "robots": [_robot_to_tree(robot) for robot in scenario.robots],
        "tasks": [_task_to_tree(task) for task in scenario.tasks],
        **(
            {"teams": [[scenario.robots[r].name for r in team] for team in scenario.teams]}
            if scenario.teams
            else {}
        ),
        "sensing_radius": scenario.sensing_radius,
        "join_radius": scenario.join_radius,
        "forming_steps": scenario.forming_steps,
        "step_limit": scenario.step_limit,
        "order": scenario.order,
        "new_tasks": scenario.new_tasks,
        "allocation": scenario.allocation,
    }


def _world_to_tree(world: Grid) -> dict[str, Any]:
    if not world.rows:
        return {"grid": [world.width, world.height]}
    return {"rows": list(world.rows), "y_axis": world.y_axis}


def _robot_to_tree(robot: Robot) -> dict[str, Any]:
    tree: dict[str, Any] = {
        "name": robot.name,
        "at": list(robot.at),
        "can": _counts_to_tree(robot.can),
    }
    if robot.speed != 1:
        tree["speed"] = robot.speed
    if robot.lost is not None:
        tree["lost"] = robot.lost
    return tree


def _task_to_tree(task: Task) -> dict[str, Any]:
    tree: dict[str, Any] = {
        "name": task.name,
        "at": list(task.at),
        "needs": _counts_to_tree(task.needs),
    }
    if task.duration:
        tree["duration"] = task.duration
    if task.appears:
        tree["appears"] = task.appears
    return tree


def _counts_to_tree(counts: Mapping[str, int]) -> list[str] | dict[str, int]:
    return list(counts) if set(counts.values()) == {1} else dict(counts)


def _read_text(path: Path) -> str:
    """Return what a file says; whatever stands in the way becomes a clear error."""
    try:
        if path.is_dir():
            raise TeamformerError(f"{path}: this is a folder", "name a scenario file in it")
        if path.stat().st_size > LARGEST_FILE:
            raise TeamformerError(f"{path}: larger than {LARGEST_FILE // 10**6} MB, no scenario")
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        hint = "`teamformer generate -o FILE` writes a scenario to start from"
        raise TeamformerError(f"{path}: there is no such file", hint) from None
    except OSError as error:
        raise TeamformerError(f"{path}: cannot be read: {error.strerror}") from None
    except (UnicodeDecodeError, ValueError):
        raise TeamformerError(f"{path}: this is not text, so not a scenario") from None
    return text


def _build(tree: yaml_tree.Tree, source: str, folder: Path | None) -> Scenario:
    reader = Reader(tree)
    scenario = None if tree.value is None else _read(reader, folder)
    if not tree.problems and scenario is not None:
        try:
            return Scenario(**scenario)
        except ScenarioError as error:
            for problem in error.problems:
                reader.refuse(problem.where, problem.message)
    problems = sorted(set(tree.problems))
    raise ScenarioError(
        [Problem((), message) for _, message in problems],
        [
            f"{source}:{line}: {message}" if tree.lines else f"{source}: {message}"
            for line, message in problems
        ],
    )


def _read(reader: Reader, folder: Path | None) -> dict[str, Any]:
    """Read the tree into the arguments of a scenario, noting problems on the way."""
    top = reader.mapping((), reader.tree.value, TOP_KEYS)
    _check_version(reader, top)
    capabilities = reader.names(("capabilities",), top.get("capabilities", []))
    robots = _read_robots(reader, top.get("robots", []))
    read: dict[str, Any] = {
        "name": reader.text(("name",), top.get("name", "unnamed")),
        "world": read_world(reader, top.get("world"), folder),
        "capabilities": tuple(capabilities),
        "robots": robots,
        "tasks": _read_tasks(reader, top.get("tasks", [])),
        "teams": _read_teams(reader, top.get("teams", []), [robot.name for robot in robots]),
    }
    for key in ("sensing_radius", "join_radius"):
        if key in top:
            read[key] = reader.number((key,), top[key], can_be_infinite=True)
    for key, least in (("forming_steps", 0), ("step_limit", 1)):
        if key in top:
            read[key] = reader.whole((key,), top[key], least)
    for key in ("order", "new_tasks", "allocation"):
        if key in top:
            read[key] = reader.text((key,), top[key])
    return read


def _check_version(reader: Reader, top: Mapping[str, Any]) -> None:
    version = reader.whole(("teamformer",), top.get("teamformer", VERSION), least=1)
    if version > VERSION:
        reader.refuse(
            ("teamformer",),
            f"this is format {version}, and this teamformer knows up to {VERSION}; "
            "install a newer one",
        )


def _read_robots(reader: Reader, value: Any) -> tuple[Robot, ...]:
    robots = []
    for number, part in enumerate(reader.sequence(("robots",), value)):
        where = ("robots", number)
        keys = reader.mapping(where, part, ROBOT_KEYS)
        lost = keys.get("lost")
        robots.append(
            Robot(
                name=reader.text((*where, "name"), keys.get("name", f"r{number + 1}")),
                at=reader.place((*where, "at"), keys.get("at", [0, 0])),
                can=reader.counts((*where, "can"), keys.get("can", [])),
                speed=reader.number((*where, "speed"), keys.get("speed", 1.0)),
                lost=None if lost is None else reader.whole((*where, "lost"), lost),
            )
        )
    return tuple(robots)


def _read_tasks(reader: Reader, value: Any) -> tuple[Task, ...]:
    tasks = []
    for number, part in enumerate(reader.sequence(("tasks",), value)):
        where = ("tasks", number)
        keys = reader.mapping(where, part, TASK_KEYS)
        tasks.append(
            Task(
                name=reader.text((*where, "name"), keys.get("name", f"t{number + 1}")),
                at=reader.place((*where, "at"), keys.get("at", [0, 0])),
                needs=reader.counts((*where, "needs"), keys.get("needs", [])),
                duration=reader.whole((*where, "duration"), keys.get("duration", 0)),
                appears=reader.whole((*where, "appears"), keys.get("appears", 0)),
            )
        )
    return tuple(tasks)


def _read_teams(reader: Reader, value: Any, robots: list[str]) -> tuple[tuple[int, ...], ...]:
    teams = []
    for number, part in enumerate(reader.sequence(("teams",), value)):
        where = ("teams", number)
        team = []
        for place, name in enumerate(reader.names(where, part)):
            if name in robots:
                team.append(robots.index(name))
            else:
                reader.refuse(
                    (*where, place), f"there is no robot '{name}'; name one of the robots"
                )
        teams.append(tuple(team))
    return tuple(teams)
