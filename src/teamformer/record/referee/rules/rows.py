"""Whether the rows of a record stand in order, so that nothing stands twice in two places."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from teamformer.record.record import Record, Step
from teamformer.record.referee.rules.verdict import Notes

BY_FIRST = ("teams", "done", "moved", "taken", "left", "pursued")
"""Rows of a step that begin with what they are about; and such that are only a number."""
NUMBERS = ("lost", "back", "named", "shown", "found")


def judge_rows(record: Record, notes: Notes) -> None:
    """Check that what was made after some steps comes in their order, once for each."""
    for name in ("orders", "plans", "scouts"):
        steps = [made for made, _ in getattr(record, name)]
        if any(one >= other for one, other in pairwise(steps)):
            notes.note(f"the rows of {name} are not in order of steps, one for each")
    if list(record.start) != sorted(record.start):
        notes.note("the starting teams are not in order of their slots")


def check_rows(step: Step, notes: Notes) -> None:
    """Check that all rows of a step are in order; doubled ones are judged with the rest."""
    keys: dict[str, Sequence[Any]] = {name: getattr(step, name) for name in NUMBERS}
    keys |= {name: [row[0] for row in getattr(step, name)] for name in BY_FIRST}
    keys["joins"] = [min(pair) for pair in step.joins]
    keys["splits"] = [min((*stay, *leave)) for stay, leave in step.splits if stay or leave]
    for name, rows in keys.items():
        if list(rows) != sorted(rows):
            notes.note(f"the rows of {name} are not in order")
    for stay, leave in step.splits:
        if list(stay) != sorted(stay) or list(leave) != sorted(leave):
            notes.note("the robots of a split are not in order")
    if len(set(step.named)) < len(step.named):
        notes.note("the record names the task of a team twice")
    if step.heard:
        notes.note("the record has robots hear one another, which only a fleet's has")
