"""Fleets in missions with zones."""

from __future__ import annotations

from dataclasses import replace

from fleets import agents_of, errand, opened, recorded, standing, walked
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.in_zones import FleetZones
from teamformer.fleet.messages import READY, SERVE, TaskFact, Terms, Word
from teamformer.fleet.planner import CoordinatedPlanner, FleetSituation
from teamformer.fleet.rehearsal.checking.checker import Checker
from teamformer.fleet.rehearsal.checking.trace import Event, Followed, Said, Worked
from teamformer.fleet.rehearsal.rehearse import judge, set_stage
from teamformer.mission.checks.rules import rules_of_fleets
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.zones import Zone

DOCK = Zone("dock", area=((3, 0), (5, 0)))
THREE = [errand(name, x, duration=6) for name, x in (("one", 3), ("two", 4), ("three", 5))]


def docked(tasks: list[Task], robots: int = 3, room: int = 1) -> FleetMission:
    """Return robots with `a` at the left end of a corridor that has a zone from 3 to 5."""
    who = tuple(Robot(f"r{n}", (0, 0), {"a": 1}) for n in range(robots))
    mission = Mission(
        "m",
        Grid(40, 1),
        ("a",),
        who,
        tuple(tasks),
        time="continuous",
        zones=(replace(DOCK, room=room),),
    )
    assert list(rules_of_fleets(mission)) == []
    return FleetMission(mission)


def begun(fleet: FleetMission) -> list[int]:
    """Return when services begin if nothing happens, in whole seconds."""
    outcome, record = recorded(fleet)
    assert outcome.status == "ended"
    return [round(event.at) for event in record.events if event.kind == "serve"]


def test_services_in_a_zone_go_on_one_after_the_other() -> None:
    """One is there at 3 and serves for 6; the others are, too, and begin at 9 and 15."""
    assert begun(docked(THREE)) == [3, 9, 15]


def test_with_room_for_two_the_third_waits_for_the_first() -> None:
    assert begun(docked(THREE, room=2)) == [3, 4, 9]


def test_a_zone_holds_what_operators_add_there() -> None:
    zones = FleetZones(docked(THREE))
    assert zones.of(TaskFact(0, "one", 9.0, 0.0, (1,))) == [0]  # wherever its load lies by now
    assert zones.of(TaskFact(1 << 24, "new", 4.0, 0.0, (1,))) == [0]
    assert zones.of(TaskFact(1 << 24, "new", 6.0, 0.0, (1,))) == []


def test_plans_have_zones_with_the_tasks_that_operators_add() -> None:
    """All three are in one zone, so they are planned to end one after the other: each goes on."""
    fleet = docked(THREE[:2], robots=2)
    added = TaskFact(1 << 24, "new", 5.0, 0.0, (1,), 6.0)
    places = {0: (4.0, 0.0), 1: (5.0, 0.0)}
    situation = FleetSituation(places, (*fleet.tasks, added), age=1.0)
    stops = CoordinatedPlanner().plan(fleet, situation)
    assert {key for key, _ in stops} == {0, 1, 1 << 24}


def hear_all(agents: list[Agent], now: float, but: int = -1) -> None:
    """Let all agents speak and hear one another, but for what one says."""
    said = [agent.tick(now, standing(agent, int(100 * now)), [])[1] for agent in agents]
    fleet = agents[0].mission
    inbox = [m for me, out in enumerate(said) if me != but for m in opened(fleet, me, out)]
    for me, agent in enumerate(agents):
        heard = [message for message in inbox if message.sender != me]
        agent.tick(now + 0.1, standing(agent, int(100 * now) + 1), heard)


def test_nobody_begins_in_a_zone_by_a_plan_that_not_all_are_heard_to_follow() -> None:
    agents = agents_of(docked(THREE))
    first = agents[0].keeper.plan.note.order[0]
    assert not agents[0].gate.lets_in(first, 0.0)
    hear_all(agents, 1.0, but=2)
    assert not agents[0].gate.lets_in(first, 1.2)
    hear_all(agents, 2.0)
    assert agents[0].gate.lets_in(first, 2.2)
    assert not agents[0].gate.lets_in(first, 7.2)  # what was heard then may not be so any more


def test_whoever_is_next_by_the_plan_waits_for_the_end_of_what_is_before() -> None:
    agents = agents_of(docked(THREE))
    one, two, three = agents[0].keeper.plan.note.order
    hear_all(agents, 1.0)
    assert [agents[0].gate.lets_in(key, 1.2) for key in (one, two, three)] == [True, False, False]
    agents[0].knowledge.mark_done(one, 1.3)
    assert [agents[0].gate.lets_in(key, 1.3) for key in (two, three)] == [True, False]


def test_what_is_under_way_takes_room_whoever_comes_first_by_the_plan() -> None:
    """Who is called lost at 13 takes room for 6 more, by a plan that does not count on it."""
    agents = agents_of(docked(THREE))
    hear_all(agents, 1.0)
    me, plan = agents[0], agents[0].keeper.plan
    one, two, _ = plan.note.order
    word = Word(1, 99, 4.0, 0.0, 1, two, SERVE, terms=Terms(plan.version[2]))
    me.membership.hear(word, 1.2)
    assert not me.gate.lets_in(one, 1.3)
    me.membership.call_lost(13.0, frozenset({1, 2}))
    me.keeper.make(me.membership, (0.0, 0.0), 13.0, 13.0)
    one = me.keeper.plan.note.order[0]
    me.keeper.dropped_at = 0.0  # as if that had been long ago
    assert one != word.goal
    assert [me.gate.lets_in(one, now) for now in (18.9, 19.1)] == [False, True]


def test_after_somebody_is_called_lost_nobody_begins_for_a_while() -> None:
    agents = agents_of(docked(THREE, robots=2))
    me = agents[0]
    me.membership.call_lost(11.0, frozenset({1}))
    me.keeper.make(me.membership, (0.0, 0.0), 12.0, 12.0)
    first = me.keeper.plan.note.order[0]
    assert [me.gate.lets_in(first, now) for now in (21.9, 22.1)] == [False, True]


def test_to_begin_in_a_zone_without_room_is_found_unless_they_do_not_know_of_one_another() -> None:
    fleet = docked(THREE, robots=2)
    tasks = {task.key: task for task in fleet.tasks}
    trace: list[Event] = [walked(0.0, r, ((3 + r, 0),), 0.0, 1.0) for r in (0, 1)]
    for robot in (0, 1):
        trace.append(Said(0.1, robot, robot, robot, READY, 2.6))
        trace.append(Worked(1.0 + robot, robot, robot, robot))
    assert Checker(fleet, tasks).check(trace, ()) == [
        "2.00 s: 'r1' serves 'two' without room in dock"
    ]
    cut = [Followed(0.5, 1, frozenset({1})), *trace]
    assert Checker(fleet, tasks).check(cut, ()) == []


def test_every_promise_is_kept_in_zones_under_schedules_of_faults() -> None:
    both = replace(errand("both", 4, duration=3), needs={"a": 2})
    stage = set_stage(docked([*THREE, both, errand("out", 20, duration=2)]))
    assert stage.undisturbed.status == "ended"
    for number in range(10):
        verdict = judge(stage, 3, number)
        assert verdict.is_good, (number, verdict)
