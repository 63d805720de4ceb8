"""Missions as the trees of their files (docs/reference/mission.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from teamformer.files.maps.road_tables import write_times
from teamformer.mission.arrivals import without_arrivals
from teamformer.mission.keys.key import Key
from teamformer.mission.keys.kinds import (
    INFINITE,
    Counts,
    Either,
    KeyedPart,
    KeyedParts,
    Kind,
    NamedParts,
    Number,
    Place,
    Places,
    Shifts,
    StartLinks,
)
from teamformer.mission.keys.mission_keys import MISSION_KEYS, VERSION
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.model import Mission, Robot, Task, World
from teamformer.mission.parts.capabilities import Counts as Brought
from teamformer.mission.parts.capabilities import exact
from teamformer.mission.parts.frame import Frame
from teamformer.mission.parts.grid import Place as At
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import GROUND, Roads


def mission_to_tree(mission: Mission) -> dict[str, Any]:
    """Return the tree of a mission's file, with maps written out as rows."""
    world, tasks = mission.world, without_arrivals(mission).tasks
    apart = {
        "teamformer": VERSION,
        "world": world_to_tree(world),
        "robots": [robot_to_tree(robot, world) for robot in mission.robots],
        "tasks": [task_to_tree(task, world) for task in tasks],
        "teams": tuple([mission.robots[r].name for r in team] for team in mission.teams),
    }
    return part_to_tree(MISSION_KEYS, vars(mission) | apart, world)


def part_to_tree(keys: Sequence[Key], held: Mapping[str, Any], world: World) -> dict[str, Any]:
    """Return a part of a file, without what has its default or is None; `held` is by field."""
    return {
        key.name: to_tree(key.kind, value, world)
        for key in keys
        if (value := held.get(key.field)) is not None
        and (key.is_always_written or value != key.default)
    }


def to_tree(kind: Kind, value: Any, world: World) -> Any:
    """Return a value of a kind as it stands in a file."""
    match kind:
        case Number(can_be_infinite=True):
            return INFINITE if value == math.inf else value
        case Counts():
            return counts_to_tree(value)
        case Place():
            return at_to_tree(value, world)
        case Either():
            return to_tree(kind.listed if isinstance(value, tuple) else kind.plain, value, world)
        case Shifts():
            return [list(window) for window in value]
        case StartLinks():
            return {name: list(gap) for name, gap in value.items()}
        case KeyedParts() if kind.makes:
            return [part_to_tree(kind.keys, vars(part), world) for part in value]
        case Places():
            return [at_to_tree(place, world) for place in value]
        case NamedParts():
            return {part.name: part_to_tree(kind.keys, vars(part), world) for part in value}
        case KeyedPart(makes=""):
            return dict(value)
        case KeyedPart():
            tree = part_to_tree(kind.keys, vars(value), world)
            return tree[kind.alone] if list(tree) == [kind.alone] else tree
    return list(value) if isinstance(value, tuple) else value


def world_to_tree(world: World) -> dict[str, Any]:
    """Return a world as it stands in a file that needs no other."""
    if isinstance(world, Plane):
        return {
            "plane": [world.width, world.height],
            "step": world.step,
            "arrival_radius": world.arrival_radius,
            "unit": world.unit,
        }
    if isinstance(world, Roads):
        tables = {mover: write_times(world, mover) for mover in world.times}
        return {"roads": tables[GROUND] if list(tables) == [GROUND] else tables}
    frame = {} if world.frame is None else {"frame": _frame_to_tree(world.frame)}
    if world.rows:
        return {"rows": list(world.rows), "y_axis": world.y_axis, **frame}
    turned = {} if world.y_axis == "up" else {"y_axis": world.y_axis}
    return {"grid": [world.width, world.height], **turned, **frame}


def _frame_to_tree(frame: Frame) -> dict[str, Any]:
    return {"cell": frame.cell, "origin": [frame.x, frame.y, frame.yaw]}


def at_to_tree(at: At, world: World) -> list[float] | str:
    """Return where something is as it stands in a file."""
    return world.name_of(at) if isinstance(world, Roads) else list(at)


def robot_to_tree(robot: Robot, world: World) -> dict[str, Any]:
    """Return a robot as it stands in a file."""
    return part_to_tree(ROBOT_KEYS, vars(robot) | absences_to_tree(robot), world)


def absences_to_tree(robot: Robot) -> dict[str, Any]:
    """Return when a robot is lost and back: a step each, or lists where it is lost repeatedly."""
    times = {
        "lost": [away.lost for away in robot.absences],
        "back": [away.back for away in robot.absences if away.back is not None],
    }
    is_one = len(robot.absences) == 1
    return {key: steps[0] if is_one else steps for key, steps in times.items() if steps}


def task_to_tree(task: Task, world: World) -> dict[str, Any]:
    """Return a task as it stands in a file."""
    takes = task.duration if task.lasts is None else task.lasts
    return part_to_tree(TASK_KEYS, vars(task) | {"duration": takes}, world)


def counts_to_tree(counts: Brought) -> list[str] | dict[str, float]:
    """Return counts as they stand in a file."""
    if set(counts.values()) == {1}:
        return list(counts)
    return {name: exact(count) for name, count in counts.items()}
