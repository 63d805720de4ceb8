"""A record as a trace for Perfetto and Chrome: a track for each robot and each task.

The format is JSON of Chrome's *Trace Event Format*: complete events (`X`) for what robots do and
for services, instants (`i`) for what happens, flow events (`s`, `f`) along the critical path.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

from teamformer.base.whole_files import write_whole
from teamformer.mission.model import Mission
from teamformer.record.critical_path.stretches import Stretch
from teamformer.record.happenings import events
from teamformer.record.phases import IDLE
from teamformer.record.record import Record
from teamformer.record.telling.whole import told_of
from teamformer.record.told.told_record import ToldRecord
from teamformer.world.rules.constants import NOBODY

ROBOTS, TASKS, MISSION = 1, 2, 3
"""The processes of a trace, as its viewers call groups of tracks."""

FIRST = 11
"""The number of a process's first track. Perfetto takes tracks numbered 0 or as their process for
one and the same, its main thread."""

MICROSECONDS = 1e6

Row = dict[str, Any]


def write_trace(record: Record, path: Path) -> None:
    """Write a trace to open at ui.perfetto.dev or in chrome://tracing."""
    mission, told = record.true_mission, told_of(record)
    unit = MICROSECONDS * mission.seconds_a_step
    rows = [*_names(mission), *_runs(mission, told, unit), *_services(mission, told, unit)]
    rows += [*_happenings(record, unit), *_flows(told.path, unit)]
    tree = {"displayTimeUnit": "ms", "otherData": {"mission": mission.name}, "traceEvents": rows}
    write_whole(path, json.dumps(tree, separators=(",", ":")))


def _names(mission: Mission) -> Iterator[Row]:
    for process, name in ((ROBOTS, "robots"), (TASKS, "tasks"), (MISSION, "mission")):
        yield {"ph": "M", "name": "process_name", "pid": process, "args": {"name": name}}
    robots, tasks = [one.name for one in mission.robots], [one.name for one in mission.tasks]
    for process, names in ((ROBOTS, robots), (TASKS, tasks), (MISSION, [mission.name])):
        for track, name in enumerate(names):
            of = {"pid": process, "tid": FIRST + track}
            yield {"ph": "M", "name": "thread_name", "args": {"name": name}} | of
            yield {"ph": "M", "name": "thread_sort_index", "args": {"sort_index": track}} | of


def _runs(mission: Mission, told: ToldRecord, unit: float) -> Iterator[Row]:
    """Yield what each robot did but stand idle."""
    for robot in range(len(mission.robots)):
        for end, run in told.runs_of(robot):
            if run.phase not in (None, IDLE):
                about = "" if run.task == NOBODY else mission.tasks[run.task].name
                yield _slice(run.begun, end, unit) | {
                    "name": f"{run.phase} {about}".strip(),
                    "cat": run.phase,
                    "pid": ROBOTS,
                    "tid": FIRST + robot,
                    "args": {"task": about},
                }


def _services(mission: Mission, told: ToldRecord, unit: float) -> Iterator[Row]:
    for service in told.services:
        ended = told.length if service.ended is None else service.ended
        names = [mission.robots[robot].name for robot in service.begun_by]
        yield _slice(service.begun, ended, unit) | {
            "name": f"{service.doing} by {', '.join(names)}",
            "cat": service.doing,
            "pid": TASKS,
            "tid": FIRST + service.task,
            "args": {"robots": names},
        }


def _happenings(record: Record, unit: float) -> Iterator[Row]:
    """Yield what happened at one moment, on the track of whom or what it happened to."""
    for event in events(record):
        if event.task is not None:
            process, track = TASKS, event.task
        elif event.robots:
            process, track = ROBOTS, event.robots[0]
        else:
            process, track = MISSION, 0
        yield {
            "ph": "i",
            "name": event.text(record.true_mission),
            "cat": event.kind,
            "ts": event.at * unit,
            "pid": process,
            "tid": FIRST + track,
            "s": "t",  # of this track alone
        }


def _flows(path: tuple[Stretch, ...], unit: float) -> Iterator[Row]:
    """Yield an arrow wherever the critical path goes on with another robot."""
    of_robots = [stretch for stretch in path if stretch.robot != NOBODY]
    for number, (one, other) in enumerate(pairwise(of_robots)):
        if one.robot != other.robot:
            flow = {"name": "critical path", "cat": "critical path", "id": number, "pid": ROBOTS}
            yield flow | {"ph": "s", "tid": FIRST + one.robot, "ts": (one.end - _half(one)) * unit}
            yield flow | {
                "ph": "f",
                "bp": "e",
                "tid": FIRST + other.robot,
                "ts": (other.begin + _half(other)) * unit,
            }


def _half(stretch: Stretch) -> float:
    """Return half a step, or half of what is shorter, so that an arrow lies within its stretch."""
    return min(1.0, abs(stretch.end - stretch.begin)) / 2


def _slice(begin: float, end: float, unit: float) -> Row:
    return {"ph": "X", "ts": begin * unit, "dur": (end - begin) * unit}
