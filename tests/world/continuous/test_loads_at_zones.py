"""Loads that are taken up and unloaded in zones, as they run: by hand, as planned, and forged."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.zones import Zone
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.telling.whole import told_of
from teamformer.trials.continuous_trial import carry_out
from teamformer.world.continuous.events import Event
from zone_runs import InThisOrder, on_a_line, run

A, B = Robot("a", (0.0, 0.0), {"a": 1}), Robot("b", (20.0, 0.0), {"b": 1})
PIANO = Task("piano", (2.0, 0.0), {"a": 1}, duration=2.0, to=(10.0, 0.0), unload=3.0)
SIGN = Task("sign", (10.0, 0.0), {"b": 1}, duration=6.0)
DOCK = Zone("dock", places=((10.0, 0.0),))


BOTH = InThisOrder((0, (0,)), (1, (1,)))


def mission(
    *tasks: Task, robots: tuple[Robot, ...] = (A, B), zones: tuple[Zone, ...] = (DOCK,), **more: Any
) -> Mission:
    """Return a mission on a line; everybody walks at speed 1."""
    return on_a_line(tasks, robots, zones, **more)


def when(record: Record, *kinds: str) -> list[tuple[str, str, float]]:
    """Return what happened to tasks, by kind and moment."""
    names = [task.name for task in record.mission.tasks]
    return [(e.kind, names[e.task], e.at) for e in record.events if e.kind in kinds and e.task >= 0]


def test_a_team_with_a_load_waits_until_there_is_room() -> None:
    """a lifts from 2 to 4 and is there at 12; b serves the sign from 10 to 16; then a unloads."""
    record = run(mission(PIANO, SIGN), BOTH)
    assert when(record, "serve", "lift", "queue", "unload", "done") == [
        ("serve", "piano", 2),
        ("lift", "piano", 4),
        ("serve", "sign", 10),
        ("queue", "piano", 12),
        ("done", "sign", 16),
        ("unload", "piano", 16),
        ("done", "piano", 19),
    ]
    told = told_of(record)
    [waits] = [row for row in told.runs[0] if row.phase == "waiting"]
    assert (waits.begun, waits.task) == (12, 0)
    assert [told.texts[why] for why in waits.why] == [
        "it waits for room in dock, where sign goes on"
    ]
    assert why_so_late(record.mission, told.path)[-1] == (
        "  16-19: piano: a has waited for room in dock, unloads 3"
    )


def test_while_it_is_carried_a_load_takes_no_room() -> None:
    """The dock is where the load is taken up: the sign begins once it is on its way, at 4."""
    dock = Zone("dock", places=(PIANO.at, (4.0, 0.0)))
    sign, b = replace(SIGN, at=(4.0, 0.0)), replace(B, at=(4.0, 1.0))
    record = run(mission(PIANO, sign, robots=(A, b), zones=(dock,)), BOTH)
    assert when(record, "serve", "done") == [
        ("serve", "piano", 2),
        ("serve", "sign", 4),
        ("done", "sign", 10),
        ("done", "piano", 15),
    ]


def test_who_brings_a_load_is_before_who_is_to_begin() -> None:
    """The sign may begin at 14, when b is there: a, who came at 12, unloads until 15."""
    record = run(mission(PIANO, SIGN, robots=(A, replace(B, at=(24.0, 0.0)))), BOTH)
    assert when(record, "unload", "serve", "queue")[1:] == [
        ("unload", "piano", 12),
        ("serve", "sign", 15),
    ]


def test_who_came_first_unloads_first() -> None:
    """Whatever the plan's order is: b is there at 11, a at 12."""
    crate = Task("crate", (18.0, 0.0), {"b": 1}, duration=1.0, to=(10.0, 0.0), unload=4.0)
    for plan in (BOTH, InThisOrder((1, (1,)), (0, (0,)))):
        record = run(mission(PIANO, crate), plan)
        assert when(record, "unload", "queue", "done") == [
            ("unload", "crate", 11),
            ("queue", "piano", 12),
            ("done", "crate", 15),
            ("unload", "piano", 15),
            ("done", "piano", 18),
        ]


def test_a_load_within_one_zone_does_not_wait_for_itself() -> None:
    """Both ends are in the dock, which has room for one; so is a load that goes nowhere."""
    hall = Zone("hall", area=((0.0, 0.0), (40.0, 10.0)))
    record = run(mission(PIANO, zones=(hall,)), InThisOrder((0, (0,))))
    assert when(record, "lift", "unload", "done")[-1] == ("done", "piano", 15)
    still = replace(PIANO, to=PIANO.at)
    assert when(run(mission(still, zones=(hall,)), InThisOrder((0, (0,)))), "done") == [
        ("done", "piano", 7)
    ]


def test_two_loads_that_change_places_do_not_stop_one_another() -> None:
    """Each is taken up in the zone where the other is brought to."""
    back = Task("back", (10.0, 0.0), {"b": 1}, duration=2.0, to=(2.0, 0.0), unload=3.0)
    here = Zone("here", places=((2.0, 0.0),))
    record = run(mission(PIANO, back, zones=(here, DOCK)), BOTH)
    assert record.end.status == "completed"
    assert when(record, "done") == [("done", "piano", 15), ("done", "back", 23)]


def test_a_load_that_is_set_down_in_a_zone_takes_room_there_when_it_is_taken_up() -> None:
    """a is lost at 9, and its load lies at 7, in the dock: c takes it up from 10 to 12.

    b is at the sign at 10, and begins there once the load is on its way.
    """
    area = Zone("dock", area=((6.0, 0.0), (12.0, 1.0)))
    lost = replace(A, absences=(Absence(9.0, None),))
    robots = (lost, B, Robot("c", (7.0, 1.0), {"a": 1}))
    record = run(mission(PIANO, SIGN, robots=robots, zones=(area,)))
    assert ("broken", "piano", 9) in when(record, "broken")
    assert when(record, "serve")[-2:] == [("serve", "piano", 10), ("serve", "sign", 12)]


def test_a_load_whose_team_is_lost_as_it_waits_lies_in_the_dock() -> None:
    """a is lost at 13; the sign is done at 16; c, which is there, takes it up and unloads it."""
    lost = replace(A, absences=(Absence(13.0, None),))
    robots = (lost, B, Robot("c", (30.0, 0.0), {"a": 1}))
    record = run(mission(PIANO, SIGN, robots=robots))
    assert when(record, "broken", "serve", "lift", "unload", "done")[-4:] == [
        ("serve", "piano", 33),
        ("lift", "piano", 35),
        ("unload", "piano", 35),
        ("done", "piano", 38),
    ]


def forged(record: Record, change: Any) -> str:
    """Return what the referee finds in a record whose events are changed."""
    events = [change(event) for event in record.events]
    return str(judge(replace(record, events=tuple(events))).findings)


def test_who_unloads_without_room_is_found() -> None:
    wide = run(mission(PIANO, SIGN, zones=(replace(DOCK, room=2),), step_limit=100), BOTH)
    narrow = replace(wide, mission=mission(PIANO, SIGN, step_limit=100))
    assert "task piano is unloaded before its turn in a zone, or without room" in str(
        judge(narrow).findings
    )


def test_who_could_unload_and_does_not_is_found() -> None:
    narrow = run(mission(PIANO, SIGN, step_limit=100), BOTH)
    wide = replace(
        narrow, mission=mission(PIANO, SIGN, zones=(replace(DOCK, room=2),), step_limit=100)
    )
    assert "piano" in str(judge(wide).findings)


def test_unloading_that_hangs_on_something_else_than_room_is_found() -> None:
    def change(event: Event) -> Event:
        return event._replace(cause=0) if event.kind == "unload" else event

    assert "unload hangs on event" in forged(run(mission(PIANO, SIGN), BOTH), change)


@pytest.mark.parametrize("room", [1, 2])
def test_runs_are_as_planned(room: int) -> None:
    """Eight loads, half of them from the dock and half of them to it; some have to wait there."""
    ways = [((4.0 * k, 9.0), (10.0, 0.0)) for k in range(4)]
    ways += [((10.0, 0.0), (38.0 - 5 * k, 8.0)) for k in range(4)]
    tasks = [
        Task(f"load-{n}", at, {"ab"[n % 2]: 1}, duration=2.0 + n, to=to, unload=9.0 - n)
        for n, (at, to) in enumerate(ways)
    ]
    robots = [Robot(f"r{n}", (3.0 * n, 2.0), {"ab"[n % 2]: 1}, speed=1 + n / 7) for n in range(6)]
    given = mission(*tasks, robots=tuple(robots), zones=(replace(DOCK, room=room),), ends="home")
    made = plan_continuous(pose_mission(given), "plan", 0.0)
    assert made is not None
    record = carry_out(given, made, "plan")
    assert judge(record).findings == ()
    ends = {stop.task: stop.end for route in made.routes for stop in route.stops}
    done = {event.task: event.at for event in record.events if event.kind == "done"}
    assert done == pytest.approx(ends, rel=1e-9)
    assert record.end.makespan == pytest.approx(made.makespan, rel=1e-9)
    assert any(event.kind == "queue" for event in record.events) or room == 2
