"""Records with loads: honest ones are legal, and forged ones are found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coordinations import RandomPlans
from random_worlds import random_world, with_loads, with_surprises
from teamformer.methods.by_name import as_method
from teamformer.methods.coordinators.crews import Crews
from teamformer.methods.coordinators.shared_plan import SharedPlan
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.record.files.reading import record_from_tree
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record, Step, TaskAt
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial


@pytest.mark.parametrize("is_plane", [False, True], ids=["grid", "plane"])
@pytest.mark.parametrize(
    "player", [JoinAll(), JoinFitting(), Crews(), SharedPlan(), RandomPlans(3)]
)
@pytest.mark.thorough
def test_honest_records_with_loads_are_legal(player: object, is_plane: bool) -> None:
    rng = np.random.default_rng(5 + is_plane)
    taken = left = 0
    for number in range(25):
        mission = random_world(rng, is_plane=is_plane)
        mission = with_surprises(mission, rng) if number % 2 else mission
        record = run_trial(with_loads(mission, rng), as_method(player), number).record
        verdict = judge(record)
        assert verdict.is_legal, (number, verdict.findings)
        assert record_from_tree(record_to_tree(record), "record") == record
        taken += sum(len(step.taken) for step in record.steps)
        left += sum(len(step.left) for step in record.steps)
    assert taken > 25


def forged(record: Record, number: int, **changes: object) -> list[str]:
    """Return what the referee says of a record with one of its steps changed."""
    steps = list(record.steps)
    steps[number - 1] = replace(steps[number - 1], **changes)
    verdict = judge(replace(record, steps=tuple(steps)))
    return [finding.message.partition(": ")[2] for finding in verdict.findings]


def lost_on_the_way() -> Record:
    """Return a record in which b is lost beside a crate at x = 4, and c helps a to bring it to 8.

    a and b join in step 1, take it up in step 3, and have brought it to x = 4 by step 5.
    """
    robots = (
        Robot("a", (0, 0), {"lift": 1}),
        Robot("b", (0, 0), {"lift": 1}, absences=(Absence(5),)),
        Robot("c", (9, 0), {"lift": 1}),
    )
    crate = Task("crate", (2, 0), {"lift": 2}, to=(8, 0), unload=1)
    mission = Mission("lost", Grid(10, 1), ("lift",), robots, (crate,))
    return run_trial(mission, as_method(SharedPlan()), 0).record


def test_where_a_load_is_set_down_is_judged() -> None:
    record = lost_on_the_way()
    assert judge(record).is_legal
    assert record.steps[2].taken == ((0, 0),)
    assert record.steps[4].left == (TaskAt(0, 4, 0),)
    (again,) = [n for n, step in enumerate(record.steps, start=1) if step.taken and n > 3]
    assert record.steps[again - 1].taken == ((0, 0),)
    set_down, taken_up = "the load of crate is set down at", "takes up the load of crate"
    assert forged(record, 5, left=(TaskAt(0, 7, 0),)) == [
        f"by the rules {set_down} (4, 0); in the record {set_down} (7, 0)"
    ]
    assert forged(record, 5, left=()) == [
        f"by the rules {set_down} (4, 0), and the record does not say so"
    ]
    assert forged(record, 3, taken=()) == [
        f"by the rules the team of robot a {taken_up}, and the record does not say so"
    ]
    assert forged(record, 4, taken=((0, 0),)) == [
        f"the record says that the team of robot a {taken_up}, but by the rules it is not so"
    ]


def test_load_that_is_done_before_it_is_there_is_found() -> None:
    record = lost_on_the_way()
    steps = record.steps
    early: tuple[Step, ...] = (
        *steps[:-2],
        replace(steps[-2], done=steps[-1].done),
        replace(steps[-1], done=()),
    )
    findings = [finding.message for finding in judge(replace(record, steps=early)).findings]
    assert findings == [
        f"step {len(steps) - 1}: the record says that task crate is done by the team of robot a, "
        "but that team has not been at work on it for long enough"
    ]
