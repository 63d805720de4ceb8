"""Fleets whose robots work in shifts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from msgspec import structs

from fleets import Watched, errand, plan_of, recorded, walked
from teamformer.fleet.agent.planning import FleetPlan
from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.walking import Lifted
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.in_shifts import can_still_do, who_can
from teamformer.fleet.rehearsal.checking.checker import Checker
from teamformer.fleet.rehearsal.checking.trace import Trace, Worked
from teamformer.fleet.rehearsal.faults import Crash, Faults
from teamformer.fleet.rehearsal.rehearse import judge, play, set_stage
from teamformer.mission.checks.rules import rules_of_fleets
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.record import Record
from teamformer.record.referee import judge as judge_record

Shifts = tuple[tuple[float, float], ...]


def at_work(tasks: list[Task], *shifts: Shifts, **keys: Any) -> FleetMission:
    """Return robots with `a` at the left end of a corridor, each with its shifts."""
    who = tuple(
        Robot(f"r{n}", (0, 0), {"a": 1}, shifts=own, **keys) for n, own in enumerate(shifts)
    )
    mission = Mission("m", Grid(40, 1), ("a",), who, tuple(tasks), time="continuous")
    assert list(rules_of_fleets(mission)) == []
    return FleetMission(mission)


def begun(record: Record) -> list[float]:
    return [event.at for event in record.events if event.kind == "serve"]


def test_a_walk_pauses_between_shifts() -> None:
    """Five cells of ten are walked when the shift ends at 5; it goes on at 20."""
    world = FleetWorld(at_work([errand("t", 10)], ((0.0, 5.0), (20.0, 60.0))))
    world.command(0, Command(1, (10, 0), 0))
    for now, x in ((4.9, 4), (5.0, 5), (19.9, 5), (20.9, 5), (21.0, 6), (25.0, 10)):
        world.advance(now)
        assert world.place(0) == (x, 0)


def test_who_would_not_be_there_before_its_last_shift_ends_stays() -> None:
    world = FleetWorld(at_work([errand("t", 4)], ((0.0, 5.0),)))
    world.command(0, Command(1, (6, 0), 0))
    world.advance(30.0)
    assert world.place(0) == (0, 0)


def test_nobody_begins_what_does_not_fit_into_its_shift() -> None:
    """There at 6, it takes 5: not until 10, so it begins with the next shift, at 20."""
    outcome, record = recorded(at_work([errand("t", 6, duration=5)], ((0.0, 10.0), (20.0, 60.0))))
    assert outcome.status == "ended"
    assert begun(record) == [pytest.approx(20.0, abs=1.1)]


def test_a_team_begins_in_a_shift_of_all() -> None:
    """The first works until 12 and from 30 on, the other one from 10 on: 4 fit from 30 on."""
    task = replace(errand("t", 3, duration=4), needs={"a": 2})
    fleet = at_work([task], ((0.0, 12.0), (30.0, 60.0)), ((10.0, 60.0),))
    assert who_can(fleet, fleet.tasks[0], {0: (0, 0), 1: (0, 0)}, 0.0) == (0, 1)
    outcome, record = recorded(fleet)
    assert outcome.status == "ended"
    assert begun(record) == [pytest.approx(30.0, abs=1.6)]


def test_a_service_that_takes_longer_breaks_off_when_the_shift_ends() -> None:
    """It is believed to take 8 and takes more than 10: begun at 0 it ends in the shift from 20."""
    fleet = at_work([errand("t", 0, lasts=(1.0, 15.0))], ((0.0, 10.0), (20.0, 60.0)))
    seed = next(seed for seed in range(99) if fleet.truth(seed).tasks[0].duration > 12)
    outcome, record = recorded(fleet, Faults(seed=seed))
    assert outcome.status == "ended"
    assert [round(at) for at in begun(record)] == [0, 20]
    assert [event.at for event in record.events if event.kind == "broken"] == [10.0]


def test_what_fits_a_shift_with_nothing_to_spare_goes_to_others() -> None:
    """The shifts of the first are as long as the task; agents never begin in the same instant."""
    fleet = at_work([errand("t", 0, duration=5)], ((0.0, 5.0), (20.0, 25.0)), ())
    outcome, record = recorded(fleet)
    assert outcome.status == "ended"
    assert [event.robots for event in record.events if event.kind == "serve"] == [(1,)]


def test_a_load_is_set_down_when_the_shift_of_who_carries_it_ends() -> None:
    world = FleetWorld(at_work([errand("t", 0, to=(30, 0))], ((0.0, 10.0), (20.0, 60.0))))
    world.command(0, Command(1, (0, 0), 0, 0, True))
    world.advance(15.0)
    lifts = [move for move in world.moves if isinstance(move, Lifted)]
    assert lifts == [Lifted(0.0, 0, (0,), (0.0, 0.0)), Lifted(10.0, 0, (), (10, 0))]


def test_what_no_shift_is_left_for_is_infeasible_and_another_robot_takes_over() -> None:
    """The first is away until its last shift is over: the other does it, from 40 on."""
    task, gone = errand("t", 5, duration=5), Faults(crashes=(Crash(0, 1.0, 30.0),))
    outcome, record = recorded(at_work([task], ((0.0, 25.0),), ((40.0, 80.0),)), gone)
    assert outcome.status == "ended"
    assert begun(record) == [pytest.approx(45.0, abs=1.5)]
    fleet = at_work([task], ((0.0, 25.0),))
    assert not can_still_do(fleet, fleet.tasks[0], {0: (0, 0)}, 16.0)
    assert can_still_do(fleet, fleet.tasks[0], {0: (0, 0)}, 15.0)
    outcome, _ = recorded(fleet, gone)
    assert (outcome.status, outcome.blocked_tasks) == ("infeasible", ("t",))


def test_what_a_shift_breaks_off_goes_to_others_though_a_plan_was_made_meanwhile() -> None:
    """Believed to take 8 it takes 14: the load is at 11 of 12 when the only shift ends, at 25.

    A robot that is called lost at 14 makes a plan in the middle, in which it is under way. The
    third robot comes from the other end.
    """
    task = errand("t", 0, lasts=(1.0, 15.0), to=(12, 0))
    fleet = at_work([task], ((0.0, 25.0),), (), ())
    robots = (*fleet.source.robots[:2], replace(fleet.source.robots[2], at=(39, 0)))
    fleet = FleetMission(replace(fleet.source, robots=robots))
    seed = next(seed for seed in range(99) if 13.5 < fleet.truth(seed).tasks[0].duration < 14.5)
    note = structs.replace(plan_of(fleet).note, coalitions=((0,),))
    trace, faults = Trace(), Faults(seed=seed, crashes=(Crash(1, 4.0),))
    _, outcome, violations = play(fleet, FleetPlan(note), faults, trace)
    assert (outcome.status, violations) == ("ended", [])
    lifts = [event for event in trace.events if isinstance(event, Lifted)]
    assert [lift.robots for lift in lifts] == [(0,), (), (2,)]


def test_shifts_come_again() -> None:
    fleet = at_work([errand("t", 6, duration=5)], ((0.0, 8.0),), every=20.0)
    _, record = recorded(fleet)
    assert begun(record) == [pytest.approx(20.0, abs=1.1)]


def test_to_serve_outside_ones_shift_is_found() -> None:
    fleet = at_work([errand("t", 0, duration=3)], ((0.0, 10.0), (20.0, 60.0)))
    tasks = {task.key: task for task in fleet.tasks}
    for at, is_found in ((5.0, False), (9.0, True), (15.0, True), (20.0, False)):
        trace = [walked(0.0, 0, ((0, 0),), 0.0, 1.0), Worked(at, 0, 0, 0)]
        assert (
            "its shift has no time" in "".join(Checker(fleet, tasks).check(trace, ()))
        ) == is_found


def test_every_promise_is_kept_in_shifts_under_schedules_of_faults() -> None:
    pair = replace(errand("both", 9, duration=3), needs={"a": 2})
    tasks = [errand("one", 3, duration=2), pair, errand("load", 5, to=(12, 0), unload=1)]
    shifts = ((0.0, 15.0), (25.0, 200.0)), ((5.0, 30.0), (40.0, 300.0)), ((0.0, 500.0),)
    stage = set_stage(at_work(tasks, *shifts))
    assert stage.undisturbed.status == "ended"
    for number in range(10):
        verdict = judge(stage, 3, number)
        assert verdict.is_good, (number, verdict)


def test_an_onlooker_foresees_where_a_walk_pauses() -> None:
    """Five of ten cells are walked by 5; the rest comes from 20 on, so it is there at 25."""
    watched = Watched(at_work([errand("t", 10, duration=1)], ((0.0, 5.0), (20.0, 60.0))))
    watched.run(60.0)
    while not watched.watch.is_over:
        watched.watch.step()
    walks = [event for event in watched.watch.record().events if event.kind == "walk"]
    assert walks[0].until == pytest.approx(25.0, abs=1.1)
    assert judge_record(watched.watch.record()).findings == ()
