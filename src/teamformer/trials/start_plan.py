"""The plan that a search is to begin with: a record, or what `teamformer plan --json` writes."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_text
from teamformer.files.trees.mission import RECORD
from teamformer.mission.checks.links import linked_with
from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, describe, missing, total
from teamformer.mission.parts.reach import can_reach
from teamformer.mission.precedence import tasks_before
from teamformer.planning.problem.routes import order_of_starts
from teamformer.record.files.reading import read_record
from teamformer.record.record import Record
from teamformer.trials.routes import routes_of

LARGEST = 100_000_000
"""Bytes that a file with a plan may have."""

HINT = "`teamformer plan MISSION --json > FILE` writes one, and so does `--out FOLDER`"


def read_start_plan(path: Path, mission: Mission) -> Plan:
    """Return the plan in a file: who does each task of a mission, and in what order.

    A record is a plan, too: of what was done in it.
    The order is that of the `start` of each task. Tasks that the plan leaves out come last, by as
    few robots as can do them. Raises `TeamformerError` for a file without a plan, and for a plan
    with unknown names, with robots that cannot do their task, or with one that does two tasks whose
    starts are linked.
    """
    try:
        tree = json.loads(read_text(path, LARGEST, HINT))
        rows = _rows_of_record(read_record(path)) if RECORD in tree else _rows(tree)
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


def _rows_of_record(record: Record) -> list[Row]:
    robots, tasks = record.true_mission.robots, record.true_mission.tasks
    return [
        (robots[route.robot].name, tasks[stop.task].name, stop.start)
        for route in routes_of(record)
        for stop in route.stops
    ]


def _plan_of(rows: list[Row], mission: Mission) -> Plan:
    task_of = {task.name: number for number, task in enumerate(mission.tasks)}
    robot_of = {robot.name: number for number, robot in enumerate(mission.robots)}
    robots: list[set[int]] = [set() for _ in task_of]
    start = [math.inf for _ in task_of]
    for robot, task, begins in rows:
        for name, known, what in ((robot, robot_of, "robot"), (task, task_of, "task")):
            if name not in known:
                raise TeamformerError(
                    f"the plan has a {what} '{name}', which is not in {mission.name}",
                    "it is a plan of another mission, or of this one before a change",
                )
        robots[task_of[task]].add(robot_of[robot])
        start[task_of[task]] = begins
    for number, coalition in enumerate(robots):
        if coalition:
            _refuse_unable(mission, number, coalition)
    _refuse_linked(mission, robots)
    linked = linked_with(mission.tasks)
    for number, coalition in enumerate(robots):
        if not coalition:
            taken = set[int]().union(*(robots[other] for other in linked[number]))
            coalition |= _able(mission, number, taken)
    stops = [(robot_of[robot], task_of[task]) for robot, task, _ in rows]
    starts, before = dict(enumerate(start)), tasks_before(mission.tasks)
    instant = {k for k, task in enumerate(mission.tasks) if not task.duration and task.to is None}
    order = order_of_starts(stops, starts, before, instant)
    return Plan(tuple(order), tuple(tuple(sorted(robots[task])) for task in order))


def _refuse_linked(mission: Mission, robots: Sequence[set[int]]) -> None:
    """Refuse a plan in which a robot does two tasks whose starts are linked with one another."""
    tasks = mission.tasks
    for number, others in enumerate(linked_with(tasks)):
        for other in others:
            if both := robots[number] & robots[other]:
                raise TeamformerError(
                    f"the plan gives '{tasks[number].name}' and '{tasks[other].name}' to "
                    f"{mission.robots[min(both)].name}, and their starts are linked",
                    "let different robots do them",
                )


def _refuse_unable(mission: Mission, task: int, coalition: set[int]) -> None:
    wanted, world = mission.tasks[task], mission.world
    coming = [mission.robots[robot] for robot in sorted(coalition)]
    able = total(robot.can for robot in coming if can_reach(world, robot, wanted.at))
    if not covers(able, wanted.needs):
        names = ", ".join(robot.name for robot in coming)
        raise TeamformerError(
            f"the plan gives task '{wanted.name}' to {names}, who cannot do it",
            f"they lack {describe(missing(able, wanted.needs))} there",
        )


def _able(mission: Mission, task: int, taken: set[int]) -> set[int]:
    """Return robots that can do a task together, without one that they could spare.

    None of those are among them that are `taken` by tasks which its start is linked with.
    """
    wanted, robots = mission.tasks[task], mission.robots
    able = {r for r, robot in enumerate(robots) if can_reach(mission.world, robot, wanted.at)}
    able -= taken
    if not covers(total(robots[robot].can for robot in able), wanted.needs):
        raise TeamformerError(
            f"the plan leaves out task '{wanted.name}', whose start is linked, and has nobody left "
            "for it",
            "say in the plan who does it",
        )
    for robot in sorted(able, reverse=True):
        if covers(total(robots[other].can for other in able - {robot}), wanted.needs):
            able.remove(robot)
    return able
