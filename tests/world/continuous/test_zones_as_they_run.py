"""Missions with zones as they run: by hand, as they were planned, and forged."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from teamformer.files.drawn.named_settings import world_of
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.zones import Zone
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import PLANNERS, plan_continuous
from teamformer.record.critical_path.words import why_so_late
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.record.telling.whole import told_of
from teamformer.trials.continuous_trial import carry_out
from teamformer.world.continuous.events import Event
from zone_runs import InThisOrder, on_a_line, run

A, B = Robot("a", (0.0, 0.0), {"a": 1}), Robot("b", (0.0, 0.0), {"b": 1})
X = Task("x", (4.0, 0.0), {"a": 1}, duration=6.0)
Y = Task("y", (6.0, 0.0), {"b": 1}, duration=3.0)
Z = Task("z", (9.0, 0.0), {"a": 1}, duration=1.0)
ZONE = Zone("dock", tasks=("x", "y"))


def mission(
    *tasks: Task, robots: tuple[Robot, ...] = (A, B), zones: tuple[Zone, ...] = (ZONE,), **more: Any
) -> Mission:
    """Return a mission on a line; everybody walks at speed 1."""
    return on_a_line(tasks, robots, zones, **more)


def served(record: Record) -> list[tuple[str, float, float]]:
    """Return the tasks with the times at which they began and were done."""
    begun, ended = {}, {}
    for event in record.events:
        name = record.mission.tasks[event.task].name
        if event.kind == "serve":
            begun[name] = event.at
        elif event.kind == "done":
            ended[name] = event.at
    return sorted((name, begun[name], ended[name]) for name in ended)


def test_who_has_to_charge_first_is_waited_for_in_a_zone() -> None:
    """b has 6 of 30 left, and y is 6 away: it charges for 8, and is there at 14."""
    full, low = Battery(30, 10, waiting=0.1), Battery(30, 10, starts=0.2)
    robots = (replace(A, battery=full), replace(B, battery=low))
    given = mission(X, Y, robots=robots, chargers=(Charger((0.0, 0.0)),))
    y_first = run(given, InThisOrder((1, (1,)), (0, (0,))))
    assert served(y_first) == [("x", 17.0, 23.0), ("y", 14.0, 17.0)]
    assert served(run(given)) == [("x", 4.0, 10.0), ("y", 14.0, 17.0)]


def test_a_team_that_is_there_waits_for_room() -> None:
    """Whoever is first is over with it before the other begins: y from 6 to 9, x from 9 to 15.

    The other way round it is x from 4 to 10, y from 10 to 13: that is over sooner.
    """
    record = run(mission(X, Y))
    assert served(record) == [("x", 4, 10), ("y", 10, 13)]
    told = told_of(record)
    [waits] = [row for row in told.runs[1] if row.phase == "waiting"]
    assert (waits.begun, waits.task) == (6, 1)
    assert [(it.begin, it.end, it.doing, it.task, it.zone) for it in told.path] == [
        (0, 4, "walking", 0, -1),
        (4, 10, "serving", 0, -1),
        (10, 13, "serving", 1, 0),
    ]
    assert why_so_late(record.mission, told.path)[2:] == [
        "  10-13: y: b has waited for room in dock, serves 3"
    ]


def test_why_a_robot_waits_is_told() -> None:
    told = told_of(run(mission(X, Y)))
    [waits] = [row for row in told.runs[1] if row.phase == "waiting"]
    assert [told.texts[why] for why in waits.why] == ["it waits for room in dock, where x goes on"]
    later = told_of(run(mission(X, Y, Z), InThisOrder((2, (0,)), (0, (0,)), (1, (1,)))))
    whys = [[later.texts[why] for why in row.why] for row in later.runs[1] if row.begun < 21]
    assert ["the plan has x enter dock before it"] in whys


def test_with_room_for_both_nobody_waits() -> None:
    for zones in [(replace(ZONE, room=2),), ()]:
        assert served(run(mission(X, Y, zones=zones))) == [("x", 4, 10), ("y", 6, 9)]


def test_zones_are_entered_in_the_order_of_the_plan() -> None:
    """b is there at 6, and x comes first in the plan: a does z before, and is there at 15."""
    plan = InThisOrder((2, (0,)), (0, (0,)), (1, (1,)))
    record = run(mission(X, Y, Z), plan)
    assert served(record) == [("x", 15, 21), ("y", 21, 24), ("z", 9, 10)]
    for_two = mission(X, Y, Z, zones=(replace(ZONE, tasks=("x", "y", "z"), room=2),))
    assert served(run(for_two, plan)) == [("x", 15, 21), ("y", 15, 18), ("z", 9, 10)]


def test_all_rooms_at_once_or_none() -> None:
    """y waits for x until 10, and meanwhile takes no room of the zone in which it is with w."""
    c = Robot("c", (30.0, 0.0), {"b": 1})
    w = Task("w", (22.0, 0.0), {"b": 1}, duration=1.0)
    given = mission(X, Y, w, robots=(A, B, c), zones=(ZONE, Zone("tool", tasks=("y", "w"))))
    x, y, last = (0, (0,)), (1, (1,)), (2, (2,))
    first = [("w", 8, 9), ("x", 4, 10), ("y", 10, 13)]
    assert served(run(given, InThisOrder(x, last, y))) == first
    in_turn = [("w", 13, 14), ("x", 4, 10), ("y", 10, 13)]
    assert served(run(given, InThisOrder(x, y, last))) == in_turn


def test_forming_takes_no_room() -> None:
    """y is for both kinds, which form from 6 to 8 while x goes on until 10."""
    c = Robot("c", (6.0, 1.0), {"a": 1})
    both = replace(Y, needs={"a": 1, "b": 1})
    plan = InThisOrder((0, (0,)), (1, (1, 2)))
    record = run(mission(X, both, robots=(A, B, c), forming=2.0), plan)
    assert served(record) == [("x", 4, 10), ("y", 10, 13)]
    assert [event.at for event in record.events if event.kind in ("form", "formed")] == [6, 8]


def test_a_service_that_breaks_off_leaves_room() -> None:
    """a is lost at 7: y begins then; a is back at 20 and does x."""
    lost = replace(A, absences=(Absence(7, 20),))
    record = run(mission(X, Y, robots=(lost, B)))
    assert served(record) == [("x", 20, 26), ("y", 7, 10)]


def test_whoever_is_lost_for_good_keeps_nobody_waiting() -> None:
    """x comes first in the plan, and its robot is lost on the way; another one will do it."""
    lost = replace(A, absences=(Absence(2, None),))
    both = Robot("c", (30.0, 0.0), {"a": 1})
    record = run(mission(X, Y, robots=(lost, B, both)))
    assert record.end.status == "completed"
    assert served(record)[1] == ("y", 6, 9)


@pytest.mark.parametrize("method", sorted(PLANNERS))
def test_runs_are_as_planned(method: str) -> None:
    for seed in range(2):
        given = world_of("zones", seed)
        made = plan_continuous(pose_mission(given), method, 0.5)
        assert made is not None
        record = carry_out(given, made, method)
        assert judge(record).findings == ()
        planned = {
            (given.tasks[stop.task].name, stop.start, stop.end)
            for route in made.routes
            for stop in route.stops
        }
        assert served(record) == [
            (name, pytest.approx(begin, rel=1e-9), pytest.approx(end, rel=1e-9))
            for name, begin, end in sorted(planned)
        ]
        assert record.end.makespan == pytest.approx(made.makespan, rel=1e-9)


@pytest.mark.parametrize("incident", ["lost", "arrivals", "cancelled", "places", "all"])
def test_runs_with_incidents_are_legal(incident: str) -> None:
    for seed in range(2):
        assert run(world_of(f"zones-{incident}", seed)).end.status == "completed"


def forged(record: Record, change: Any) -> tuple[str, ...]:
    """Return what the referee finds in a record whose events are changed."""
    events = [change(event) for event in record.events]
    return judge(replace(record, events=tuple(events))).findings


def test_who_enters_a_full_zone_is_found() -> None:
    """The record of a mission with room for both is told of one with room for one."""
    record = run(mission(X, Y, zones=(replace(ZONE, room=2),), step_limit=100))
    narrow = replace(record, mission=mission(X, Y, step_limit=100))
    findings = judge(narrow).findings
    assert "task y begins before its turn in a zone, or without room there" in str(findings)


def test_who_could_enter_and_does_not_is_found() -> None:
    record = run(mission(X, Y, step_limit=100))
    wide = mission(X, Y, zones=(replace(ZONE, room=2),), step_limit=100)
    assert "task y can begin, for all are there, and does not" in str(
        judge(replace(record, mission=wide)).findings
    )


def test_a_service_that_hangs_on_something_else_than_room_is_found() -> None:
    def change(event: Event) -> Event:
        return event._replace(cause=0) if event.kind == "serve" and event.at == 10 else event

    assert "serve hangs on event" in str(forged(run(mission(X, Y)), change))
