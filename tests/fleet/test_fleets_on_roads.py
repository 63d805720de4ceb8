"""Fleets on roads and in continuous time: by hand, and under schedules of faults."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fleets import opened, plan_of
from teamformer.fleet.agent.agent import Agent
from teamformer.fleet.agent.knowledge import Knowledge, Remembered
from teamformer.fleet.agent.meeting import Meeting, turn_time, turns
from teamformer.fleet.agent.membership import Membership
from teamformer.fleet.agent.planning import FleetPlan
from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.bodies.journey import Journey
from teamformer.fleet.bodies.walking import Walked
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import EVERYBODY, Beat, Notice, PlanNote, Word
from teamformer.fleet.planner import CoordinatedPlanner
from teamformer.fleet.rehearsal.checking.trace import Trace
from teamformer.fleet.rehearsal.checking.ways import WayChecker
from teamformer.fleet.rehearsal.faults import Crash, Cut, Faults, Spell, draw_faults, losses_of
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import judge, play, set_stage
from teamformer.mission.model import Absence, Arrivals, Breakdown, Delays, Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.record import Record
from teamformer.record.referee import judge as judge_record
from teamformer.world.continuous.delays import StandingStill
from teamformer.world.continuous.events import Passed

FAR = float("inf")

RING = Roads(
    ("dock", "ward", "lab"),
    {"ground": ((0, 4, FAR), (FAR, 0, 2.5), (1, FAR, 0))},
)
"""One way round: from dock to ward 4, on to lab 2.5, and back to dock 1."""

DOCK, WARD, LAB = (0, 0), (1, 0), (2, 0)


def ring(tasks: list[Task], robots: int = 2, **changes: object) -> Mission:
    """Return robots `r0`, `r1`, ... at the dock; the latter are half as fast as r0."""
    who = [Robot(f"r{n}", DOCK, {"a": 1}, 1.0 if n == 0 else 0.5) for n in range(robots)]
    mission = Mission("ring", RING, ("a",), tuple(who), tuple(tasks), time="continuous")
    return replace(mission, **changes)  # type: ignore[arg-type]


def ended(mission: Mission, faults: Faults = Faults()) -> dict[str, float]:  # noqa: B008
    """Return when each task was done in a rehearsal that keeps every promise and ends."""
    fleet = FleetMission(mission)
    rehearsal, outcome, violations = play(fleet, plan_of(fleet), faults)
    assert (violations, outcome.status) == ([], "ended")
    return {rehearsal.world.tasks[key].name: done.at for key, done in rehearsal.world.done.items()}


def meeting_of(fleet: FleetMission, robot: int) -> Meeting:
    """Return where a robot meets others, which knows nothing but the mission."""
    knowledge = Knowledge(fleet, robot, Remembered())
    return Meeting(knowledge, Membership(knowledge, fleet.timers, 0, 0.0))


def test_between_two_places_a_robot_is_so_far_from_the_next() -> None:
    world = FleetWorld(FleetMission(ring([Task("t", LAB, {"a": 1})], 1)))
    world.command(0, Command(1, LAB, 0))
    for now, place in [(1.0, (1, 3.0)), (4.0, (1, 0)), (5.0, (2, 1.5)), (6.5, (2, 0)), (9.0, LAB)]:
        world.advance(now)
        assert world.place(0) == pytest.approx(place)


def test_nobody_turns_round_on_a_road() -> None:
    """At 1 it is 3 from the ward; from there the way to the dock leads by the lab: 2.5 and 1."""
    world = FleetWorld(FleetMission(ring([Task("t", LAB, {"a": 1})], 1)))
    world.command(0, Command(1, LAB, 0))
    world.advance(1.0)
    world.command(0, Command(2, DOCK, 0))
    passed = [(round(at, 9), place) for at, place in world.robots[0].journey.way]
    assert passed == [(0, DOCK), (4, WARD), (6.5, LAB), (7.5, DOCK)]


def test_who_is_stuck_on_a_road_goes_on_from_where_it_was() -> None:
    world = FleetWorld(FleetMission(ring([Task("t", WARD, {"a": 1})], 1)))
    world.command(0, Command(1, WARD, 0))
    world.advance(1.0)
    world.hold_fast(0)
    world.advance(11.0)
    assert world.place(0) == (1, 3.0)
    world.let_go(0)
    world.advance(13.0)
    assert world.place(0) == (1, 1.0)
    assert world.robots[0].journey.end == 14.0


def test_who_pauses_at_a_place_is_there_and_sets_out_from_there() -> None:
    """Its shift begins at 10. It breaks down at 3, is back at 12, and 4 later at the ward."""
    mission = ring([Task("t", WARD, {"a": 1})], 1)
    late = replace(mission.robots[0], shifts=((10.0, 60.0),))
    fleet = FleetMission(replace(mission, robots=(late,)))
    world = FleetWorld(fleet)
    world.command(0, Command(1, WARD, 0))
    world.advance(3.0)
    way = world.robots[0].journey.way
    assert [*way] == [(0.0, DOCK), (10.0, DOCK), (14.0, WARD)]
    assert world.place(0) == WayChecker(fleet).place(Walked(0.0, 0, Journey(way)), 3.0) == DOCK
    world.kill(0)
    world.advance(12.0)
    world.revive(0)
    world.command(0, Command(2, WARD, 0))
    assert [*world.robots[0].journey.way] == [(12.0, DOCK), (16.0, WARD)]


def test_a_delayed_robot_stands_still_in_whole_units_of_time() -> None:
    """As in a run: by the same truth, who walks 4 arrives when the world in `run` says so."""
    task = Task("t", WARD, {"a": 1})
    mission = ring([task], 1)
    late = replace(mission.robots[0], delays=Delays(0.5, seed=3))
    fleet = FleetMission(replace(mission, robots=(late,)))
    world = FleetWorld(fleet, fleet.truth(0))
    world.command(0, Command(1, WARD, 0))
    due = StandingStill([late]).after((0,), 0.0, 4.0)
    assert world.robots[0].journey.end == due > 4.0


def test_two_robots_of_different_speed_meet_and_serve() -> None:
    """The slower one needs 8 to the ward; then they take a moment to agree, and 3 to serve."""
    ends = ended(ring([Task("t", WARD, {"a": 2}, duration=3)]))
    assert 11.0 <= ends["t"] <= 12.0


def test_after_and_windows_hold_in_continuous_time() -> None:
    first = Task("first", WARD, {"a": 1}, duration=2, between=(10.25, 60.0))
    then = Task("then", LAB, {"a": 1}, after=("first",))
    ends = ended(ring([first, then]))
    assert 12.25 <= ends["first"] <= 13.0
    assert ends["then"] > ends["first"]


def test_a_load_is_carried_by_road_at_the_pace_of_the_slower_one() -> None:
    """Both at the ward after 8; they take it up in 1, are at the lab 5 later, and unload in 2."""
    ends = ended(ring([Task("bed", WARD, {"a": 2}, duration=1, to=LAB, unload=2)]))
    assert 16.0 <= ends["bed"] <= 17.0


def test_a_load_whose_carriers_break_down_lies_where_they_passed_last() -> None:
    """They set out from the ward at about 9 and are lost between ward and lab; others fetch it."""
    mission = ring([Task("bed", WARD, {"a": 2}, duration=1, to=LAB)], 4)
    fleet = FleetMission(mission)
    plan = plan_of(fleet)
    carriers = plan.coalition(0)
    crashes = tuple(Crash(robot, 10.5) for robot in carriers)
    assert ended(mission, Faults(crashes=crashes))["bed"] > 15.0


def test_a_mission_that_ends_at_home_is_over_when_all_are_there() -> None:
    fleet = FleetMission(ring([Task("t", WARD, {"a": 1})], 1, ends="home"))
    rehearsal, outcome, violations = play(fleet, plan_of(fleet), Faults())
    assert (violations, outcome.status) == ([], "ended")
    assert rehearsal.world.place(0) == DOCK
    assert outcome.end == pytest.approx(7.5, abs=1.0)


def test_a_robot_lost_in_continuous_time_is_lost_at_that_time() -> None:
    mission = ring([Task("t", WARD, {"a": 1}, duration=5)])
    gone = replace(mission.robots[0], absences=(Absence(6.5, None),))
    fleet = FleetMission(replace(mission, robots=(gone, mission.robots[1])))
    assert losses_of(fleet) == (Crash(0, 6.5, None),)


def test_every_promise_is_kept_on_roads_under_schedules_of_faults() -> None:
    tasks = [
        Task("bed", WARD, {"a": 2}, duration=1, to=LAB, unload=1),
        Task("clean", LAB, {"a": 1}, duration=3, after=("bed",)),
        Task("scan", DOCK, {"a": 1}, duration=2, between=(5.5, 90.0)),
        Task("meet", LAB, {"a": 3}, duration=1),
    ]
    stage = set_stage(FleetMission(ring(tasks, 4)))
    assert stage.undisturbed.status == "ended"
    for number in range(10):
        verdict = judge(stage, 1, number)
        assert verdict.is_good, (number, verdict)


def test_a_plane_in_continuous_time_is_crossed_at_speed_whatever_its_step() -> None:
    who = (Robot("r", (0.0, 0.0), {"a": 1}, 0.5),)
    tasks = (Task("t", (3.0, 4.0), {"a": 1}, duration=1.5),)
    plane = Plane(9.0, 9.0, step=0.2)
    ends = ended(Mission("field", plane, ("a",), who, tasks, time="continuous"))
    assert 11.5 <= ends["t"] <= 12.0


def test_a_spell_on_a_road_is_survived() -> None:
    mission = ring([Task("t", WARD, {"a": 2}, duration=3)])
    assert ended(mission, Faults(stuck=(Spell(1, 2.0, 12.0),)))["t"] >= 21.0


def recorded(mission: Mission, faults: Faults) -> Record:
    """Return the record of a rehearsal, as it is read again."""
    fleet, trace = FleetMission(mission), Trace()
    rehearsal, outcome, _ = play(fleet, plan_of(fleet), faults, trace)
    return record_of(rehearsal, outcome, trace.events, faults.seed)


def told(record: Record, kind: str) -> list[tuple[float, tuple[int, ...], int]]:
    """Return when events of a kind were, of which robots, and of which task."""
    return [(e.at, e.robots, e.task) for e in record.events if e.kind == kind]


def test_the_record_of_a_rehearsal_tells_events_that_check_finds_right(tmp_path: Path) -> None:
    """Robot 0 sets out, breaks down between dock and ward for 5, and serves with robot 1."""
    mission = ring([Task("t", WARD, {"a": 2}, duration=3)])
    record = recorded(mission, Faults(crashes=(Crash(0, 2.0, 7.0),)))
    [(lost, _, _)], [(back, _, _)] = told(record, "lost"), told(record, "back")
    [(begun, robots, task)], [(done, _, _)] = told(record, "serve"), told(record, "done")
    assert (lost, back, robots, task) == (2.0, 7.0, (0, 1), 0)
    assert done == begun + 3 == record.end.makespan
    save_record(record, tmp_path / "record.json")
    assert read_record(tmp_path / "record.json") == record
    assert judge_record(record).findings == ()


def test_who_goes_a_way_that_takes_no_time_is_there_after_it_sets_out() -> None:
    """The lab is next to the ward, so no time passes from what is done there to being here."""
    next_door = Roads(("dock", "ward", "lab"), {"ground": ((0, 4, FAR), (4, 0, 0), (FAR, 0, 0))})
    tasks = [Task("t", WARD, {"a": 1}, duration=1), Task("u", LAB, {"a": 1}, after=("t",))]
    record = recorded(replace(ring(tasks, 1), world=next_door), Faults())
    ways = [event for event in record.events if event.kind in ("walk", "arrive", "done")]
    assert [(event.kind, round(event.at, 2), event.task) for event in ways] == [
        *(("walk", 0.02, 0), ("arrive", 4.02, 0), ("done", 5.02, 0)),
        *(("walk", 5.02, 1), ("arrive", 5.02, 1), ("done", 5.04, 1)),
    ]
    assert [event.place for event in ways if event.kind == "arrive"] == [WARD, LAB]
    assert judge_record(record).findings == ()


def test_who_is_free_again_and_there_at_once_is_seen_to_have_gone() -> None:
    """It is stuck at the dock until 5, next to the ward, where it serves at that moment."""
    at_once = Roads(("dock", "ward"), {"ground": ((0, 0), (4, 0))})
    mission = replace(ring([Task("t", WARD, {"a": 1})], 1), world=at_once)
    assert ended(mission, Faults(stuck=(Spell(0, 0.0, 5.0),))) == {"t": 5.0}


def test_what_a_fleet_cannot_have_done_is_found() -> None:
    record = recorded(ring([Task("t", WARD, {"a": 2}, duration=3)]), Faults())

    def found(which: str, **changes: object) -> str:
        events = tuple(
            event._replace(**changes) if event.kind == which else event  # type: ignore[arg-type]
            for event in record.events
        )
        return "\n".join(
            one.message for one in judge_record(replace(record, events=events)).findings
        )

    assert "the team of task t lacks a" in found("serve", robots=(0,))
    assert "and takes 4 there from dock" in found("walk", way=(Passed(0.0, WARD),), until=0.0)
    assert "the record says makespan" in found("over", at=99.0)
    assert "no fleet tells that form" in found("arrive", kind="form")
    assert "done of task t comes after 1, and takes 3" in found("serve", at=record.length - 1)


def test_breakdowns_and_tasks_at_random_are_drawn_as_in_the_simulator() -> None:
    """What the truth of the schedule's seed has: when r0 breaks down, and which tasks appear."""
    mission = ring([Task("t", WARD, {"a": 1})], arrivals=Arrivals(0.5, 10, duration=1))
    shaky = replace(mission.robots[0], breaks=Breakdown(0.05, (2, 5)))
    fleet = FleetMission(replace(mission, robots=(shaky, mission.robots[1])))
    faults = draw_faults(fleet, 5, 40.0)
    truth = fleet.truth(faults.seed)
    own = [(crash.at, crash.back) for crash in faults.crashes if crash.robot == 0]
    absences = [(away.lost, away.back) for away in truth.robots[0].absences]
    assert own == absences[: len(own)]
    assert own
    arrived = [order for order in faults.orders if order.task.name.startswith("call-")]
    assert [(order.at, (order.task.x, 0)) for order in arrived] == [
        (task.appears, task.at) for task in truth.tasks[1:]
    ]
    assert arrived


def test_who_cannot_come_to_the_base_is_met_where_it_was() -> None:
    """No road leads back from the ward: a robot that was there, or went there, stays there."""
    one_way = Roads(("dock", "ward"), {"ground": ((0, 4), (FAR, 0))})
    source = ring([Task("t", DOCK, {"a": 1})])
    fleet = FleetMission(replace(source, world=one_way))
    meeting = meeting_of(fleet, 0)
    assert meeting.place(DOCK, {}, 0.0) is None
    assert meeting.place(DOCK, {1: DOCK}, 0.0) == DOCK
    assert meeting.place(DOCK, {1: (1, 2.5)}, 0.0) == WARD
    assert meeting.place(WARD, {1: DOCK}, 0.0) is None  # it cannot get back itself
    assert fleet.reach(0, fleet.tasks[0])
    assert not fleet.reach(0, fleet.tasks[0], WARD)


DEAD_END = Roads(
    ("dock", "ward", "lab"),
    {
        "ground": ((0, 4, FAR), (FAR, 0, 2.5), (1, FAR, 0)),
        "cart": ((0, 4, 9), (FAR, 0, FAR), (9, FAR, 0)),
    },
)
"""Carts do not get away from the ward; others get round the ring."""


def dead_end(tasks: list[Task]) -> FleetMission:
    """Return a fleet of a robot that gets away from the ward, and a cart with `b` that does not."""
    robots = (Robot("r", DOCK, {"a": 1}), Robot("cart", DOCK, {"a": 1, "b": 1}, moves="cart"))
    what = ("a", "b")
    return FleetMission(
        Mission("dead end", DEAD_END, what, robots, tuple(tasks), time="continuous")
    )


def test_robots_that_miss_others_look_by_turns_where_some_cannot_get_away() -> None:
    """A turn takes 13, the longest way (from lab to ward by cart), and 10; all go by its age."""
    fleet = dead_end([Task("t", WARD, {"a": 2})])
    assert turns(fleet) == (WARD,)
    assert turn_time(fleet) == 23.0
    meeting = meeting_of(fleet, 0)
    ages = (0.0, 22.9, 23.1, 45.9, 46.1, 69.1)
    places = [meeting.place(DOCK, {1: DOCK}, age) for age in ages]
    assert places == [DOCK, DOCK, WARD, WARD, DOCK, WARD]
    assert meeting_of(fleet, 1).place(DOCK, {0: DOCK}, 23.1) == DOCK  # it would not come back
    assert meeting.place(DOCK, {}, 23.1) is None


def test_who_went_where_nobody_heard_of_and_cannot_come_back_is_met() -> None:
    """The cart goes to the ward for a task, while the other robot hears nothing from the start.

    Its last word is from the dock, where it never comes back to.
    """
    look, late = Task("look", WARD, {"b": 1}), Task("t", WARD, {"a": 2}, duration=3, appears=30.0)
    fleet, both = dead_end([look, late]), frozenset({0, 1})
    faults = Faults(radio=2.0, cuts=(Cut(both, both, 0.0, 20.0),))
    rehearsal, outcome, violations = play(fleet, plan_of(fleet), faults)
    assert (violations, outcome.status) == ([], "ended")
    assert rehearsal.world.done[1].robots == (0, 1)


def test_radios_reach_as_far_as_the_shorter_way_takes() -> None:
    """From lab to dock it is 1, the other way 6.5; two on one road are apart by their times."""
    fleet = FleetMission(ring([Task("t", WARD, {"a": 1})]))
    assert fleet.apart(DOCK, LAB) == fleet.apart(LAB, DOCK) == 1
    assert fleet.apart((1, 3.0), (1, 1.0)) == 2
    assert fleet.apart((1, 3.0), DOCK) == 3 + 3.5


def test_a_task_within_a_region_of_roads_is_looked_for_in_every_place_of_it() -> None:
    """Who stands in one place sees nothing of another, whatever the radius in which tasks are seen.

    From the dock it is 4 to the ward and 6.5 to the lab, where the task really is.
    """
    task = Task("t", DOCK, {"a": 1}, duration=1, within=7.0)
    fleet = FleetMission(ring([task], 1, finding_radius=9.0))
    assert fleet.hidden == {0: (DOCK, WARD, LAB)}
    seed = next(seed for seed in range(99) if fleet.truth(seed).tasks[0].at == LAB)
    ends = ended(fleet.source, Faults(seed=seed))
    assert 7.5 <= ends["t"] <= 9.0


def test_who_finds_no_way_to_its_task_is_unfit_until_it_has_another_one() -> None:
    """From the ward no road leads back to the dock: told to go there, it can be no help there."""
    one_way = Roads(("dock", "ward"), {"ground": ((0, 4), (FAR, 0))})
    source = ring([Task("t", DOCK, {"a": 1}), Task("u", WARD, {"a": 1})], 2)
    fleet = FleetMission(replace(source, world=one_way))
    plan = FleetPlan(PlanNote(1, 0, (0, 1), (0, 1), ((0,), (1,))))
    agent = Agent(fleet, 0, CoordinatedPlanner(), plan, 0.0)
    words = (Word(1, number) for number in range(1, 99))
    fit = []
    for tick in range(1, 60):
        report = Report(1.0, 0.0, agent.command.leg, number=tick)
        beat = Beat(next(words), plan=agent.keeper.plan.version, digest=agent.knowledge.digest)
        agent.tick(tick / 10, report, opened(fleet, 1, [Notice(EVERYBODY, beat)]))
        fit.append(agent.membership.is_fit)
    assert not all(fit)
    assert fit[-1]
    assert agent.service.goal == 1  # by its own plan, from where it is
