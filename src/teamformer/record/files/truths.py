"""What an uncertain mission really was, as records keep it: only what the mission leaves open."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import zip_longest
from typing import Any

from teamformer.base.errors import MissionError
from teamformer.files.trees.writer import absences_to_tree, counts_to_tree, task_to_tree
from teamformer.mission.model import Absence, Mission, Robot, Task, as_believed
from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.plane import Plane
from teamformer.record.files.values import (
    DamageError,
    amount_of,
    check_keys,
    count_of,
    inside,
    list_of,
    metres,
    number_of,
    rows_of,
    text_of,
    time_of,
)

Number = Callable[[Any], Any]
"""Reads a number: whole in grids and in steps."""


def truth_to_tree(mission: Mission, truth: Mission) -> dict[str, Any]:
    """Return, by name, what tasks took and needed, where they were, and when robots were lost."""
    tasks, robots = {}, {}
    for task, true in zip(mission.tasks, truth.tasks, strict=True):
        said: dict[str, Any] = {}
        if task.lasts is not None:
            said["duration"] = true.duration
        if task.may_need:
            said["needs"] = counts_to_tree(true.needs)
        if task.within:
            said["at"] = list(true.at)
        if said:
            tasks[task.name] = said
    for robot, real in zip(mission.robots, truth.robots, strict=True):
        if robot.has_surprises:
            said = absences_to_tree(real) if robot.breaks else {}
            if robot.delays is not None and robot.delays.seed is None and real.delays is not None:
                said["delays"] = real.delays.seed
            robots[robot.name] = said
    tree: dict[str, Any] = {"tasks": tasks, "robots": robots}
    if mission.arrivals is not None:
        tree["arrivals"] = [
            task_to_tree(task, mission.world) for task in mission.tasks if task.has_arrived
        ]
    return tree


def truth_from_tree(mission: Mission, tree: Any) -> Mission:
    """Return the mission as a record says that it was; raises `DamageError`."""
    parts = ("tasks", "robots", *(("arrivals",) if mission.arrivals else ()))
    check_keys(tree, parts, parts)
    open_tasks = [
        task.name
        for task in mission.tasks
        if task.lasts is not None or task.may_need or task.within
    ]
    open_robots = [robot.name for robot in mission.robots if robot.has_surprises]
    check_keys(tree["tasks"], open_tasks, open_tasks)
    check_keys(tree["robots"], open_robots, open_robots)
    along = metres if isinstance(mission.world, Plane) else number_of
    time = time_of if mission.time == "continuous" else count_of
    tasks = (_task(task, tree["tasks"].get(task.name), along, time) for task in mission.tasks)
    robots = (_robot(robot, tree["robots"].get(robot.name), time) for robot in mission.robots)
    arrived = (_arrived(said, along, time) for said in list_of(tree.get("arrivals", [])))
    there = tuple(robots)
    always = tuple(replace(robot, shifts=(), every=0.0) for robot in there)
    try:
        truth = replace(mission, arrivals=None, tasks=(*tasks, *arrived), robots=always, zones=())
    except MissionError as error:
        raise DamageError(error.problems[0].message) from None
    # what it is need not fit into shifts, nor lie in a zone
    return as_believed(truth, robots=there, zones=mission.zones)


def _task(task: Task, said: Any, along: Number, time: Number) -> Task:
    if said is None:
        return task
    is_open = {
        "duration": task.lasts is not None,
        "needs": bool(task.may_need),
        "at": task.within > 0,
    }
    keys = [key for key, is_unsure in is_open.items() if is_unsure]
    with inside(task.name):
        check_keys(said, keys, keys)
        duration = time(said["duration"]) if "duration" in said else task.duration
        needs = _counts(said["needs"]) if "needs" in said else task.needs
        [[x, y]] = rows_of([said["at"]], 2) if "at" in said else [task.at]
    return task.once_known((along(x), along(y)), needs, duration)


def _arrived(said: Any, along: Number, time: Number) -> Task:
    keys = ("name", "at", "needs", "appears")
    check_keys(said, (*keys, "duration"), keys)
    [[x, y]] = rows_of([said["at"]], 2)
    return Task(
        name=text_of(said["name"]),
        at=(along(x), along(y)),
        needs=_counts(said["needs"]),
        duration=time(said.get("duration", 0)),
        appears=time(said["appears"]),
        has_arrived=True,
    )


def _counts(said: Any) -> Counts:
    if isinstance(said, dict):
        return {name: amount_of(count) for name, count in said.items()}
    if not isinstance(said, list):
        raise DamageError("needs are no counts")
    return {text_of(name): 1 for name in said}


def _robot(robot: Robot, said: Any, time: Number) -> Robot:
    if said is None:
        return robot
    with inside(robot.name):
        is_delayed = robot.delays is not None and robot.delays.seed is None
        keys = [*(("lost", "back") if robot.breaks else ()), *(("delays",) if is_delayed else ())]
        check_keys(said, keys, keys[-1:] if is_delayed else ())
        if robot.delays is not None and is_delayed:
            robot = replace(robot, delays=replace(robot.delays, seed=count_of(said["delays"])))
        if robot.breaks is None:
            return robot
        lost, back = (_times(said.get(key, []), time) for key in ("lost", "back"))
        if len(back) > len(lost):
            raise DamageError("it is back more often than it is lost")
    absences = tuple(Absence(*pair) for pair in zip_longest(lost, back))
    return replace(robot, breaks=None, absences=absences)


def _times(said: Any, time: Number) -> list[Any]:
    return [time(one) for one in (said if isinstance(said, list) else [said])]
