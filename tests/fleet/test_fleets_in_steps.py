"""Fleets whose missions count in steps keep to the keys that they know in continuous time."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from fleets import PLANNER, Watched, errand, errands_of_each_kind, recorded
from teamformer.fleet.agent.planning import make_plan
from teamformer.fleet.bodies.body import Command
from teamformer.fleet.bodies.world import FleetWorld
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.planner import FleetSituation
from teamformer.fleet.rehearsal.faults import Crash, Faults, Order
from teamformer.fleet.rehearsal.rehearse import judge, set_stage
from teamformer.mission.checks.rules import rules_of_fleets
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.zones import Zone
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.referee import judge as judge_record
from teamformer.record.task_times import done_steps, missed_tasks
from teamformer.record.telling.whole import told_of
from teamformer.world.continuous.events import Event


def corridor(
    tasks: list[Task], *robots: dict[str, Any], step: float = 1.0, **keys: Any
) -> FleetMission:
    """Return robots with `a` at the left end of a corridor; a step takes so many seconds."""
    own = enumerate(robots or ({},))
    who = tuple(Robot(f"r{n}", **{"at": (0, 0), "can": {"a": 1}} | keys) for n, keys in own)
    mission = Mission("m", Grid(40, 1), ("a",), who, tuple(tasks), **keys)
    assert list(rules_of_fleets(mission)) == []
    return FleetMission(mission, step)


def missed(record: Record) -> dict[str, tuple[float, str]]:
    """Return the step in which each task was missed that was, and why."""
    return {record.mission.tasks[k].name: why for k, why in missed_tasks(record).items()}


def done(record: Record) -> dict[str, float]:
    """Return the step in which each task was done."""
    return {record.mission.tasks[k].name: step for k, step in done_steps(record).items()}


def seen(watched: Watched, seconds: float) -> Record:
    """Return the record of an onlooker, which is right and read as it was written."""
    watched.run(seconds)
    while not watched.watch.is_over:
        watched.watch.step()
    record = watched.watch.record()
    assert judge_record(record).findings == ()
    assert record_from_tree(record_to_tree(record), "r.json") == record
    return record


FAR_OFF = errand("far", 18, duration=5, optional=True)
NEAR = errand("near", 4, duration=2)


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_what_could_not_end_in_time_is_given_up(step: float) -> None:
    """Nobody can end `far` by step 20; all is over with `near`, a tick after step 6."""
    outcome, record = recorded(corridor([NEAR, FAR_OFF], until=20, step=step))
    assert outcome.status == "ended"
    assert done(record) == {"near": 7}
    assert missed(record) == {"far": (7, "too far")}
    assert (record.end.status, record.end.makespan) == ("completed", 7)
    assert record.end.missed == ("far",)
    assert record_from_tree(record_to_tree(record), "r.json") == record


def test_what_must_be_done_and_is_not_by_the_last_step_makes_the_mission_fail() -> None:
    """The robot is back at 12 s, and 10 steps are left for what takes 11."""
    fleet = corridor([errand("t", 0, duration=11)], until=20)
    outcome, record = recorded(fleet, Faults(crashes=(Crash(0, 1.0, 12.0),)))
    assert (outcome.status, record.end.status) == ("too late", "too late")
    assert (len(record.steps), record.end.makespan) == (20, None)
    assert missed(record)["t"][0] == 20


def test_what_operators_add_may_be_missed_in_steps_too() -> None:
    order = TaskFact(1 << 24, "late", 19.0, 0.0, (1,), 5.0)
    outcome, record = recorded(corridor([NEAR], until=20), Faults(orders=(Order(8.0, order),)))
    assert outcome.status == "ended"
    assert record.end.missed == ("late",)


def test_a_load_that_is_carried_at_the_last_step_is_set_down() -> None:
    """Believed to be up at 10 and there at 22, it is taken up a moment after 16: seven cells."""
    load = errand("t", 0, lasts=(1, 19), to=(12, 0), optional=True)
    fleet = corridor([load, errand("u", 39)], {}, {"at": (39, 0)}, until=24)
    seed = next(seed for seed in range(999) if fleet.truth(seed).tasks[0].duration == 16)
    outcome, record = recorded(fleet, Faults(seed=seed))
    assert outcome.status == "ended"
    assert (record.steps[23].left, missed(record)) == (((0, 7, 0),), {"t": (24, "under way")})


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_an_onlooker_tells_what_was_missed_after_the_last_step(step: float) -> None:
    """Three steps, or seconds, after the end: then it has been heard of all that was done."""
    fleet = corridor([NEAR, FAR_OFF, errand("two", 5, duration=14, optional=True)], until=20)
    record = seen(Watched(FleetMission(fleet.source, step)), 8.0)
    closes = 20 + max(3, round(3 / step))
    assert missed(record) == {"far": (closes, "too far"), "two": (closes, "nobody free")}
    assert (record.end.status, record.end.missed) == ("completed", ("far", "two"))


def test_every_promise_is_kept_with_an_end_in_steps_under_schedules_of_faults() -> None:
    tasks = [
        errand("one", 3, duration=2),
        replace(errand("both", 9, duration=3, optional=True, weight=3.0), needs={"a": 2}),
        errand("load", 5, to=(12, 0), unload=1, optional=True),
        errand("after", 12, duration=1, after=("load",), optional=True),
    ]
    stage = set_stage(corridor(tasks, {}, {}, {}, until=45))
    assert (stage.undisturbed.status, stage.undisturbed.tasks_done) == ("ended", 4)
    for number in range(8):
        verdict = judge(stage, 2, number)
        assert verdict.is_good, (number, verdict)


TWICE = {"shifts": ((0, 10), (20, 60))}


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_nobody_begins_what_does_not_fit_into_its_shift_of_steps(step: float) -> None:
    """There at 6, it takes 5 steps: not until 10, so it begins when 20 steps are made."""
    outcome, record = recorded(corridor([errand("t", 6, duration=5)], TWICE, step=step))
    assert outcome.status == "ended"
    assert done(record) == {"t": 25}


def test_a_walk_pauses_between_shifts_of_steps() -> None:
    """Ten of fifteen cells are walked by 10, and the rest from 20 on."""
    _, record = recorded(corridor([errand("t", 15, duration=3)], TWICE))
    rows = {n: row.x for n, step in enumerate(record.steps, 1) for row in step.teams}
    assert (rows[10], 11 in rows, rows.get(20), rows[21]) == (9, False, None, 10)
    assert done(record) == {"t": 29}
    runs = [(run.begun, run.phase) for run in told_of(record).runs[0]]
    assert runs == [(0, "walking"), (10, "off"), (20, "walking"), (26, "serving")]


def test_a_team_begins_in_steps_in_which_all_work() -> None:
    """The first works until 12 and from 30 on, the other from 10 on: 4 fit a moment after 30."""
    task = replace(errand("t", 3, duration=4), needs={"a": 2})
    fleet = corridor([task], {"shifts": ((0, 12), (30, 60))}, {"shifts": ((10, 60),)})
    outcome, record = recorded(fleet)
    assert outcome.status == "ended"
    assert done(record) == {"t": 36}


def test_a_service_that_takes_longer_breaks_off_with_the_shift_of_steps() -> None:
    """It is believed to take 8 and takes 12: begun at 0 it ends 12 after 20."""
    fleet = corridor([errand("t", 0, lasts=(1, 15))], TWICE)
    seed = next(seed for seed in range(99) if fleet.truth(seed).tasks[0].duration == 12)
    outcome, record = recorded(fleet, Faults(seed=seed))
    assert outcome.status == "ended"
    assert done(record) == {"t": 32}


def test_another_robot_takes_over_what_no_shift_of_steps_is_left_for() -> None:
    """The first is away until its last shift is over: the other does it, from 40 on."""
    gone = Faults(crashes=(Crash(0, 1.0, 30.0),))
    fleet = corridor([errand("t", 5, duration=5)], {"shifts": ((0, 25),)}, {"shifts": ((40, 80),)})
    outcome, record = recorded(fleet, gone)
    assert outcome.status == "ended"
    assert done(record)["t"] in (50, 51, 52)
    outcome, _ = recorded(FleetMission(replace(fleet.source, robots=fleet.source.robots[:1])), gone)
    assert (outcome.status, outcome.blocked_tasks) == ("infeasible", ("t",))


def test_every_promise_is_kept_in_shifts_of_steps_under_schedules_of_faults() -> None:
    pair = replace(errand("both", 9, duration=3), needs={"a": 2})
    tasks = [errand("one", 3, duration=2), pair, errand("load", 5, to=(12, 0), unload=1)]
    shifts = ((0, 15), (25, 200)), ((5, 30), (40, 300)), ((0, 500),)
    stage = set_stage(corridor(tasks, *({"shifts": own} for own in shifts)))
    assert stage.undisturbed.status == "ended"
    for number in range(8):
        verdict = judge(stage, 3, number)
        assert verdict.is_good, (number, verdict)


def test_an_onlooker_sees_a_walk_pause_between_shifts_of_steps() -> None:
    """It walks until 10 and from 20 on, and works for 3: that is heard of a step later."""
    record = seen(Watched(corridor([errand("t", 15, duration=3)], TWICE)), 60.0)
    assert done(record)["t"] in (29, 30)


DOCK = Zone("dock", area=((3, 0), (5, 0)))
THREE = [errand(name, x, duration=6) for name, x in (("one", 3), ("two", 4), ("three", 5))]


@pytest.mark.parametrize(("room", "ends"), [(1, [9, 15, 21]), (2, [9, 10, 15]), (3, [9, 10, 11])])
def test_services_in_a_zone_take_turns_in_steps(room: int, ends: list[int]) -> None:
    """They are there after 3, 4 and 5 steps, and serve for 6; some moments go by beside that."""
    outcome, record = recorded(corridor(THREE, {}, {}, {}, zones=(replace(DOCK, room=room),)))
    assert outcome.status == "ended"
    assert sorted(done(record).values()) == pytest.approx(ends, abs=1)


def test_a_team_that_waits_for_room_is_not_shown_at_work() -> None:
    """All are there after 5 steps; what is served begins as the one before is done."""
    _, record = recorded(corridor(THREE, {}, {}, {}, zones=(DOCK,)))
    served = [(n, row) for n, step in enumerate(record.steps, 1) for row in step.served]
    ends = sorted((step, task) for task, step in done_steps(record).items())
    assert [n for n, _ in served] == [4, *(step for step, _ in ends[:-1])]
    assert [row[0] for _, row in served] == [task for _, task in ends]


def with_row(record: Record, number: int, **rows: Any) -> Record:
    """Return a record with other rows in a step."""
    steps = list(record.steps)
    steps[number - 1] = replace(steps[number - 1], **rows)
    return replace(record, steps=tuple(steps))


def test_what_cannot_be_missed_and_who_cannot_charge_are_found() -> None:
    _, record = recorded(corridor([NEAR, FAR_OFF], until=20))
    for rows, told in (
        ({"missed": ((0, "nobody free"),)}, "task near can still be done, or is over"),
        ({"charge": ((0, "charging"),)}, "robot r0 is said to charge, and is at no charger"),
    ):
        assert told in str(judge_record(with_row(record, 3, **rows)).findings)
    _, record = recorded(charged([errand("t", 14, duration=2)], robots=2))
    both = ((0, "charging"), (1, "charging"))
    assert "is at no charger" in str(judge_record(with_row(record, 4, charge=both)).findings)


def test_every_promise_is_kept_in_zones_in_steps_under_schedules_of_faults() -> None:
    both = replace(errand("both", 4, duration=3), needs={"a": 2})
    tasks = [*THREE, both, errand("out", 20, duration=2)]
    stage = set_stage(corridor(tasks, {}, {}, {}, zones=(DOCK,)))
    assert stage.undisturbed.status == "ended"
    for number in range(8):
        verdict = judge(stage, 3, number)
        assert verdict.is_good, (number, verdict)


def test_an_onlooker_sees_services_in_a_zone_take_turns_in_steps() -> None:
    record = seen(Watched(corridor(THREE, {}, {}, {}, zones=(DOCK,))), 60.0)
    assert sorted(done(record).values()) == pytest.approx([9, 15, 21], abs=2)


HALF = Battery(lasts=40, fills=8, starts=0.5, serving=0.5, waiting=0.25)


def charged(tasks: list[Task], robots: int = 1, step: float = 1.0, **battery: Any) -> FleetMission:
    """Return robots with batteries, and a charger at 2."""
    own = [{"battery": replace(HALF, **battery)} for _ in range(robots)]
    return corridor(tasks, *own, chargers=(Charger((2, 0)),), step=step)


def at_chargers(record: Record) -> list[tuple[int, int, str]]:
    """Return in which steps robots begin to do something else at chargers: step, robot, what."""
    rows = [(n, *row) for n, step in enumerate(record.steps, 1) for row in step.charge]
    return [(n, robot, what) for n, robot, what in rows]


@pytest.mark.parametrize("step", [1.0, 0.5])
def test_a_robot_charges_before_a_task_that_it_could_not_get_away_from_in_steps(
    step: float,
) -> None:
    """To 14 and back to the charger takes 14 + 12 + 1 of 20. It is there at 2 and full at 6.4."""
    outcome, record = recorded(charged([errand("t", 14, duration=2)], step=step))
    assert outcome.status == "ended"
    assert at_chargers(record) == [(4, 0, "charging"), (8, 0, "")]
    assert done(record) == {"t": 21}
    [levels] = told_of(record).levels
    assert levels[-1].full == pytest.approx(1 - 12 / 40)  # full at 7 as it set out
    assert record_from_tree(record_to_tree(record), "r.json") == record


def test_a_robot_in_steps_goes_straight_to_a_task_that_it_gets_away_from() -> None:
    _, record = recorded(charged([errand("t", 8, duration=2)]))
    assert (at_chargers(record), done(record)) == ([], {"t": 11})


def test_who_finds_a_charger_taken_queues_in_steps() -> None:
    """Both have to charge first; the second begins when it hears that the first is full."""
    task = replace(errand("t", 14, duration=2), needs={"a": 2})
    outcome, record = recorded(charged([task], robots=2))
    assert outcome.status == "ended"
    assert at_chargers(record) == [
        (3, 1, "queueing"),
        (4, 0, "charging"),
        (8, 0, ""),
        (9, 1, "charging"),
        (13, 1, ""),
    ]
    assert done(record) == {"t": 27}  # full after 12, there after 24, two at work


@pytest.mark.parametrize("time", ["steps", "continuous"])
def test_who_is_told_to_charge_no_more_leaves_its_charger_to_others(time: str) -> None:
    """The first is unplugged at 4, before it is full, and stays; the second charges from 7 on."""
    world = FleetWorld(FleetMission(replace(charged([errand("t", 14)], 2).source, time=time)))
    for at, robot, charge in ((0.0, 0, True), (4.0, 0, False), (5.0, 1, True)):
        world.advance(at)
        world.command(robot, Command(1, (2, 0), 0, 0, charge=charge))
    world.advance(8.0)
    kinds = [(e.at, e.kind, e.robots) for e in world.moves if isinstance(e, Event)]
    assert kinds == [(2.0, "charge", (0,)), (4.0, "unplugged", (0,)), (7.0, "charge", (1,))]


def test_a_robot_of_a_faster_pace_spends_less_on_a_way_in_steps() -> None:
    """On a plane with steps of half a second it walks 1 m a step: 27 of 20 to and from 14 m."""
    robot = Robot("r", (0.0, 0.0), {"a": 1}, speed=2.0, battery=HALF)
    task = Task("t", (14.0, 0.0), {"a": 1}, duration=2)
    mission = Mission(
        *("m", Plane(40, 1, step=0.5), ("a",), (robot,), (task,)), chargers=(Charger((2.0, 0.0)),)
    )
    fleet = FleetMission(mission, mission.seconds_a_step)
    assert fleet.charging is not None
    assert fleet.charging.wanted(0, fleet.tasks[0], fleet.step) == pytest.approx(1 + 12)
    _, record = recorded(fleet)
    assert [row[1:] for row in at_chargers(record)] == [(0, "charging"), (0, "")]


def test_who_runs_dry_in_a_fleet_in_steps_is_lost_then() -> None:
    """There a moment after 5 s, it waits for another, which takes 15 a unit: 16 are left."""
    task = replace(errand("t", 4), needs={"a": 2})
    gone = Faults(crashes=(Crash(1, 1.0, 100.0),))
    _, record = recorded(charged([task], robots=2, waiting=15), gone)
    lost = [(n, step.lost) for n, step in enumerate(record.steps, 1) if step.lost]
    assert lost == [(7, (0,))]


def test_what_is_too_far_for_some_batteries_is_done_by_the_others() -> None:
    """What an operator adds at 35 takes 67 there and back: only the second lasts for it."""
    fleet = charged([errand("t", 8)], robots=2)
    first, second = fleet.source.robots
    second = replace(second, battery=replace(HALF, lasts=200))
    fleet = FleetMission(replace(fleet.source, robots=(first, second)))
    order = TaskFact(1 << 24, "far", 35.0, 0.0, (1,), 1.0)
    situation = FleetSituation({0: (30.0, 0.0), 1: (0.0, 0.0)}, (order,), age=1.0)
    note = make_plan(fleet, PLANNER, situation, 1, 0)
    assert (note.order, note.coalitions) == ((order.key,), ((1,),))


def test_every_promise_is_kept_with_batteries_in_steps_under_schedules_of_faults() -> None:
    stage = set_stage(charged(errands_of_each_kind(), robots=3))
    assert stage.undisturbed.status == "ended"
    for number in range(8):
        verdict = judge(stage, 3, number)
        assert verdict.is_good, (number, verdict)


def test_an_onlooker_tells_who_charges_in_steps() -> None:
    record = seen(Watched(charged([errand("t", 14, duration=2)])), 60.0)
    assert [row[1:] for row in at_chargers(record)] == [(0, "charging"), (0, "")]
    assert done(record) == {"t": 21}
