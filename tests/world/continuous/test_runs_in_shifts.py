"""Missions of robots that work in shifts, as they run: by hand, and as they were planned."""

from __future__ import annotations

from dataclasses import replace
from random import Random
from typing import Any

import pytest

from clock_promises import path_length
from teamformer.files.drawn.named_settings import world_of
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.telling.whole import path_of_record, told_of
from teamformer.trials.continuous_trial import carry_out
from teamformer.trials.trial import run_trial
from teamformer.world.continuous.events import Event

WORKER = Robot("w", (0.0, 0.0), {"a": 1}, shifts=((0, 10), (14, 30)))
TASK = Task("t", (6.0, 0.0), {"a": 1}, duration=5.0)


def mission(*robots: Robot, tasks: tuple[Task, ...] = (TASK,), **more: Any) -> Mission:
    """Return a mission on a line; everybody walks at speed 1."""
    return Mission("m", Plane(40, 10), ("a", "b"), robots, tasks, time="continuous", **more)


def run(given: Mission) -> Record:
    """Return the record of a mission, which is legal."""
    record = run_trial(given, SharedPlan()).record
    assert judge(record).findings == ()
    if record.end.makespan is not None:
        assert path_length(record.events) == pytest.approx(record.end.makespan, rel=1e-12)
    return record


def times(record: Record, *kinds: str) -> list[tuple[float, str]]:
    return [(event.at, event.kind) for event in record.events if event.kind in kinds]


def test_a_task_that_does_not_fit_waits_for_the_next_shift() -> None:
    """There at 6, with 4 left of the shift; from 14 to 19 in the next one."""
    record = run(mission(WORKER))
    assert times(record, "arrive", "serve", "done") == [(6, "arrive"), (14, "serve"), (19, "done")]
    path = [(it.begin, it.end, it.doing) for it in told_of(record).path]
    assert path == [(0, 6, "walking"), (6, 14, "off"), (14, 19, "serving")]
    made = plan_continuous(pose_mission(record.mission), "plan", 0)
    assert made is not None
    planned = [
        (it.begin, it.end, it.doing)
        for it in path_of_record(carry_out(record.mission, made, "plan"))
    ]
    assert planned == path


def test_a_walk_pauses_where_the_shift_ends() -> None:
    """10 from the start when the shift ends; the other 5 from 14 on."""
    record = run(mission(WORKER, tasks=(replace(TASK, at=(15.0, 0.0)),)))
    [walk] = [event for event in record.events if event.kind == "walk"]
    assert walk.way == ((0, (0, 0)), (10, (10, 0)), (14, (10, 0)), (19, (15, 0)))
    assert times(record, "rests", "works", "done") == [(10, "rests"), (14, "works"), (24, "done")]
    phases = [(run.begun, run.phase) for run in told_of(record).runs[0]]
    assert phases == [(0, "walking"), (10, "off"), (14, "walking"), (19, "serving"), (24, "idle")]


def test_a_team_needs_a_shift_of_each() -> None:
    """The other works from 12 to 18 and from 20 on: 14 to 19 is too long for both, 20 to 25 not."""
    other = Robot("o", (6.0, 0.0), {"b": 1}, shifts=((12, 18), (20, 40)))
    both = replace(TASK, needs={"a": 1, "b": 1})
    assert times(run(mission(WORKER, other, tasks=(both,))), "serve", "done") == [
        (20, "serve"),
        (25, "done"),
    ]


def test_forming_fits_into_a_shift_too_and_may_be_in_one_before() -> None:
    """They form from 6 to 9, and serve from 14 on; with 5 to form, they do so from 14 on."""
    other = Robot("o", (6.0, 0.0), {"b": 1})
    both = replace(TASK, needs={"a": 1, "b": 1})
    short = run(mission(WORKER, other, tasks=(both,), forming=3.0))
    assert times(short, "form", "formed", "serve") == [(6, "form"), (9, "formed"), (14, "serve")]
    long = run(mission(WORKER, other, tasks=(both,), forming=5.0))
    assert times(long, "form", "formed", "serve") == [(14, "form"), (19, "formed"), (19, "serve")]


def test_a_load_is_carried_within_one_shift() -> None:
    """Lifted for 1, carried for 5 and unloaded for 1: 7 do not fit from 6 on."""
    load = replace(TASK, duration=1.0, to=(11.0, 0.0), unload=1.0)
    record = run(mission(WORKER, tasks=(load,)))
    assert times(record, "serve", "lift", "unload", "done") == [
        (14, "serve"),
        (15, "lift"),
        (20, "unload"),
        (21, "done"),
    ]


def test_a_service_that_takes_longer_breaks_off_as_the_shift_ends() -> None:
    """Believed to take 4 it begins at 6; it takes longer, and is done in the next shift."""
    given = mission(WORKER, tasks=(replace(TASK, lasts=(3.0, 5.0)),))
    records = [run_trial(given, SharedPlan(), seed).record for seed in range(8)]
    assert {judge(record).findings for record in records} == {()}
    ends = {record.end.makespan: record for record in records}
    longer = [record for at, record in ends.items() if at is not None and at > 14]
    assert longer
    for record in longer:
        [broken, *_] = times(record, "broken")
        assert broken == (10, "broken")
        real = record.true_mission.tasks[0].duration
        assert times(record, "serve", "done")[-2:] == [(14, "serve"), (14 + real, "done")]


def test_a_robot_that_was_lost_goes_on_within_its_shifts() -> None:
    """Lost at 4 and back at 9 it has 2 to go: there at 14 and 1, done 5 later."""
    away = replace(WORKER, absences=(Absence(4, 9),))
    record = run(mission(away))
    assert times(record, "lost", "back", "done") == [(4, "lost"), (9, "back"), (20, "done")]


def test_who_is_back_between_two_cells_outside_its_shifts_goes_on_from_there() -> None:
    """Lost a quarter of the way from 3 to 4; at 4 three quarters after 14, and at 6 two later."""
    away = replace(WORKER, absences=(Absence(3.25, 12),))
    record = run(replace(mission(away), world=Grid(12, 1)))
    assert times(record, "back", "serve", "done") == [
        (12, "back"),
        (16.75, "serve"),
        (21.75, "done"),
    ]
    back = next(number for number, event in enumerate(record.events) if event.kind == "back")
    assert record.events[back + 1].way == ((11.75, (3, 0)), (14.75, (4, 0)))


def test_who_never_gets_home_stays() -> None:
    """Done at 8, with 2 left of the last shift and 6 to walk home."""
    worker = replace(WORKER, shifts=((0, 10),))
    task = replace(TASK, duration=2.0)
    record = run(mission(worker, tasks=(task,), ends="home", step_limit=90))
    assert times(record, "walk", "done", "rests") == [(0, "walk"), (8, "done"), (10, "rests")]
    assert record.end.status == "step limit"


def test_shifts_come_again() -> None:
    """Half of each ten: 12 to walk are there at 22, and 3 fit from 22 on."""
    worker = replace(WORKER, shifts=((0, 5),), every=10)
    record = run(mission(worker, tasks=(replace(TASK, at=(12.0, 0.0), duration=3.0),)))
    assert record.end.makespan == 25
    borders = times(record, "rests", "works")
    assert borders == [(5, "rests"), (10, "works"), (15, "rests"), (20, "works"), (25, "rests")]


def test_whose_shifts_are_over_is_of_no_use() -> None:
    """The task appears at 27; nobody can get it done by 30, so the mission cannot be completed."""
    record = run_trial(mission(WORKER, tasks=(replace(TASK, appears=27.0),)), SharedPlan()).record
    assert judge(record).findings == ()
    assert record.end.status != "completed"


@pytest.mark.parametrize("seed", range(4))
def test_missions_of_the_family_run_as_they_are_planned(seed: int) -> None:
    given = world_of("shifts", seed)
    made = plan_continuous(pose_mission(given), "plan", 0)
    assert made is not None
    record = run(given)
    assert record.end.makespan == pytest.approx(made.makespan, rel=1e-12)
    assert all(_is_in_a_shift(given, event) for event in record.events if event.kind == "serve")


def _is_in_a_shift(given: Mission, event: Event) -> bool:
    """Say whether a service is in one shift of each of its robots, by counting all shifts."""
    assert event.until is not None
    for robot in (given.robots[number] for number in event.robots):
        turns = [turn * robot.every for turn in range(40)]
        shifts = [(a + late, b + late) for late in turns for a, b in robot.shifts]
        if shifts and not any(a <= event.at and event.until <= b + 1e-6 for a, b in shifts):
            return False
    return True


def test_what_does_not_fit_into_shifts_with_the_way_home_is_missed() -> None:
    """A plan of all tasks is the first one, and has nobody home in time."""
    draw = Random(0)
    places = [(float(draw.randrange(21)), float(draw.randrange(21))) for _ in range(30)]
    given = Mission(
        name="more than there is time for",
        world=Plane(20, 20),
        capabilities=("a",),
        robots=tuple(Robot(name, (0, 0), {"a": 1}, shifts=((0, 40),)) for name in ("r0", "r1")),
        tasks=tuple(
            Task(f"t{number}", place, {"a": 1}, 1.0, optional=True)
            for number, place in enumerate(places)
        ),
        time="continuous",
        ends="home",
        until=40,
    )
    record = run(given)
    assert record.end.status == "completed"
    assert record.end.makespan is not None
    assert record.end.makespan <= 40
    assert 0 < len(record.end.missed) < 22


def test_a_team_forms_only_within_the_shifts_of_all() -> None:
    """The worker is there when its shift ends, at 1; the next one, from 21 on, is just enough."""
    worker = Robot("w", (0.0, 1.0), {"a": 1}, shifts=((0, 1),), every=21)
    others = tuple(Robot(name, (0.0, 0.0), {"a": 1}) for name in ("x", "y"))
    together, alone = Task("t", (0.0, 0.0), {"a": 3}), Task("u", (0.0, 0.0), {"a": 1}, duration=1.0)
    record = run(mission(worker, *others, tasks=(together, alone), forming=1.0))
    assert times(record, "form", "formed") == [(21, "form"), (22, "formed")]
    assert record.end.makespan == 22
    path = [(it.begin, it.end, it.doing) for it in told_of(record).path]
    assert path == [(0, 1, "walking"), (1, 21, "off"), (21, 22, "forming")]
