"""Records as files of JSON, a line for each step and what teams decide in it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from teamformer.base.whole_files import own_number, write_whole
from teamformer.files.mission_files import mission_to_tree
from teamformer.files.trees.mission import RECORD
from teamformer.record.files.endings import ending_to_tree
from teamformer.record.files.events import event_to_tree
from teamformer.record.files.truths import truth_to_tree
from teamformer.record.record import VERSION, Record, Step, TeamAt, Wants
from teamformer.record.telling.whole import told_of
from teamformer.record.told.trees import told_to_tree

LONG = ("steps", "decisions", "events")
"""Keys with a row for each step or event, which stands on a line of its own."""


def record_to_tree(record: Record) -> dict[str, Any]:
    """Return the record as the tree of its file."""
    tree = _tree(record)
    return tree | {key: list(tree[key]) for key in LONG if key in tree}


def _tree(record: Record) -> dict[str, Any]:
    """Return the tree of a record's file, its LONG rows as iterators, each to be made when needed.

    A record in memory beside all its rows would keep the garbage collector busy.
    """
    tree = {
        RECORD: VERSION,
        "mission": mission_to_tree(record.mission),
        "method": record.method,
        "seed": record.seed,
        **(_of_events(record) if record.is_continuous else _of_steps(record)),
        "end": ending_to_tree(record.end, record.is_continuous),
        "lower_bound": record.lower_bound,
    }
    if record.truth is not None:
        tree["truth"] = truth_to_tree(record.mission, record.truth)
    if record.plans:
        tree["plans"] = _lists(record.plans)
    if record.scouts:
        tree["scouts"] = _lists(record.scouts)
    if record.heeds:
        tree["heeds"] = list(record.heeds)
    if record.decisions:
        tree["decisions"] = _decisions_to_trees(record)
    if record.foresight != "scouting":
        tree["foresight"] = record.foresight
    tree["told"] = told_to_tree(told_of(record))
    return tree


def _of_steps(record: Record) -> dict[str, Any]:
    return {
        "orders": _lists(record.orders),
        "start": _lists(record.start),
        "steps": _steps_to_trees(record.steps),
    }


def _of_events(record: Record) -> dict[str, Any]:
    return {"events": [event_to_tree(event) for event in record.events]}


def _steps_to_trees(steps: Iterable[Step]) -> Iterator[dict[str, Any]]:
    """Yield steps as they stand in the file: what a team heads for is left out if it said so."""
    heads_for: dict[int, int | None] = {}
    for step in steps:
        tree = step_to_tree(step)
        for row, (slot, _, _, task) in zip(tree.get("teams", ()), step.teams, strict=True):
            if heads_for.get(slot) == task:
                row.pop()
            heads_for[slot] = task
        yield tree


def step_to_tree(step: Step) -> dict[str, Any]:
    """Return what a step changed as it stands in the file; what has nothing to say is left out."""
    return {key: _lists(value) for key, value in vars(step).items() if value}


def _decisions_to_trees(record: Record) -> Iterator[list[Any]]:
    for step, rows in record.decisions:
        yield [step, [_wants(row) for row in rows]]


def _wants(row: Wants) -> list[Any]:
    """Return what a team wants: what it has by its slot alone, a task only if it names one."""
    said = 3 if row.task is not None else 1 if row.counts is None else 2
    return [_lists(part) for part in row[:said]]


def _lists(value: Any) -> Any:
    """Turn tuples, nested ones too, into lists."""
    if isinstance(value, TeamAt):  # most of what there is; it holds no tuples
        return list(value)
    return [_lists(part) for part in value] if isinstance(value, tuple) else value


def save_record(record: Record, path: Path) -> None:
    """Write a record, one step or event a line, whole or not at all.

    Raises OSError where the folder cannot be written.
    """
    write_whole(path, "".join(_lines(_tree(record))))


def _lines(tree: Mapping[str, Any]) -> Iterator[str]:
    yield "{\n"
    last = list(tree)[-1]
    for key, value in tree.items():
        comma = "\n" if key == last else ",\n"
        if key in LONG:
            rows = ",\n".join(_compact(row) for row in value)
            yield f'"{key}": [\n{rows}\n]{comma}'
        elif key == "told":
            parts = ",\n".join(f"{_compact(part)}: {_compact(it)}" for part, it in value.items())
            yield f'"told": {{\n{parts}\n}}{comma}'
        else:
            yield f"{_compact(key)}: {_compact(value)}{comma}"
    yield "}\n"


def _compact(value: Any) -> str:
    # ASCII: a name given to a policy on the command line need not be text that UTF-8 can hold.
    return json.dumps(value, separators=(",", ":"), allow_nan=False, default=own_number)
