"""Records of fleets are judged: honest ones are legal, and each kind of forgery is found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from fleets import PLANNER, Watched, plan_of, trio
from small_worlds import make, robot, task
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.fleet.rehearsal.checking.trace import Trace
from teamformer.fleet.rehearsal.faults import Crash, Faults, Order
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.of_rehearsal import record_of
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record, Step, TaskAt, TeamAt
from teamformer.record.referee import judge
from teamformer.record.snapshots.deeds import Deed
from teamformer.record.snapshots.writer import Sighting, SnapshotWriter, fleet_record


def by_hand() -> Record:
    """Two robots weld, then bring a load; a third stays where it is: a.t.b...L......G...c

    a (0) and b (4) meet at t (2) in step 2 and serve for three steps. They are at the load (8) in
    step 11, are there until step 12, and have brought it to 15 in step 19.
    """
    load = replace(task("ab", 8, duration=1), to=(15, 0))
    robots = [robot("a", 0), robot("b", 4), robot("ab", 19)]
    mission = make(robots, [task("ab", 2, duration=3), load])
    writer = SnapshotWriter(mission)
    places = [(1, 3), *[(2, 2)] * 4, *((x, x) for x in (3, 4, 5, 6, 7, 8, 8))]
    places += [(x, x) for x in range(9, 15)]
    for number, (one, other) in enumerate(places, start=1):
        team = 0 if number > 1 else 1
        said = {0: (0, (one, 0)), 1: (team, (other, 0)), 2: (2, (19, 0))}
        goal = 0 if number < 5 else 1
        done = [Deed(0, (2, 0), (0, 1))] if number == 5 else []
        taken = [Deed(1, (8, 0), (0, 1))] if number == 12 else []
        at_work = {0: (0, 1)} if 2 <= number <= 5 else {1: (0, 1)} if number > 10 else {}
        writer.add(mission, Sighting(said, {0: goal, 1: goal}, at_work, done, taken))
    said = {0: (0, (15, 0)), 1: (0, (15, 0)), 2: (2, (19, 0))}
    writer.add(mission, Sighting(said, {}, {1: (0, 1)}, [Deed(1, (15, 0), (0, 1))]))
    return fleet_record(mission, writer.steps, "completed")


def with_step(record: Record, number: int, **rows: Any) -> Record:
    """Return a record with other rows in a step."""
    steps = list(record.steps)
    steps[number - 1] = replace(steps[number - 1], **rows)
    return replace(record, steps=tuple(steps))


def messages(record: Record) -> list[str]:
    return [finding.message for finding in judge(record).findings]


def test_what_was_seen_by_hand_is_legal() -> None:
    record = by_hand()
    assert messages(record) == []
    assert [(n, step.done) for n, step in enumerate(record.steps, 1) if step.done] == [
        (5, ((0, 0),)),
        (19, ((1, 0),)),
    ]
    read = record_from_tree(record_to_tree(record), "r.json")
    assert (read, messages(read)) == (record, [])


def weaker(record: Record) -> Record:
    one, other, third = record.mission.robots
    robots = (one, replace(other, can=dict(one.can)), third)
    return replace(record, mission=replace(record.mission, robots=robots))


def sooner(record: Record) -> Record:
    """Let all that happens from step 16 on happen ten steps sooner."""
    return with_end(record, (*record.steps[:5], *record.steps[15:]))


def with_end(record: Record, steps: tuple[Step, ...]) -> Record:
    return fleet_record(record.mission, steps, record.end.status)


FORGERIES: dict[str, tuple[Callable[[Record], Record], str]] = {
    "done by who cannot": (weaker, "lacks b for t0"),
    "done twice": (
        lambda it: with_step(it, 9, done=((0, 0),)),
        "step 9: task t0 is done again, after step 5",
    ),
    "done elsewhere": (
        lambda it: with_step(it, 7, done=((1, 0),)),
        "step 7: task t1 at (15, 0) is done by the team of robot r0 elsewhere",
    ),
    "done by no team": (
        lambda it: with_step(it, 5, done=((0, 1),)),
        "step 5: task t0 is done by the team of robot r1, and there is none",
    ),
    "done too soon": (
        lambda it: with_step(it, 1, done=((0, None),)),
        "step 1: task t0 is done sooner than it can be",
    ),
    "not done": (
        lambda it: with_step(it, 5, done=()),
        "step 6: by what was seen it is so that the service of task t0 breaks off",
    ),
    "somewhere too soon": (
        lambda it: with_step(it, 6, teams=(TeamAt(0, 11, 0, 1),)),
        "step 6: robot r0 is at (11, 0), which takes it 8 steps at least",
    ),
    "all of it too soon": (sooner, "step 6: robot r0 is at (12, 0), which takes it 9 steps"),
    "nowhere": (
        lambda it: with_step(it, 6, teams=(TeamAt(0, -1, 0, 1),)),
        "step 6: the team of robot r0 is at (-1, 0), where nobody can be",
    ),
    "told again": (
        lambda it: with_step(it, 3, teams=(TeamAt(0, 2, 0, 0),)),
        "step 3: says again where the team of robot r0 is, which has not changed",
    ),
    "told of no team": (
        lambda it: with_step(it, 6, teams=(TeamAt(1, 3, 0, 1),)),
        "step 6: says where the team of robot r1 is, and there is no such team",
    ),
    "joined with nobody": (
        lambda it: with_step(it, 7, joins=((1, 0),)),
        "step 7: the team of robot r1 joins the team of robot r0, and there are no two such",
    ),
    "parted from nobody": (
        lambda it: with_step(it, 1, splits=(((0,), (1,)),)),
        "step 1: [r0, r1] part, and are no team",
    ),
    "lost twice": (
        lambda it: with_step(it, 7, lost=(1, 1)),
        "step 7: robot r1 is lost, and was so before",
    ),
    "back and never lost": (
        lambda it: with_step(it, 7, back=(1,)),
        "step 7: robot r1 is back, and was not lost",
    ),
    "taken up elsewhere": (
        lambda it: with_step(it, 9, taken=((1, 0),)),
        "step 9: the team of robot r0 takes up t1, which lies at (8, 0)",
    ),
    "taken up twice": (
        lambda it: with_step(it, 14, taken=((1, 0),)),
        "step 14: task t1 is taken up, and no such load lies there",
    ),
    "no load taken up": (
        lambda it: with_step(it, 2, taken=((0, 0),)),
        "step 2: task t0 is taken up, and no such load lies there",
    ),
    "set down too far": (
        lambda it: with_step(it, 2, left=(TaskAt(1, 19, 0),)),
        "step 2: the load of t1 cannot be at (19, 0) by then",
    ),
    "no load set down": (
        lambda it: with_step(it, 2, left=(TaskAt(0, 2, 0),)),
        "step 2: task t0 is set down, and there is no such load",
    ),
    "served by others": (
        lambda it: with_step(it, 2, served=((0, (0,)),)),
        "step 2: by what was seen it is so that task t0 is served by [r0, r1]",
    ),
    "unloads": (
        lambda it: with_step(it, 14, unloads=(1,)),
        "step 14: by what was seen it is not so that unloading of t1 begins",
    ),
    "found": (
        lambda it: with_step(it, 3, found=(0,)),
        "step 3: where task t0 is was known before",
    ),
    "moved": (
        lambda it: with_step(it, 3, moved=(TaskAt(0, 2, 0),)),
        "step 3: where task t0 is was known before",
    ),
    "shown": (
        lambda it: with_step(it, 3, shown=(0,)),
        "step 3: what task t0 needs was known before",
    ),
    "heard twice": (
        lambda it: with_step(it, 3, heard=((0, 1, "beat"), (0, 1, "beat"))),
        "step 3: the rows of heard are not in order, each of them once",
    ),
    "a plan": (lambda it: replace(it, heeds=("robot lost",)), "has heeds, which no fleet tells"),
    "an order": (lambda it: replace(it, orders=()), "the order is not that of the tasks"),
    "a start": (lambda it: replace(it, start=it.start[:1]), "the starting teams are not those"),
    "not over": (
        lambda it: replace(it, end=replace(it.end, status="interrupted", makespan=None)),
        "the record says status interrupted, with 0 tasks not done",
    ),
    "a step less": (
        lambda it: replace(it, end=replace(it.end, makespan=18)),
        "the record says makespan 18; it is 19",
    ),
    "a join more": (
        lambda it: replace(it, end=replace(it.end, joins=2)),
        "the record says joins 2; it is 1",
    ),
    "blocked": (
        lambda it: replace(it, end=replace(it.end, blocked_tasks=("t0",))),
        "some tasks that can never be done were done",
    ),
}


@pytest.mark.parametrize("kind", FORGERIES)
def test_a_forgery_is_found(kind: str) -> None:
    forge, told = FORGERIES[kind]
    found = messages(forge(by_hand()))
    assert any(told in message for message in found), found


def test_what_is_told_of_a_fleet_must_be_what_was_seen() -> None:
    tree = record_to_tree(by_hand())
    tree["told"]["services"][0][3] = 4
    assert messages(record_from_tree(tree, "r.json")) == [
        "what is told of services is not what happened"
    ]


EXTRA = TaskFact(9 << 24, "extra", 17.0, 0.0, (1, 0, 0))
CARRIERS = FleetMission(
    make(
        [robot("a", 3), robot("a", 3), robot("a", 17)],
        [replace(task("aa", 3, duration=2), to=(9, 0), unload=1), task("a", 12), task("aa", 15)],
    )
)


@pytest.mark.parametrize(
    ("mission", "faults"),
    [
        (trio(), Faults(crashes=(Crash(1, 9.0),), orders=(Order(3.0, EXTRA),))),
        (CARRIERS, Faults(crashes=(Crash(1, 6.5),))),
        (CARRIERS, Faults(crashes=(Crash(0, 7.5, 12.0),))),
    ],
    ids=["an order and a loss", "a load set down", "a carrier is back"],
)
def test_honest_rehearsals_are_legal(mission: FleetMission, faults: Faults) -> None:
    trace = Trace(with_messages=True)
    rehearsal = Rehearsal(mission, PLANNER, plan_of(mission), faults, trace)
    record = record_of(rehearsal, rehearsal.run(300.0), trace.events, 7)
    assert messages(record) == []


@pytest.mark.parametrize("since", [0.0, 4.0, 8.0, 12.0])
@pytest.mark.parametrize("crash", [(), (Crash(1, 6.5),)], ids=["undisturbed", "one lost"])
def test_what_is_seen_from_the_middle_on_is_legal(since: float, crash: tuple[Crash, ...]) -> None:
    rehearsal = Watched(CARRIERS, since, Faults(crashes=crash))
    rehearsal.run(300.0)
    for _ in range(4):
        rehearsal.watch.step()
    record = rehearsal.watch.record()
    assert (messages(record), record.end.status) == ([], "completed")
    assert [len(step.done) for step in record.steps if step.done]
