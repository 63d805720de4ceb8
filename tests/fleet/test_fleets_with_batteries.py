"""Fleets whose robots have batteries."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from msgspec import structs

from fleets import PLANNER, Watched, errand, errands_of_each_kind, plan_of, recorded
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.vda5050.dialect import DIALECTS
from teamformer.fleet.bodies.vda5050.state import State
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import Terms, Word
from teamformer.fleet.recharging import Recharge
from teamformer.fleet.rehearsal.faults import Drain, Faults, draw_faults
from teamformer.fleet.rehearsal.rehearse import judge, play, set_stage
from teamformer.mission.checks.rules import rules_of_fleets
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Grid
from teamformer.record.record import Record
from teamformer.record.referee import judge as judge_record
from teamformer.world.continuous.events import Event

HALF = Battery(lasts=40, fills=8, starts=0.5, serving=0.5, waiting=0.25)


def charged(tasks: list[Task], robots: int = 1, room: int = 1, **battery: Any) -> FleetMission:
    """Return robots with `a` at the left end of a corridor with a charger at 2."""
    own = replace(HALF, **battery)
    who = tuple(Robot(f"r{n}", (0, 0), {"a": 1}, battery=own) for n in range(robots))
    chargers = (Charger((2, 0), room),)
    mission = Mission(
        "m", Grid(40, 1), ("a",), who, tuple(tasks), time="continuous", chargers=chargers
    )
    assert list(rules_of_fleets(mission)) == []
    return FleetMission(mission)


def told(record: Record, *kinds: str) -> list[tuple[str, int, float]]:
    """Return who does what of some kinds, and when, to tenths of a second."""
    events = (event for event in record.events if event.kind in kinds)
    return [(event.kind, event.robots[0], round(event.at, 1)) for event in events]


def test_a_body_spends_as_it_walks_serves_and_waits() -> None:
    """From 20: 10 on its way, 4 at work at 0.5 and, in a team that cannot begin, 4 at 0.25."""
    world = FleetWorld(charged([errand("t", 10, duration=4), errand("ab", 10)]))
    world.command(0, Command(1, (10, 0), 0, 0))
    world.advance(4.0)
    assert world.left[0] == pytest.approx(16.0)
    world.advance(10.0)
    world.command(0, Command(1, (10, 0), 0, 0, True))
    world.advance(14.0)
    assert world.left[0] == pytest.approx(8.0)
    assert world.report(0).charge == 0.2
    world.command(0, Command(2, None, 1, 0))
    world.advance(18.0)
    assert world.left[0] == pytest.approx(7.0)


def test_a_body_that_has_nothing_left_stands_still_for_good() -> None:
    world = FleetWorld(charged([errand("t", 18)]))
    world.command(0, Command(1, (38, 0), 0, 0))
    world.advance(30.0)
    assert world.place(0) == (20, 0)
    assert world.report(0).is_unfit
    world.let_go(0)
    world.advance(40.0)
    assert world.place(0) == (20, 0)
    [dry] = [event for event in world.moves if getattr(event, "kind", "") == "empty"]
    assert dry.at == pytest.approx(20.0)


def test_who_runs_dry_with_a_load_sets_it_down() -> None:
    world = FleetWorld(charged([errand("t", 0, to=(18, 0))], starts=0.25))
    world.command(0, Command(1, (0, 0), 0, 0, True))
    world.advance(30.0)
    assert world.robots[0].carries == -1
    assert world.place_of(0) == (10, 0)


def test_who_came_first_to_a_charger_charges_first() -> None:
    """At 2 one has 18 of 40 and takes 4.4 to be full; the other, there at 5, waits until 6.4."""
    world = FleetWorld(charged([errand("t", 18)], robots=2))
    world.command(0, Command(1, (2, 0), 0, 0, charge=True))
    world.advance(3.0)
    world.command(1, Command(1, (2, 0), 0, 0, charge=True))
    world.advance(20.0)
    kinds = [(round(e.at, 1), e.kind, e.robots) for e in world.moves if hasattr(e, "kind")]
    assert kinds == [
        (2.0, "charge", (0,)),
        (6.4, "charged", (0,)),
        (6.4, "charge", (1,)),
        (10.8, "charged", (1,)),
    ]
    assert (world.report(0).charge, world.left[0]) == (1.0, 40)


def test_a_robot_charges_before_a_task_that_it_could_not_get_away_from() -> None:
    """To 14 and back to the charger takes 14 + 12 + 1 of 20: full at 6.4, it is there at 18.4."""
    outcome, record = recorded(charged([errand("t", 14, duration=2)]))
    assert outcome.status == "ended"
    assert told(record, "charge", "charged", "serve", "done") == [
        ("charge", 0, 2.0),
        ("charged", 0, 6.4),
        ("serve", 0, 18.4),
        ("done", 0, 20.4),
    ]


def test_a_robot_goes_straight_to_a_task_that_it_gets_away_from() -> None:
    _, record = recorded(charged([errand("t", 8, duration=2)]))
    assert told(record, "charge", "serve") == [("serve", 0, 8.0)]


def test_robots_queue_by_when_they_came() -> None:
    fleet = charged([errand("t", 14)], robots=3)
    first, later = Recharge(fleet, 1), Recharge(fleet, 0)
    task = fleet.tasks[0]
    for one in (first, later):
        assert one.by_way_of((0, 0), (14, 0), task, False, False) == (2, 0)
    assert not first.may_charge((1, 0), (), 4.0)
    assert first.may_charge((2, 0), (), 5.0)
    word = Word(1, 1, terms=first.terms(0))
    assert word.terms == Terms(0, 0.5, 0, 5.0)
    assert not later.may_charge((2, 0), [word], 6.0)
    assert later.may_charge((2, 0), [], 7.0)  # nobody else is heard: the charger has the word


def test_less_than_was_believed_makes_a_new_plan() -> None:
    """In two seconds on its way it may spend 2 of 40, and by its body it has spent 6."""
    fleet = charged([errand("t", 8), errand("u", 9)])
    agent = Agent(fleet, 0, PLANNER, plan_of(fleet), 0.0)
    agent.tick(0.0, Report(0, 0, 0, number=1, charge=0.5), [])
    leg = agent.command.leg
    agent.tick(1.0, Report(1, 0, leg, number=2, charge=0.475), [])
    assert agent.keeper.made == 0
    agent.tick(2.0, Report(2, 0, leg, number=3, charge=0.35), [])
    agent.tick(3.0, Report(2, 0, leg, number=4, charge=0.33), [])
    assert agent.keeper.made == 1
    agent.tick(8.0, Report(3, 0, leg, number=5, charge=0.31), [])
    assert agent.keeper.made == 1


def test_what_is_too_far_for_a_full_battery_is_not_planned() -> None:
    """From the charger at 2 to 21, 1 at work and back takes 39 of 40; with 5 at work 41.5."""
    fleet = charged([errand("t", 8)])
    far = structs.replace(fleet.tasks[0], x=21.0, duration=2.0)
    assert fleet.can_do([0], far)
    assert not fleet.can_do([0], structs.replace(far, duration=10.0))


def test_vehicles_tell_their_charge_in_percent() -> None:
    for version, part, key in (
        ("2", "batteryState", "batteryCharge"),
        ("3", "powerSupply", "stateOfCharge"),
    ):
        dialect = DIALECTS[version]
        assert State({part: {key: 64.5}}, dialect).charge == 0.645
        assert State({part: {key: 99}}, dialect).charge == 1.0
        assert State({part: {}}, dialect).charge is None
        assert State({}, dialect).charge is None


def test_an_onlooker_tells_who_charges() -> None:
    watched = Watched(charged([errand("t", 14, duration=2)]))
    watched.run(60.0)
    while not watched.watch.is_over:
        watched.watch.step()
    record = watched.watch.record()
    assert judge_record(record).findings == ()
    kinds = [kind for kind, _, _ in told(record, "charge", "charged", "serve", "done")]
    assert kinds == ["charge", "charged", "serve", "done"]


def test_every_promise_is_kept_with_batteries_under_schedules_of_faults() -> None:
    stage = set_stage(charged(errands_of_each_kind(), robots=3))
    assert stage.undisturbed.status == "ended"
    for number in range(10):
        verdict = judge(stage, 3, number)
        assert verdict.is_good, (number, verdict)


def test_a_robot_whose_battery_is_drained_turns_back_to_the_charger() -> None:
    """Full at 6.4 it is at 3.6 at 8, and has 19.2 of 40 from then on: not enough to 14 and back."""
    mission = charged([errand("t", 14, duration=2)])
    faults = Faults(drained=(Drain(0, 8.0, 0.5),))
    rehearsal, outcome, violations = play(mission, plan_of(mission), faults)
    assert (outcome.status, violations) == ("ended", [])
    moves = (event for event in rehearsal.world.moves if isinstance(event, Event))
    charges = [round(event.at, 1) for event in moves if event.kind == "charge"]
    assert charges[0] == 2.0
    assert len(charges) == 2
    assert 8.0 < charges[1] < 14.0
    assert faults.kinds == ("drained",)
    assert list(faults.lines(mission)) == [
        "8.00 s: the battery of r0 loses 50% of what it has left"
    ]


def test_a_robot_that_runs_dry_by_a_fault_leaves_its_task_to_others() -> None:
    """Far from the charger it has nothing left: the other one does what it was to do."""
    mission = charged([errand("t", 20, duration=2)], robots=2, starts=1.0, lasts=60)
    faults = Faults(drained=(Drain(0, 10.0, 1.0),))
    rehearsal, outcome, violations = play(mission, plan_of(mission), faults)
    assert (outcome.status, violations) == ("ended", [])
    kinds = [
        (event.kind, event.robots) for event in rehearsal.world.moves if isinstance(event, Event)
    ]
    assert ("empty", (0,)) in kinds
    assert outcome.tasks_done == 1


def test_batteries_are_drained_in_schedules_where_there_are_any() -> None:
    with_any, without = charged([errand("t", 14)], robots=3), errands_of(3)
    drawn = [draw_faults(with_any, seed, 40.0).drained for seed in range(40)]
    assert 5 < sum(map(bool, drawn)) < 30
    assert {drain.share for drains in drawn for drain in drains} == {0.25, 0.5, 0.9}
    assert not any(draw_faults(without, seed, 40.0).drained for seed in range(40))


def errands_of(robots: int) -> FleetMission:
    """Return robots without batteries, and an errand."""
    who = tuple(Robot(f"r{n}", (0, 0), {"a": 1}) for n in range(robots))
    return FleetMission(Mission("m", Grid(40, 1), ("a",), who, (errand("t", 14),)))
