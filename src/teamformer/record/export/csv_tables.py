"""A record as tables for spreadsheets: robots, tasks, events and the bars of a Gantt chart."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

from teamformer.mission.keys.key import Key
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.model import Task
from teamformer.mission.parts.capabilities import describe
from teamformer.record.happenings import events
from teamformer.record.phases import LOADING, PHASES, SERVING
from teamformer.record.record import Record
from teamformer.record.task_times import cancelled_steps, known_steps, lateness
from teamformer.record.telling.whole import told_of
from teamformer.world.rules.constants import NEVER, NOBODY

Row = Sequence[object]


def write_tables(record: Record, folder: Path) -> tuple[Path, ...]:
    """Write `robots.csv`, `tasks.csv`, `events.csv` and `gantt.csv` into a folder."""
    tables = {
        "robots": _robots(record),
        "tasks": _tasks(record),
        "events": _events(record),
        "gantt": _bars(record),
    }
    return tuple(_write(folder / f"{name}.csv", rows) for name, rows in tables.items())


def _robots(record: Record) -> Iterable[Row]:
    """Yield each robot with the steps it spent in each phase."""
    places = ("x", "y", "lost_in_step", "back_in_step")
    robots = record.mission.robots
    more = _in_details(ROBOT_KEYS, robots)
    yield ("robot", "capabilities", "speed", "moves", *places, *PHASES, *(key.name for key in more))
    lost = _steps_by_robot(step.lost for step in record.steps)
    back = _steps_by_robot(step.back for step in record.steps)
    for number, robot in enumerate(robots):
        runs = list(told_of(record).runs_of(number))
        spent = [sum(end - it.begun for end, it in runs if it.phase == phase) for phase in PHASES]
        can = describe(robot.can)
        away = (lost.get(number, ""), back.get(number, ""))
        moves = "air" if robot.flies else "ground"
        said = (getattr(robot, key.field) for key in more)
        yield (robot.name, can, robot.speed, moves, *robot.at, *away, *spent, *said)


def _in_details(keys: Sequence[Key], things: Sequence[object]) -> list[Key]:
    """Return the keys that details show, such as notes, if some thing has them."""
    shown = (key for key in keys if key.is_in_details)
    return [key for key in shown if any(getattr(thing, key.field) for thing in things)]


def _steps_by_robot(robots_of_steps: Iterable[tuple[int, ...]]) -> dict[int, str]:
    """Return for each robot that something happens to in which steps that is."""
    steps: dict[int, str] = {}
    for number, robots in enumerate(robots_of_steps, start=1):
        for robot in robots:
            steps[robot] = f"{steps[robot]}; {number}" if robot in steps else str(number)
    return steps


WANTED = (
    *("task", "needs", "x", "y", "duration", "to_x", "to_y", "unload"),
    *("after", "not_before", "due"),
)
BECAME = ("appears", "cancelled_in_step", "begun_in_step", "done_in_step", "late_by", "done_by")
"""Columns of tasks: what each is, and what became of it; between them is what details show."""


def _tasks(record: Record) -> Iterable[Row]:
    """Yield what each task is, and what became of it."""
    more = _in_details(TASK_KEYS, record.true_mission.tasks)
    yield (*WANTED, *(key.name for key in more), *BECAME)
    done = {event.task: event for event in events(record) if event.kind == "done"}
    known, late = known_steps(record), lateness(record)
    begun = {it.task: it.begun for it in told_of(record).services if it.doing in (SERVING, LOADING)}
    cancelled = cancelled_steps(record)
    for number, task in enumerate(record.true_mission.tasks):
        event = done.get(number)
        who = () if event is None else (_name(record, robot) for robot in event.robots)
        appears = "" if known[number] == NEVER else known[number]
        called_off, began = cancelled.get(number, ""), begun.get(number, "")
        end = ("" if event is None else event.step, late.get(task.name, ""), ", ".join(who))
        said = (getattr(task, key.field) for key in more)
        yield (*_wanted(task), *said, appears, called_off, began, *end)


def _wanted(task: Task) -> Row:
    """Return what the mission says of a task."""
    to = ("", "", "") if task.to is None else (*task.to, task.unload)
    after, window = ", ".join(task.after), task.between or ("", "")
    return (task.name, describe(task.needs), *task.at, task.duration, *to, after, *window)


def _events(record: Record) -> Iterable[Row]:
    yield ("step", "seconds", "kind", "robots", "task", "text")
    length = record.mission.seconds_a_step
    for event in events(record):
        names = ", ".join(_name(record, robot) for robot in event.robots)
        task = "" if event.task is None else record.mission.tasks[event.task].name
        seconds = round(event.step * length, 6)
        yield (event.step, seconds, event.kind, names, task, event.text(record.true_mission))


def _bars(record: Record) -> Iterable[Row]:
    """Yield each robot's runs of one phase and task, between the ends of two steps."""
    yield ("robot", "phase", "task", "from_step", "to_step")
    for robot in range(len(record.mission.robots)):
        for end, run in told_of(record).runs_of(robot):
            task = _task_name(record, run.task)
            yield (_name(record, robot), run.phase, task, run.begun, end)


def _name(record: Record, robot: int) -> str:
    return record.mission.robots[robot].name


def _task_name(record: Record, task: int) -> str:
    return "" if task == NOBODY else record.mission.tasks[task].name


def _write(path: Path, rows: Iterable[Row]) -> Path:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([_harmless(value) for value in row] for row in rows)
    return path


def _harmless(value: object) -> object:
    """Keep spreadsheets from taking a name for a formula, by an apostrophe before it.

    What begins with an apostrophe gets one more, so that who takes one away has the name.
    """
    is_risky = isinstance(value, str) and value[:1] in ("=", "+", "-", "@", "'")
    return f"'{value}" if is_risky else value
