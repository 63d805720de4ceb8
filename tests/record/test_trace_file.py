"""Traces for Perfetto: every robot's time is told without overlap, and flows follow the path."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import pytest

import teamformer as tf
from teamformer.record.export.trace_file import FIRST, MISSION, ROBOTS, TASKS, write_trace
from teamformer.record.phases import IDLE
from teamformer.record.telling.whole import told_of

EXAMPLES = Path(__file__).parents[2] / "examples"


def rows_of(example: str, tmp_path: Path) -> tuple[tf.Trial, list[dict[str, Any]]]:
    trial = tf.run(tf.load(EXAMPLES / f"{example}.yaml"), method="crews")
    write_trace(trial.record, tmp_path / "t.trace.json")
    return trial, json.loads((tmp_path / "t.trace.json").read_text())["traceEvents"]


@pytest.mark.parametrize("example", ["piano", "breakdown"])
def test_what_robots_do_tiles_their_time_but_for_standing_idle(
    example: str, tmp_path: Path
) -> None:
    trial, rows = rows_of(example, tmp_path)
    unit = 1e6 * trial.record.mission.seconds_a_step
    told = told_of(trial.record)
    for robot in range(len(trial.record.mission.robots)):
        own = [row for row in rows if row["ph"] == "X" and row["pid"] == ROBOTS]
        own = sorted((row for row in own if row["tid"] == FIRST + robot), key=lambda row: row["ts"])
        for one, other in itertools.pairwise(own):
            assert one["ts"] + one["dur"] <= other["ts"]
        idle = sum(end - run.begun for end, run in told.runs_of(robot) if run.phase == IDLE)
        assert sum(row["dur"] for row in own) == (len(trial.record.steps) - idle) * unit


def test_services_stand_at_their_tasks_with_who_began_them(tmp_path: Path) -> None:
    trial, rows = rows_of("piano", tmp_path)
    names = [robot.name for robot in trial.record.mission.robots]
    unit = 1e6 * trial.record.mission.seconds_a_step
    services = [row for row in rows if row["ph"] == "X" and row["pid"] == TASKS]
    told = told_of(trial.record).services
    assert len(services) == len(told) > 0
    for row, service in zip(services, told, strict=True):
        assert (row["tid"], row["cat"]) == (FIRST + service.task, service.doing)
        assert row["args"]["robots"] == [names[robot] for robot in service.begun_by]
        assert (row["ts"], row["dur"]) == (
            service.begun * unit,
            (service.ended - service.begun) * unit,
        )


def test_no_track_is_the_main_thread_of_its_process(tmp_path: Path) -> None:
    """Perfetto draws tracks numbered 0, or as their process, as one."""
    _, rows = rows_of("piano", tmp_path)
    assert [row for row in rows if row.get("tid", -1) in (0, row["pid"])] == []


def test_the_end_is_told_on_the_track_of_the_mission(tmp_path: Path) -> None:
    trial, rows = rows_of("piano", tmp_path)
    [end] = [row for row in rows if row["ph"] == "i" and row["pid"] == MISSION]
    assert (end["name"], end["ts"]) == ("completed", trial.makespan * 1e6)
    own = [row for row in rows if row["ph"] == "M" and row["pid"] == MISSION]
    names = [row["args"]["name"] for row in own if row["name"] != "thread_sort_index"]
    assert names == ["mission", trial.record.mission.name]


def test_arrows_go_where_the_path_goes_on_with_another_robot(tmp_path: Path) -> None:
    trial, rows = rows_of("breakdown", tmp_path)
    path = [stretch.robot for stretch in told_of(trial.record).path if stretch.robot >= 0]
    changes = [pair for pair in itertools.pairwise(path) if pair[0] != pair[1]]
    starts = [row["tid"] - FIRST for row in rows if row["ph"] == "s"]
    ends = [row["tid"] - FIRST for row in rows if row["ph"] == "f"]
    assert list(zip(starts, ends, strict=True)) == changes
