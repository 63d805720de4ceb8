"""Fleets with loads: bodies, minds, the checker, records and onlookers, by hand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from fleets import plan_of, trio, walked
from small_worlds import make, robot, task
from teamformer.fleet.agent.knowledge import Knowledge, Remembered
from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.walking import Lifted, Walked
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import READY, SERVE, Beat, FactsNote, LoadFact, Message, Word
from teamformer.fleet.observer.watch import Watch
from teamformer.fleet.rehearsal.checking.checker import Checker
from teamformer.fleet.rehearsal.checking.trace import Event, Finished, Said, Trace, Worked
from teamformer.fleet.rehearsal.faults import Crash, Faults, Spell
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.fleet.rehearsal.rehearse import play
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.record import TaskAt, TeamAt
from teamformer.record.snapshots.deeds import Deed
from teamformer.record.snapshots.teams_seen import teams_shown
from teamformer.world.rules.constants import NOBODY


def load(needs: str, x: int, to: int, duration: int = 0, unload: int = 0) -> Task:
    return replace(task(needs, x, duration=duration), to=(to, 0), unload=unload)


def three_carriers(needs: str = "aa") -> FleetMission:
    """Return three robots at a load, the last at half the pace: L..........D"""
    robots = [robot("a", 2), robot("a", 2), robot("a", 2, speed=0.5)]
    return FleetMission(make(robots, [load(needs, 2, 10, duration=3, unload=2)]))


def at_work(mission: FleetMission, who: Sequence[int]) -> FleetWorld:
    """Return robots that have been told to serve the first task, at time 0."""
    world = FleetWorld(mission)
    for number in who:
        world.command(number, Command(1, (2, 0), 0, 0, True))
    return world


def lifts_of(world: FleetWorld) -> list[Lifted]:
    """Return the loads that were taken up and set down."""
    return [move for move in world.moves if isinstance(move, Lifted)]


def test_a_load_is_taken_up_carried_at_the_slowest_pace_and_unloaded() -> None:
    """3 s to take it up, 8 cells at half a cell a second, 2 s to unload."""
    world = at_work(three_carriers(), (0, 2))
    world.advance(2.9)
    assert not world.report(0).carries
    world.advance(3.0)
    assert lifts_of(world) == [Lifted(3.0, 0, (0, 2), (2.0, 0.0))]
    for now, x in ((4.9, 2), (5.0, 3), (18.9, 9), (19.0, 10)):
        world.advance(now)
        assert [world.place(number)[0] for number in (0, 2)] == [x, x]
        assert world.place_of(0)[0] == x
        assert world.report(0).carries
    world.advance(20.9)
    assert world.done == {}
    world.advance(21.0)
    assert (world.done[0].at, world.done[0].robots) == (21.0, (0, 2))
    assert (world.report(2).is_done, world.report(2).carries) == (True, False)


@pytest.mark.parametrize("how", ["crash", "stop"])
def test_it_is_set_down_where_those_left_cannot_carry_it(how: str) -> None:
    """At 8.5 s they have gone two cells, and half a cell that counts for nothing."""
    world = at_work(three_carriers(), (0, 2))
    world.advance(8.5)
    told = world.kill(2) if how == "crash" else world.command(2, Command(1, (2, 0), 0, 0, False))
    assert told == {0, 2}
    assert lifts_of(world)[1:] == [Lifted(8.5, 0, (), (4, 0))]
    report = world.report(0)
    assert (report.carries, report.load, report.is_gone) == (False, (4, 0), False)
    world.command(1, Command(2, (4, 0), 0, 0, True))
    world.advance(10.5)  # now robots 0 and 1 are there: 3 s to take it up, 6 s, 2 s
    world.advance(21.4)
    assert world.done == {}
    world.advance(21.5)
    assert world.done[0].robots == (0, 1)


def test_the_others_go_on_at_their_pace_where_they_can() -> None:
    """All three carry it for 2 s a cell; from 7 s on the two fast ones do, 6 cells in 6 s."""
    world = at_work(three_carriers(), (0, 1, 2))
    world.advance(7.0)
    world.kill(2)
    assert (world.place_of(0), world.report(0).carries) == ((4, 0), True)
    world.advance(15.0)
    assert (world.done[0].at, world.done[0].robots) == (15.0, (0, 1))


def test_nobody_moves_with_a_load_while_one_of_them_is_stuck() -> None:
    world = at_work(three_carriers(), (0, 1))
    world.advance(5.0)
    world.hold_fast(1)
    world.advance(20.0)
    assert (world.place(0), world.place(1), world.place_of(0)) == ((4, 0),) * 3
    world.let_go(1)
    world.advance(28.0)
    assert world.done[0].at == 28.0


def test_on_a_plane_a_load_goes_straight_on() -> None:
    crate = Task("crate", (1.0, 1.0), {"a": 1}, 2, to=(4.0, 5.0))
    mover = Robot("mover", (1.1, 1.0), {"a": 1}, 0.5)
    field = Plane(9.0, 9.0, arrival_radius=0.2)
    world = FleetWorld(FleetMission(Mission("field", field, ("a",), (mover,), (crate,))))
    world.command(0, Command(1, None, 0, 0, True))
    world.advance(7.0)  # it stands near enough; half of the 10 s that 5 m take
    assert world.place_of(0) == pytest.approx((2.5, 3.0))
    assert world.place(0) == pytest.approx((2.55, 3.0))
    world.advance(12.0)
    assert (world.done[0].at, world.place(0)) == (12.0, (4.0, 5.0))


def test_a_robot_sees_a_load_near_it_and_that_it_is_gone() -> None:
    mission = FleetMission(
        make([robot("a", 0), robot("a", 2)], [load("a", 2, 9)], sensing_radius=1.0)
    )
    world = FleetWorld(mission)
    world.command(0, Command(1, (2, 0), 0))
    world.advance(1.0)
    assert world.report(0).load == (2.0, 0.0)
    world.command(1, Command(1, (2, 0), 0, 1, True))
    world.advance(2.0)
    report = world.report(0)
    assert (report.load, report.is_gone) == (None, True)


def outcome_of(mission: FleetMission, faults: Faults) -> tuple[Outcome, Rehearsal]:
    rehearsal, outcome, violations = play(mission, plan_of(mission), faults)
    assert violations == []
    return outcome, rehearsal


def test_a_fleet_carries_as_by_hand() -> None:
    """4 s there, 3 s to take it up, 8 s on the way, 2 s to unload, and word gets round."""
    robots = [robot("a", 0), robot("a", 6)]
    outcome, _ = outcome_of(FleetMission(make(robots, [load("aa", 4, 12, 3, 2)])), Faults())
    assert outcome.makespan is not None
    assert 17.0 <= outcome.makespan <= 17.0 + 1.6


def test_who_stays_takes_it_up_again_with_who_comes() -> None:
    """Robot 1 breaks down as it carries, after 9 s; robot 2 comes from far to where it lies."""
    robots = [robot("a", 3), robot("a", 3), robot("a", 17)]
    mission = FleetMission(make(robots, [load("aa", 3, 9, 2)]))
    outcome, rehearsal = outcome_of(mission, Faults(crashes=(Crash(1, 6.5),)))
    assert (outcome.status, rehearsal.world.done[0].robots) == ("ended", (0, 2))


def test_a_load_that_nobody_can_tell_of_is_looked_for_on_its_way() -> None:
    """Robot 0 sets out alone, and breaks down with it; robot 1 looks for it cell by cell."""
    robots = [robot("a", 2), robot("b", 2)]
    tasks = [load("a", 2, 15, 1), task("b", 2, duration=1)]
    spare = robot("a", 0, speed=0.5)
    mission = FleetMission(make([*robots, spare], tasks, sensing_radius=0.0))
    outcome, rehearsal = outcome_of(mission, Faults(crashes=(Crash(0, 9.0),)))
    assert (outcome.status, rehearsal.world.done[0].robots) == ("ended", (2,))
    assert 2 < lifts_of(rehearsal.world)[1].place[0] < 15


def test_a_mission_is_over_once_the_load_of_who_is_stuck_for_good_is_set_down() -> None:
    """Its one robot takes the load up at 3, is stuck from 5 on, and lets go 5 s later."""
    mission = FleetMission(make([robot("a", 2)], [load("a", 2, 10, duration=3)]))
    outcome, _ = outcome_of(mission, Faults(stuck=(Spell(0, 5.0, None),)))
    assert (outcome.status, outcome.blocked_tasks) == ("infeasible", ("t0",))
    assert 10.0 <= outcome.end <= 13.0


@pytest.mark.parametrize("begin", [1.0, 8.0])
@pytest.mark.parametrize("stuck", [0, 1])
def test_who_carries_and_does_not_get_on_lets_go(stuck: int, begin: float) -> None:
    """It is held fast as they take it up, or on the way, for good; robot 2 takes its part.

    Whoever of the two lets go first, the one that is stuck has to notice it.
    """
    robots = [robot("a", 3), robot("a", 3), robot("a", 17)]
    mission = FleetMission(make(robots, [load("aa", 3, 12, 2)]))
    outcome, rehearsal = outcome_of(mission, Faults(stuck=(Spell(stuck, begin, None),)))
    assert (outcome.status, rehearsal.world.done[0].robots) == ("ended", (1 - stuck, 2))


def carried_record(tmp_path: Path) -> tuple[Rehearsal, Path]:
    """Return a rehearsal with a load that is set down and taken up again, and its record."""
    robots = [robot("a", 3), robot("a", 3), robot("a", 17)]
    mission = FleetMission(make(robots, [load("aa", 3, 9, 2)]))
    trace = Trace()
    rehearsal, outcome, _ = play(mission, plan_of(mission), Faults(crashes=(Crash(1, 6.5),)), trace)
    path = tmp_path / "record.json"
    save_record(record_of(rehearsal, outcome, trace.events, 0), path)
    return rehearsal, path


def test_the_record_of_a_rehearsal_has_what_was_carried(tmp_path: Path) -> None:
    rehearsal, path = carried_record(tmp_path)
    steps = read_record(path).steps
    first, down, again = lifts_of(rehearsal.world)
    assert [row for step in steps for row in step.left] == [TaskAt(0, *down.place)]
    taken = [number for number, step in enumerate(steps, start=1) if step.taken]
    assert taken == [pytest.approx(lift.at, abs=1.0) for lift in (first, again)]
    assert taken == sorted(taken)
    [done] = [number for number, step in enumerate(steps, start=1) if step.done]
    assert done > taken[1]


def test_a_load_that_is_set_down_where_it_was_taken_up_is_recorded(tmp_path: Path) -> None:
    """Robot 1 breaks down in the moment in which they set out."""
    mission = FleetMission(make([robot("a", 3), robot("a", 3)], [load("aa", 3, 9, 2)]))
    trace = Trace()
    rehearsal, outcome, _ = play(mission, plan_of(mission), Faults(crashes=(Crash(1, 3.3),)), trace)
    assert lifts_of(rehearsal.world)[1].place == (3, 0)
    save_record(record_of(rehearsal, outcome, trace.events, 0), tmp_path / "record.json")
    [left] = [row for step in read_record(tmp_path / "record.json").steps for row in step.left]
    assert left == TaskAt(0, 3, 0)


def test_a_load_that_is_taken_up_and_done_in_one_step_is_only_done(tmp_path: Path) -> None:
    """It is brought to where it lies."""
    mission = FleetMission(make([robot("a", 3)], [load("a", 3, 3)]))
    trace = Trace()
    rehearsal, outcome, _ = play(mission, plan_of(mission), Faults(), trace)
    assert len(lifts_of(rehearsal.world)) == 1
    steps = record_of(rehearsal, outcome, trace.events, 0).steps
    assert [row for step in steps for row in step.done] == [(0, 0)]
    assert [row for step in steps for row in step.taken] == []


def test_a_load_that_is_taken_up_after_something_was_done_is_shown_in_the_next_step() -> None:
    """Both happen in the first second; in a step a robot is drawn in one place."""
    carrier = Robot("r", (0.0, 0.5), {"a": 1})
    tasks = [Task("job", (0.0, 0.5), {"a": 1}), Task("load", (0.7, 0.5), {"a": 1}, to=(2.5, 0.5))]
    mission = FleetMission(Mission("plane", Plane(3.0, 1.0), ("a",), (carrier,), tuple(tasks)))
    trace = Trace()
    rehearsal, outcome, _ = play(mission, plan_of(mission), Faults(), trace)
    assert 0.7 < lifts_of(rehearsal.world)[0].at < 1.0
    steps = record_of(rehearsal, outcome, trace.events, 0).steps
    assert [(step.done, step.taken) for step in steps] == [
        (((0, 0),), ()),
        ((), ((1, 0),)),
        (((1, 0),), ()),
    ]
    assert steps[1].teams == (TeamAt(0, 0.7, 0.5, 1),)


def message(beat: Beat | FactsNote) -> Message:
    return Message(1, three_carriers().number, 0, -1, beat)


def test_an_onlooker_tells_who_carries_and_where_a_load_was_set_down() -> None:
    watch = Watch(three_carriers())
    for x, taken in ((2.0, ()), (3.0, ((0, 0),)), (4.0, ())):
        words = [Word(r, 2 + int(x), x, 0.0, 0, 0, SERVE) for r in (0, 1)]
        watch.hear(message(Beat(words[0], (words[1],))))
        assert watch.step().taken == taken
    watch.hear(message(FactsNote((), (), 1, (LoadFact(0, 1, 4.0, 0.0),))))
    assert watch.step().left == (TaskAt(0, 4, 0),)
    words = [Word(r, 9, 5.0, 0.0, 0, 0, SERVE) for r in (0, 1)]
    watch.hear(message(Beat(words[0], (words[1],), (0,))))
    assert watch.step().done == ((0, 0),)


def test_who_takes_up_a_load_is_recorded_as_its_team() -> None:
    """Robot 1 is with 0 in a team, as both say, and it alone is at work on the load."""
    mission = FleetMission(make([robot("a", 2), robot("a", 2)], [load("a", 2, 5)]))
    said = {0: (0, (2, 0)), 1: (0, (2, 0))}
    places, teams, doers = teams_shown(said, (), (Deed(0, (2, 0), (1,)),))
    assert (places[1], teams, doers) == ((2, 0), {0: (0,), 1: (1,)}, set())
    watch = Watch(mission)
    for x in (2.0, 3.0):
        words = [
            Word(0, 2 + int(x), 2.0, 0.0, 0, 0, READY),
            Word(1, 2 + int(x), x, 0.0, 0, 0, SERVE),
        ]
        watch.hear(Message(1, mission.number, 0, -1, Beat(words[0], (words[1],))))
        step = watch.step()
    assert (step.taken, step.splits) == (((0, 1),), (((0,), (1,)),))
    assert TeamAt(1, 2, 0, 0) in step.teams


def test_where_loads_lie_merges_in_any_order() -> None:
    one, two, tied = LoadFact(0, 1, 5.0, 0.0), LoadFact(0, 2, 7.0, 0.0), LoadFact(0, 2, 6.0, 0.0)
    digests = set()
    for order in ((one, two, tied), (tied, one, two), (two, tied, one, two)):
        knowledge = Knowledge(three_carriers(), 0, Remembered())
        for fact in order:
            knowledge.merge(FactsNote((), (), 0, (fact,)), 0.0)
        assert knowledge.place_of(0) == (7.0, 0.0)
        assert [(fact.x, fact.y) for fact in knowledge.open_tasks()] == [(7.0, 0.0)]
        digests.add(knowledge.digest)
    assert len(digests) == 1
    assert knowledge.see_load(0, (8, 0))
    assert not knowledge.see_load(0, (8.0, 0.0))
    assert Knowledge(three_carriers(), 0, Remembered(loads=(two,))).place_of(0) == (7.0, 0.0)


@pytest.mark.parametrize("fact", [LoadFact(0, 1, 5.5, 0.0), LoadFact(7, 1, 5.0, 0.0)])
def test_senseless_loads_are_refused(fact: LoadFact) -> None:
    knowledge = Knowledge(three_carriers(), 0, Remembered())
    assert not knowledge.take_load(fact)
    assert knowledge.refused == 1


def test_a_task_without_a_load_stays_where_it_is() -> None:
    assert not Knowledge(trio(), 0, Remembered()).take_load(LoadFact(0, 1, 5.0, 0.0))


def test_a_load_behind_a_wall_is_refused() -> None:
    world = Grid(20, 3, ("." * 20, "@" * 20, "." * 20))
    mission = FleetMission(make([robot("a", 2)], [load("a", 2, 10)], world))
    knowledge = Knowledge(mission, 0, Remembered())
    assert not knowledge.take_load(LoadFact(0, 1, 5.0, 2.0))
    assert knowledge.take_load(LoadFact(0, 1, 5.0, 0.0))


CELLS = tuple((x, 0) for x in range(2, 11))
"""The way of the load."""

GOOD: list[Event] = [
    *(Said(0.5, robot, 0, 0, READY, 2.6) for robot in (0, 1)),
    *(Worked(0.6, robot, 0, 0) for robot in (0, 1)),
    *(Said(0.6, robot, 0, 0, SERVE, 2.6) for robot in (0, 1)),
    Lifted(3.6, 0, (0, 1), (2, 0)),
    *(walked(3.6, robot, CELLS, 3.6, 1.0) for robot in (0, 1)),
    Finished(13.6, 0),
    *(Worked(13.6, robot, NOBODY, NOBODY) for robot in (0, 1)),
]
"""Robots 0 and 1 of the three take it up, bring it and unload it."""

LIFTS, FINISHES = 6, 9
"""Where in GOOD it is taken up, and done."""


def found(events: Sequence[Event]) -> str:
    mission = three_carriers()
    tasks = {task.key: task for task in mission.tasks}
    return "\n".join(Checker(mission, tasks).check(events, ()))


def test_a_good_trace_is_good() -> None:
    assert found(GOOD) == ""


def test_to_take_up_too_soon_is_found() -> None:
    early = [Lifted(3.0, 0, (0, 1), (2, 0)) if e == GOOD[LIFTS] else e for e in GOOD]
    assert "'t0' is taken up without its service" in found(early)


def test_to_take_up_elsewhere_is_found() -> None:
    away = walked(0.0, 1, ((2, 0), (3, 0)), 0.0, 0.2)
    assert "'t0' is taken up where it does not lie" in found([away, *GOOD])


def test_to_carry_too_fast_is_found() -> None:
    fast = [walked(3.6, e.robot, CELLS, 3.6, 0.9) if isinstance(e, Walked) else e for e in GOOD]
    assert "'r0' carries 't0' faster than all can who do" in found(fast)


def test_to_go_without_the_others_is_found() -> None:
    alone = [e for e in GOOD if not (isinstance(e, Walked) and e.robot == 1)]
    assert "load 't0' is done and was not brought" in found(alone)


def test_to_be_done_with_too_few_is_found() -> None:
    left = [*GOOD[:FINISHES], Worked(8.0, 1, NOBODY, NOBODY), GOOD[FINISHES]]
    assert "load 't0' is done and was not brought" in found(left)


def test_to_be_done_before_it_is_unloaded_is_found() -> None:
    soon = [Finished(13.0, 0) if e == GOOD[FINISHES] else e for e in GOOD]
    assert "load 't0' is done before it is unloaded" in found(soon)


def test_to_set_it_down_elsewhere_is_found() -> None:
    good = [*GOOD[:FINISHES], Worked(6.0, 1, NOBODY, NOBODY)]
    assert found([*good, Lifted(6.0, 0, (), (4, 0))]) == ""
    assert "set down where nobody carried it to" in found([*good, Lifted(6.0, 0, (), (5, 0))])
