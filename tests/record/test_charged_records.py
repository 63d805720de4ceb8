"""Records of missions with batteries: the referee follows them, and finds what is forged."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

import teamformer as tf
from charged_keys import drawn_with
from charging_missions import Planned, charged_mission, run_course
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Grid
from teamformer.record.critical_path.stretches import DOINGS
from teamformer.record.critical_path.words import SHARES, VERBS, why_so_late
from teamformer.record.events.path import path_along_causes
from teamformer.record.events.whole import tell_events
from teamformer.record.export.csv_tables import write_tables
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.phases import CHARGING
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.told.told_record import ToldRecord
from teamformer.world.continuous.events import Event


def disturbed(seed: int) -> Mission:
    """Draw a mission in which robots are lost and back and tasks appear."""
    mission, rng = charged_mission(seed, tasks=8), random.Random(seed)
    robots = tuple(
        replace(robot, absences=(Absence(rng.randint(10, 60), rng.randint(70, 120)),))
        if rng.random() < 0.5
        else robot
        for robot in mission.robots
    )
    tasks = tuple(
        replace(task, appears=rng.randint(1, 90)) if rng.random() < 0.3 else task
        for task in mission.tasks
    )
    return replace(mission, robots=robots, tasks=tasks)


@pytest.mark.parametrize("seed", range(10))
def test_what_is_played_is_legal(seed: int) -> None:
    mission = disturbed(seed)
    record = tf.run(mission).record
    assert judge(record).findings == ()
    assert record_from_tree(record_to_tree(record), "a test") == record


@cache
def played() -> Record:
    """Return a record in which robots charge and queue."""
    mission = charged_mission(1, tasks=8)
    return tf.run(mission).record


def test_who_charges_is_told_in_words_and_in_tables(tmp_path: Path) -> None:
    path = path_along_causes(played())
    [first, *lines] = why_so_late(played().true_mission, path)
    charged = sum(it.end - it.begin for it in path if it.doing == CHARGING)
    assert f"{charged:g} charging" in first
    assert any(" charges " in line for line in lines)
    assert VERBS.keys() == SHARES.keys() == {*DOINGS}
    write_tables(played(), tmp_path)
    assert (
        (tmp_path / "robots.csv")
        .read_text()
        .splitlines()[0]
        .endswith("idle,lost,charging,queueing,charge_left")
    )


def forged(number: int, **changes: object) -> Record:
    events = list(played().events)
    events[number] = events[number]._replace(**changes)
    return replace(played(), events=tuple(events))


def find(kind: str) -> tuple[int, Event]:
    return next((n, event) for n, event in enumerate(played().events) if event.kind == kind)


def test_forged_charges_are_found() -> None:
    assert judge(played()).findings == ()
    number, event = find("charge")
    assert event.until is not None
    assert judge(forged(number, until=event.until - 1)).findings
    assert judge(forged(number, place=(1.0, 1.0))).findings
    number, event = find("charged")
    assert judge(forged(number, at=event.at - 0.5)).findings


def test_who_has_to_charge_may_not_go_on() -> None:
    """Somebody whose battery is worse than the record says would have had to charge."""
    record = played()
    worse = tuple(
        replace(robot, battery=replace(robot.battery, lasts=robot.battery.lasts * 0.9))
        if robot.battery
        else robot
        for robot in record.mission.robots
    )
    mission = replace(record.mission, robots=worse)
    assert judge(replace(record, mission=mission)).findings


LINE = Mission(
    "two at one charger",
    Grid(60, 1),
    ("lift",),
    tuple(Robot(name, (0, 0), {"lift": 1}, battery=Battery(40, 20, 0.5)) for name in ("a", "b")),
    (Task("crate", (30, 0), {"lift": 2}, 5),),
    time="continuous",
    chargers=(Charger((10, 0)),),
)
"""Both have 20 left. There are 10 of them at the charger, and each charges for 15, b from 25 on."""


def test_who_finds_no_room_at_a_charger_waits_for_it() -> None:
    record = tf.run(LINE).record
    assert judge(record).findings == ()
    told = tell_events(record)
    assert [(run.begun, run.phase) for run in told.runs[1]] == [
        (0, "walking"), (10, "queueing"), (25, "charging"), (40, "walking"), (60, "serving"),
        (65, "idle"),
    ]  # fmt: skip
    assert told.texts[told.runs[1][1].why[0]].startswith("others charge there")
    lines = why_so_late(LINE, told.path)
    assert lines == [
        "why so late: 65 are 30 walking, 5 serving, 15 charging, 15 waiting for chargers",
        "  0-40: a walks 10, then b waits for a charger 15, charges 15",
        "  40-65: crate: b walks 20, serves 5",
    ]
    number = next(n for n, event in enumerate(record.events) if event.kind == "queue")
    for events in (
        record.events[:number] + record.events[number + 1 :],  # it waits, and nothing says so
        record.events[: number + 1] + record.events[number:],
    ):
        assert judge(replace(record, events=events)).findings


def test_how_full_batteries_are_is_told_with_each_change() -> None:
    [_, levels] = tell_events(tf.run(LINE).record).levels
    assert levels == (
        (0, 0.5, -1 / 40), (10, 0.25, 0), (25, 0.25, 1 / 20), (40, 1, -1 / 40), (60, 0.5, 0),
        (65, 0.5, 0),
    )  # fmt: skip


@pytest.mark.parametrize("keys", ["shifts loads", "delays shifts", "windows", "losses"])
def test_batteries_are_as_full_as_the_world_has_them(keys: str) -> None:
    for seed in range(3):
        mission = drawn_with(keys, seed)
        course = run_course(mission, Planned())
        record = tf.run(mission).record
        assert record.length == course.world.now
        told = ToldRecord(record.length, (), (), (), levels=tell_events(record).levels)
        for robot, (row, it) in enumerate(zip(told.levels, mission.robots, strict=True)):
            if it.battery is not None:
                left = max(0.0, course.world.left_then(robot, record.length))
                begun, full, rate = row[-1]
                passed = record.length - begun
                assert full + rate * passed == pytest.approx(left / it.battery.lasts, abs=1e-6)


def test_it_is_told_who_charges_when() -> None:
    told: ToldRecord = tell_events(played())
    events = [event for event in played().events if event.kind == "charge"]
    runs = [(run.begun, robot) for robot, row in enumerate(told.runs) for run in row
            if run.phase == CHARGING]  # fmt: skip
    assert sorted(runs) == sorted((event.at, event.robots[0]) for event in events)
    assert any("charges until it is full" in text for text in told.texts)
