"""The referee of continuous time: honest records are legal, and each forgery is found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from hand_logs import ANN, BEAM, BOB, CRATE, EVENTS, RECORD, way
from teamformer.planning.continuous.continuous_mission import pose_mission
from teamformer.planning.continuous.rules import plan_continuous
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from teamformer.record.referee import judge
from teamformer.trials.continuous_trial import carry_out
from teamformer.world.continuous.events import Event, PlanMade, PlannedTask
from test_telling_events import clinic


def said(record: Record) -> list[str]:
    return [finding.message for finding in judge(record).findings]


def edited(number: int, **fields: Any) -> Record:
    """Return the record by hand with another event in the place of one."""
    events = list(EVENTS)
    events[number] = events[number]._replace(**fields)
    return replace(RECORD, events=tuple(events))


def without(number: int) -> Record:
    """Return the record by hand without an event; causes are counted anew."""
    kept = [event for n, event in enumerate(EVENTS) if n != number]
    earlier = [event._replace(cause=event.cause - (event.cause >= number)) for event in kept]
    return replace(RECORD, events=tuple(earlier))


def test_a_record_by_hand_is_legal() -> None:
    verdict = judge(RECORD)
    assert verdict.findings == ()
    assert (verdict.steps, verdict.tasks_done, verdict.cost, verdict.late) == (16, 2, None, {})


@pytest.mark.parametrize(
    ("forged", "message"),
    [
        (edited(1, until=3), "event 1, at 0: it is there at 2, and the record says 3"),
        (
            edited(1, way=way(0, 0.5, 0, 1, 2), until=1),
            "event 1, at 0: (1, 0) is passed at 1 by the rules and at 0.5 in the record",
        ),
        (
            edited(1, way=way(0, 1, 1, 2), until=1),
            "the way begins at (1, 0) at 0 in the record, by the rules at (0, 0) at 0",
        ),
        (
            edited(1, way=way(0, 1, 0, 1, 0, 1, 2), until=4),
            "event 1, at 0: the way is 4 long, and a way of 2 leads there",
        ),
        (
            edited(1, task=CRATE),
            "event 1, at 0: robot ann heads for task crate, and the plan has it do task beam",
        ),
        (
            edited(1, way=way(0, 1, 0, 1), until=1),
            "event 1, at 0: task beam is at (2, 0), and the way leads to (1, 0)",
        ),
        (edited(3, place=(1, 0)), "event 3, at 2: robot ann is at (2, 0), and arrives elsewhere"),
        (without(3), "event 3, at 8: robot ann arrives at 2, and does not"),
        (without(2), "event 2, at 2: robot bob is to head for task beam, and does not"),
        (
            edited(4, cause=1),
            "at 8: arrive hangs on event 3 (arrive) by the rules and on event 1 (walk)",
        ),
        (edited(5, until=9), "event 5, at 8: form is to end at 8.5, and the record says 9"),
        (edited(5, robots=(ANN,)), "event 5, at 8: the plan has [ann, bob] do task beam"),
        (without(5), "event 5, at 8.5: the team of task beam is there and does not form"),
        (edited(7, until=9), "event 7, at 8.5: serve is to end at 10, and the record says 9"),
        (edited(7, robots=(BOB,)), "event 7, at 8.5: the plan has [ann, bob] do task beam"),
        (edited(7, place=(3, 0)), "event 7, at 8.5: task beam is at (2, 0), and is done elsewhere"),
        (edited(8, at=9.5), "event 8, at 9.5: done of task beam is due at 10"),
        (edited(8, robots=(ANN,)), "event 8, at 10: [ann, bob] are at task beam"),
        (
            edited(8, cause=6),
            "at 10: done hangs on event 7 (serve) by the rules and on event 6 (formed)",
        ),
        (
            edited(9, cause=5),
            "at 10: walk hangs on event 8 (done) by the rules and on event 5 (form)",
        ),
        (
            edited(9, cause=10),
            "at 10: walk hangs on event 8 (done) by the rules and on event 10 (arrive)",
        ),
        (
            edited(9, cause=-1),
            "at 10: walk hangs on event 8 (done) by the rules and on nothing in the record",
        ),
        (
            edited(12, until=14, way=way(11.25, 2.75 / 3, 3, 4, 5, 6)),
            "event 12, at 11.25: (4, 0) is passed at 12.25 by the rules",
        ),
        (edited(13, place=(5, 0)), "event 13, at 14.25: it is unloaded elsewhere than it goes"),
        (edited(14, place=(3, 0)), "event 14, at 14.75: task crate is done at (6, 0)"),
        (edited(15, status="infeasible"), "the record says status completed; its last event says"),
        (without(15), "the last event does not say that the mission is over"),
        (edited(0, plan=PlanMade((), EVENTS[0].plan.tasks)), "the plan says as its reason: none"),  # type: ignore[union-attr]
        (edited(0, plan=PlanMade(("start",), (PlannedTask(BEAM, (ANN,)),))), "lacks weld"),
        (edited(0, plan=PlanMade(("start", "robot lost"), ())), "the news is: start"),
        (
            replace(RECORD, events=(EVENTS[0], Event(0, "lost", (ANN,), place=(0, 0)))),
            "event 1, at 0: by the mission it is not so that robot ann is lost now",
        ),
        (
            replace(RECORD, events=(EVENTS[0], Event(0, "know", (ANN,), BEAM, needs={}, cause=0))),
            "event 1, at 0: what task beam needs is known already",
        ),
        (replace(RECORD, end=replace(RECORD.end, makespan=14.5)), "the record says makespan 14.5"),
        (replace(RECORD, end=replace(RECORD.end, tasks_done=1)), "the record says tasks_done 1"),
        (replace(RECORD, end=replace(RECORD.end, cost=3.5)), "the record says cost 3.5"),
        (replace(RECORD, end=replace(RECORD.end, late={"beam": 2})), "the record says late"),
        (
            replace(RECORD, end=replace(RECORD.end, broken_links=(("beam", "crate"),))),
            "the record says broken_links",
        ),
        (replace(RECORD, lower_bound=15), "the lower bound 15 is above the makespan 14.75"),
    ],
)
def test_the_first_difference_is_named(forged: Record, message: str) -> None:
    assert message in said(forged)[0], said(forged)


def test_records_of_plans_are_legal_and_read_back() -> None:
    mission = clinic()
    plan = plan_continuous(pose_mission(mission), "plan", 0.2, None)
    assert plan is not None
    record = carry_out(mission, plan, "plan")
    read = record_from_tree(record_to_tree(record), "it")
    assert said(read) == []
    tree: Any = record_to_tree(record)
    tree["told"]["map"]["places"][0] = [0, 0]  # how roads are drawn is nobody's claim
    assert said(record_from_tree(tree, "it")) == []
    tree["told"]["services"][0][2] += 1
    assert said(record_from_tree(tree, "it")) == ["what is told of services is not what happened"]
