"""The plan that a search is to begin with, as `teamformer plan --json` writes it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from teamformer.capabilities import covers, describe, missing, total
from teamformer.coordination import Plan
from teamformer.errors import TeamformerError
from teamformer.mission.precedence import keep_precedence, tasks_before
from teamformer.mission.reach import can_reach
from teamformer.model import Scenario
from teamformer.scenarios.file_access import read_text

LARGEST = 100_000_000
"""Bytes that a file with a plan may have."""

HINT = "`teamformer plan MISSION --json > FILE` writes one"


def read_start_plan(path: Path, mission: Scenario) -> Plan:
    """Return the plan in a file: who does each task of a mission, and in what order.

    The order is that of the `start` of each task. Tasks that the plan leaves out come last, by as
    few robots as can do them. Raises `TeamformerError` for a file without a plan, and for a plan
    with unknown names, or with robots that cannot do their task.
    """
    try:
        rows = _rows(json.loads(read_text(path, LARGEST, HINT)))
    except (ValueError, TypeError, KeyError, RecursionError):
        raise TeamformerError(f"{path}: this is no plan", HINT) from None
    try:
        return _plan_of(rows, mission)
    except TeamformerError as error:
        raise TeamformerError(f"{path}: {error}", error.hint) from None


Row = tuple[str, str, float]
"""A robot, a task that it takes part in, and when that starts."""


def _rows(tree: Any) -> list[Row]:
    return [
        (str(route["robot"]), str(stop["task"]), float(stop["start"]))
        for route in tree["routes"]
        for stop in route["stops"]
    ]


def _plan_of(rows: list[Row], mission: Scenario) -> Plan:
    task_of = {task.name: number for number, task in enumerate(mission.tasks)}
    robot_of = {robot.name: number for number, robot in enumerate(mission.robots)}
    robots: list[set[int]] = [set() for _ in task_of]
    start = [math.inf for _ in task_of]
    for robot, task, begins in rows:
        for name, known, what in ((robot, robot_of, "robot"), (task, task_of, "task")):
            if name not in known:
                raise TeamformerError(
                    f"the plan has a {what} '{name}', which {mission.name} has not",
                    "it is a plan of another mission, or of this one before a change",
                )
        robots[task_of[task]].add(robot_of[robot])
        start[task_of[task]] = begins
    for number, coalition in enumerate(robots):
        if coalition:
            _refuse_unable(mission, number, coalition)
        else:
            coalition |= _able(mission, number)
    order = sorted(task_of.values(), key=start.__getitem__)
    order = keep_precedence(order, tasks_before(mission.tasks))
    return Plan(tuple(order), tuple(tuple(sorted(robots[task])) for task in order))


def _refuse_unable(mission: Scenario, task: int, coalition: set[int]) -> None:
    wanted, world = mission.tasks[task], mission.world
    coming = [mission.robots[robot] for robot in sorted(coalition)]
    able = total(robot.can for robot in coming if can_reach(world, robot, wanted.at))
    if not covers(able, wanted.needs):
        names = ", ".join(robot.name for robot in coming)
        raise TeamformerError(
            f"the plan gives task '{wanted.name}' to {names}, who cannot do it",
            f"they lack {describe(missing(able, wanted.needs))} there",
        )


def _able(mission: Scenario, task: int) -> set[int]:
    """Return robots that can do a task together, without one that they could spare."""
    wanted, robots = mission.tasks[task], mission.robots
    able = {r for r, robot in enumerate(robots) if can_reach(mission.world, robot, wanted.at)}
    for robot in sorted(able, reverse=True):
        if covers(total(robots[other].can for other in able - {robot}), wanted.needs):
            able.remove(robot)
    return able
