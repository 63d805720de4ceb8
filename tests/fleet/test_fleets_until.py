"""Fleets on missions that are over at a time, with tasks that may be left out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fleets import Watched, errand, plan_of, recorded, walked
from teamformer.fleet.agent.knowledge import Knowledge, Remembered
from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.walking import Lifted
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import SERVE, TaskFact
from teamformer.fleet.rehearsal.checking.checker import Checker
from teamformer.fleet.rehearsal.checking.trace import Worked
from teamformer.fleet.rehearsal.faults import Crash, Faults, Order
from teamformer.fleet.rehearsal.rehearse import judge, set_stage
from teamformer.mission.checks.rules import rules_of_fleets
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import save_record
from teamformer.record.record import Record
from teamformer.record.referee import judge as judge_record


def afternoon(tasks: list[Task], robots: int = 1, until: float = 20.0) -> FleetMission:
    """Return robots with `a` at the left end of a corridor, in a mission that is over at a time."""
    who = tuple(Robot(f"r{n}", (0, 0), {"a": 1}) for n in range(robots))
    mission = Mission("m", Grid(40, 1), ("a",), who, tuple(tasks), time="continuous", until=until)
    assert list(rules_of_fleets(mission)) == []
    return FleetMission(mission)


def missed(record: Record) -> dict[str, tuple[float, str]]:
    """Return when each task was missed that was, and why."""
    tasks = record.mission.tasks
    return {tasks[e.task].name: (e.at, e.why) for e in record.events if e.kind == "missed"}


FAR_OFF = errand("far", 18, duration=5, optional=True)
NEAR = errand("near", 4, duration=2)


def test_what_is_too_far_is_given_up_and_the_mission_is_over_when_the_rest_is(
    tmp_path: Path,
) -> None:
    """Nobody can end `far` by 20: the plan gives it up, and all is over with `near` at 6."""
    fleet = afternoon([NEAR, FAR_OFF])
    plan = plan_of(fleet).note
    assert (plan.order, plan.left_out, plan.given_up) == ((0,), (), (1,))
    outcome, record = recorded(fleet)
    assert outcome.status == "ended"
    assert 6.0 <= outcome.end <= 7.0
    assert missed(record) == {"far": (outcome.end, "too far")}
    assert (record.end.status, record.end.missed) == ("completed", ("far",))
    save_record(record, tmp_path / "record.json")
    assert read_record(tmp_path / "record.json") == record


def test_what_must_be_done_and_is_not_in_time_makes_the_mission_fail() -> None:
    """The robot is back at 12; there is no time left for what takes 10, and nobody begins it."""
    fleet = afternoon([errand("t", 0, duration=10)])
    outcome, record = recorded(fleet, Faults(crashes=(Crash(0, 1.0, 12.0),)))
    assert (outcome.status, record.end.status) == ("too late", "too late")
    assert missed(record) == {"t": (20.0, "nobody free")}
    assert [event.at for event in record.events if event.kind == "serve"] == [
        pytest.approx(0.0, abs=0.1)
    ]


def test_what_is_under_way_when_the_mission_is_over_is_not_done() -> None:
    """Breaking down for 3 makes it begin again at 8; its real duration shows to be 14, not 10."""
    fleet = afternoon([errand("t", 0, lasts=(1.0, 19.0)), replace(NEAR, optional=True)])
    seed = next(seed for seed in range(99) if fleet.truth(seed).tasks[0].duration > 15)
    outcome, record = recorded(fleet, Faults(seed=seed, crashes=(Crash(0, 2.0, 5.0),)))
    assert outcome.status == "too late"
    assert missed(record)["t"] == (20.0, "under way")


def test_a_load_that_is_carried_when_the_mission_is_over_is_set_down() -> None:
    """Taken up at 0, it is on its way to 30; at 20 it is at 20, and nobody takes it up any more."""
    world = FleetWorld(afternoon([errand("t", 0, to=(39, 0), optional=True)]))
    world.command(0, Command(1, (0, 0), 0, 0, True))
    world.advance(30.0)
    lifts = [move for move in world.moves if isinstance(move, Lifted)]
    assert lifts == [Lifted(0.0, 0, (0,), (0.0, 0.0)), Lifted(20.0, 0, (), (20, 0))]
    assert (world.missed, world.is_over, world.done) == ({0}, True, {})


def test_nobody_goes_to_what_it_could_not_end_with_the_way_of_its_load() -> None:
    """With 5 to carry and 1 to unload a load may be taken up until 14."""
    fleet = afternoon([errand("t", 0, to=(5, 0), unload=1)])
    task = fleet.tasks[0]
    assert fleet.ends_in_time(task, (0,), 14.0)
    assert not fleet.ends_in_time(task, (0,), 14.01)


def test_what_operators_add_may_be_missed_where_there_is_an_end() -> None:
    fleet = afternoon([NEAR])
    order = TaskFact(1 << 24, "late", 19.0, 0.0, (1,), 5.0)
    assert fleet.may_miss(order.key)
    outcome, record = recorded(fleet, Faults(orders=(Order(8.0, order),)))
    assert outcome.status == "ended"
    assert record.end.missed == ("late",)


def test_a_robot_takes_all_for_over_when_the_mission_is() -> None:
    """So it does with what it is told of later; what was done before is known as done."""
    fleet = afternoon([NEAR, FAR_OFF])
    knowledge = Knowledge(fleet, 0, Remembered())
    assert knowledge.happens_next == 20.0
    knowledge.let_happen(19.9)
    assert knowledge.over == set()
    knowledge.let_happen(20.0)
    assert (knowledge.over, knowledge.undone) == ({0, 1}, set())
    assert knowledge.add_task(TaskFact(1 << 24, "late", 1.0, 0.0, (1,)))
    assert knowledge.over == knowledge.tasks.keys()
    assert knowledge.mark_done(0, 20.5)


def test_to_begin_what_cannot_end_in_time_is_found() -> None:
    """Clocks may differ by 6%: from 20 less the 5 that it takes, 16 is just right and 17 is not."""
    fleet = afternoon([errand("t", 0, duration=5)])
    tasks = {task.key: task for task in fleet.tasks}
    for at, is_late in ((15.9, False), (17.0, True)):
        trace = [walked(0.0, 0, ((0, 0),), 0.0, 1.0), Worked(at, 0, 0, 0)]
        found = "\n".join(Checker(fleet, tasks).check(trace, ()))
        assert ("too late to end it" in found) == is_late


def test_every_promise_is_kept_with_an_end_under_schedules_of_faults() -> None:
    tasks = [
        errand("one", 3, duration=2),
        errand("both", 9, duration=3, optional=True, weight=3.0),
        errand("load", 5, to=(12, 0), unload=1, optional=True),
        errand("after", 12, duration=1, after=("load",), optional=True),
    ]
    tasks[1] = replace(tasks[1], needs={"a": 2})
    stage = set_stage(afternoon(tasks, robots=3, until=45.0))
    assert (stage.undisturbed.status, stage.undisturbed.tasks_done) == ("ended", 4)
    verdicts = [judge(stage, 2, number) for number in range(12)]
    assert all(verdict.is_good for verdict in verdicts)
    assert {verdict.outcome.status for verdict in verdicts} >= {"ended"}


def test_an_onlooker_tells_what_was_missed_once_the_mission_is_over() -> None:
    """Two units of time after the end, when it has been heard of all that was done in time."""
    watched = Watched(afternoon([NEAR, FAR_OFF, errand("two", 1, duration=18, optional=True)]))
    watched.run(8.0)
    assert not watched.watch.is_over
    while watched.watch.made < 23:
        watched.watch.step()
    record = watched.watch.record()
    assert watched.watch.is_over
    assert (record.end.status, record.end.missed) == ("completed", ("far", "two"))
    assert judge_record(record).findings == ()
    assert watched.watch.open_tasks() == []
    assert all(word.phase < SERVE for word in watched.watch.words.values())
