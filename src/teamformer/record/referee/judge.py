"""Judging a record: its decisions are played again, and everything that it tells is compared.

The first moment at which record and rules part is named. What comes after is not judged.
"""

from __future__ import annotations

from itertools import pairwise

from teamformer.mission.coordination import NEWS
from teamformer.record.event_rules.fleet_events import judge_fleet_events
from teamformer.record.event_rules.judging import judge_events
from teamformer.record.record import FLEET, Record
from teamformer.record.referee.ending import judge_ending, judge_start
from teamformer.record.referee.fleets import judge_fleet
from teamformer.record.referee.playing import Play
from teamformer.record.referee.truth import judge_truth
from teamformer.record.referee.verdict import Finding, Notes, Verdict
from teamformer.record.task_times import cost_of_record, lateness
from teamformer.record.telling.whole import told_of
from teamformer.record.told.trees import LAYOUT, told_to_tree

WHY_OVER = {
    "completed": "everything was done before",
    "infeasible": "some tasks could never be done any more",
    "step limit": "the step limit was reached before",
    "too late": "a task that must be done was missed before",
}


def judge(record: Record) -> Verdict:
    """Return where a record breaks the rules, or is not what they make of its decisions."""
    notes = Notes()
    judge_truth(record, notes)
    if record.is_continuous:
        done = _judge_events(record, notes)
    elif record.method == FLEET:
        done = judge_fleet(record, notes)
    else:
        done = _judge_steps(record, notes)
    if not notes.findings:
        _judge_told(record, notes)
    is_legal = not notes.findings
    return Verdict(
        findings=tuple(notes.findings),
        steps=len(record.events) if record.is_continuous else len(record.steps),
        tasks_done=done,
        cost=cost_of_record(record) if is_legal else None,
        late=lateness(record) if is_legal else {},
    )


def _judge_steps(record: Record, notes: Notes) -> int:
    """Play a record again, and return how many tasks were done, up to where it breaks the rules."""
    _judge_rows(record, notes)
    play = Play(record, notes)
    judge_start(record, play.world, notes)
    goes_on = play.begin()
    for number in range(1, len(record.steps) + 1):
        if goes_on and play.status != "running":
            notes.step = number
            notes.note(f"{WHY_OVER[play.status]}, and the record goes on")
            goes_on = False
        goes_on = goes_on and play.step(number)
    notes.step = 0
    if goes_on:
        judge_ending(record, play.world, play.status, notes)
    return len(play.world.done)


def _judge_events(record: Record, notes: Notes) -> int:
    """Judge a record in continuous time, and return how many tasks were done."""
    judge_them = judge_fleet_events if record.method == FLEET else judge_events
    for when, message in judge_them(record):
        notes.findings.append(Finding(max(0.0, when), message))
    return record.end.tasks_done


def _judge_told(record: Record, notes: Notes) -> None:
    """Check that what the record's file says that all comes to is what it comes to."""
    if record.told is None:
        return
    said, due = record.told, told_to_tree(told_of(record))
    keys = due.keys() | said.keys() if isinstance(said, dict) else due.keys()
    for key in sorted(keys - {LAYOUT}):
        if not isinstance(said, dict) or said.get(key) != due.get(key):
            notes.note(f"what is told of {key} is not what happened")


def _judge_rows(record: Record, notes: Notes) -> None:
    """Check that what is made in or after some step comes in their order, once for each."""
    last = len(record.steps)
    for name in ("orders", "plans", "scouts", "decisions"):
        steps = [made for made, _ in getattr(record, name)]
        if any(one >= other for one, other in pairwise(steps)):
            notes.note(f"the rows of {name} are not in order of steps, one for each")
        if steps and max(steps) > last:
            notes.note(f"{name} has a row of step {max(steps)}, but only {last} were made")
    if record.heeds != tuple(word for word in NEWS if word in record.heeds):
        notes.note("heeds has news twice or not in order")
    if any(step == 0 for step, _ in record.decisions):
        notes.note("decisions has a row of step 0, and the first step is 1")
    if any(not rows for _, rows in record.decisions):
        notes.note("decisions has a row without any")
