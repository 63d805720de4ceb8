"""A record as tables for spreadsheets: robots, tasks, events and the bars of a Gantt chart."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path

from teamformer.mission.keys.key import Key
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.model import Robot, Task
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.parts.charging import has_batteries
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.record.happenings import events
from teamformer.record.phases import CHARGING, IDLE, LOADING, OFF, PHASES, QUEUEING, SERVING
from teamformer.record.record import Record
from teamformer.record.task_times import cancelled_steps, known_steps, lateness, missed_tasks
from teamformer.record.telling.whole import told_of
from teamformer.record.told.told_record import ToldRecord
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
    """Yield each robot with the steps, or the time, that it spent in each phase."""
    robots, when = record.mission.robots, "at" if record.is_continuous else "in_step"
    more = _in_details(ROBOT_KEYS, robots)
    away = (f"lost_{when}", f"back_{when}")
    where = _place_columns(record, "")
    are_charged = has_batteries(robots)
    is_told = {OFF: any(robot.shifts for robot in robots)}
    is_told |= {CHARGING: are_charged, QUEUEING: are_charged}
    phases = tuple(phase for phase in PHASES if is_told.get(phase, True))
    yield (
        "robot",
        "capabilities",
        "speed",
        "moves",
        *where,
        *away,
        *phases,
        *(["charge_left"] if are_charged else []),
        *(k.name for k in more),
    )
    lost, back = (_times_by_robot(record, *kinds) for kinds in (("lost", "dry"), ("back",)))
    told = told_of(record)
    for number, robot in enumerate(robots):
        spent = dict.fromkeys(phases, 0.0)
        for end, run in told.runs_of(number):
            spent[run.phase or IDLE] += end - run.begun
        can = describe(robot.can)
        gone = (lost.get(number, ""), back.get(number, ""))
        moves = robot.moves if isinstance(record.mission.world, Roads) else _moves(robot)
        at = _place_cells(record, robot.at)
        said = (getattr(robot, key.field) for key in more)
        yield (
            robot.name,
            can,
            robot.speed,
            moves,
            *at,
            *gone,
            *map(_number, spent.values()),
            *([_charge_left(told, number)] if are_charged else []),
            *said,
        )


def _charge_left(told: ToldRecord, robot: int) -> object:
    """Return how full a battery is in the end, 0 to 1."""
    if not told.levels[robot]:
        return ""
    begun, full, rate = told.levels[robot][-1]
    return _number(min(1.0, max(0.0, full + rate * (told.length - begun))))


def _moves(robot: Robot) -> str:
    return "air" if robot.flies else "ground"


def _place_columns(record: Record, before: str) -> Row:
    """Return the columns of a place: of roads there is one, with its name."""
    is_on_roads = isinstance(record.mission.world, Roads)
    return (f"{before}place",) if is_on_roads else (f"{before}x", f"{before}y")


def _place_cells(record: Record, place: Place | None) -> Row:
    world = record.mission.world
    if isinstance(world, Roads):
        return ("",) if place is None else (world.name_of(place),)
    return ("", "") if place is None else place


def _number(value: float) -> float:
    """Return a number as tables have it: whole without a point, others to six places."""
    return int(value) if float(value).is_integer() else round(value, 6)


def _in_details(keys: Sequence[Key], things: Sequence[object]) -> list[Key]:
    """Return the keys that details show, such as notes, if some thing has them."""
    shown = (key for key in keys if key.is_in_details)
    return [key for key in shown if any(getattr(thing, key.field) for thing in things)]


def _times_by_robot(record: Record, *kinds: str) -> dict[int, str]:
    """Return for each robot that is lost, dry or back, in which steps or at what times that is."""
    times: dict[int, str] = {}
    for entry in events(record):
        for robot in entry.robots if entry.kind in kinds else ():
            when = f"{_number(entry.at)}"
            times[robot] = f"{times[robot]}; {when}" if robot in times else when
    return times


def _tasks(record: Record) -> Iterable[Row]:
    """Yield what each task is, what details show of it, and what became of it."""
    more = _in_details(TASK_KEYS, record.true_mission.tasks)
    places = (*_place_columns(record, ""), "duration", *_place_columns(record, "to_"))
    missed, can_miss = missed_tasks(record), record.mission.until is not None
    became = [f"{what}_{'at' if record.is_continuous else 'in_step'}" for what in BECAME]
    yield (
        *("task", "needs", *places, "unload", "after", "not_before", "due"),
        *(key.name for key in more),
        *("appears", *became, "late_by", "done_by", *(["missed"] if can_miss else [])),
    )
    done = {event.task: event for event in events(record) if event.kind == "done"}
    known, late = known_steps(record), lateness(record)
    begun = {it.task: it.begun for it in told_of(record).services if it.doing in (SERVING, LOADING)}
    cancelled = cancelled_steps(record)
    for number, task in enumerate(record.true_mission.tasks):
        event = done.get(number)
        who = () if event is None else (_name(record, robot) for robot in event.robots)
        appears = "" if known[number] == NEVER else _number(known[number])
        called_off, began = (_number_or_none(it.get(number)) for it in (cancelled, begun))
        ended = _number_or_none(None if event is None else event.at)
        end = (ended, _number_or_none(late.get(task.name)), ", ".join(who))
        said = (getattr(task, key.field) for key in more)
        why = [missed[number][1] if number in missed else ""] if can_miss else []
        yield (*_wanted(record, task), *said, appears, called_off, began, *end, *why)


BECAME = ("cancelled", "begun", "done")
"""What becomes of a task at some time."""


def _number_or_none(value: float | None) -> object:
    return "" if value is None else _number(value)


def _wanted(record: Record, task: Task) -> Row:
    """Return what the mission says of a task."""
    to = (*_place_cells(record, task.to), "" if task.to is None else task.unload)
    after, window = ", ".join(task.after), task.between or ("", "")
    at = _place_cells(record, task.at)
    return (task.name, describe(task.needs), *at, task.duration, *to, after, *window)


def _events(record: Record) -> Iterable[Row]:
    when = ("time",) if record.is_continuous else ("step", "seconds")
    yield (*when, "kind", "robots", "task", "text")
    length = record.mission.seconds_a_step
    for event in events(record):
        names = ", ".join(_name(record, robot) for robot in event.robots)
        task = "" if event.task is None else _task_name(record, event.task)
        seconds = () if record.is_continuous else (round(event.at * length, 6),)
        text = event.text(record.true_mission)
        yield (_number(event.at), *seconds, event.kind, names, task, text)


def _bars(record: Record) -> Iterable[Row]:
    """Yield each robot's runs of one phase and task, between the ends of two steps, or times."""
    yield ("robot", "phase", "task", *_ENDS[record.is_continuous])
    told = told_of(record)
    for robot in range(len(record.mission.robots)):
        for end, run in told.runs_of(robot):
            about = _task_name(record, run.task)
            yield (_name(record, robot), run.phase, about, _number(run.begun), _number(end))


_ENDS = {False: ("from_step", "to_step"), True: ("from", "to")}


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
