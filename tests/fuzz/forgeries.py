"""Forgeries of records: what is recorded is left out, doubled, or something else."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

from hypothesis import strategies as st

from drawing import pick
from edits import edit

Tree = dict[str, Any]
Forgery = Callable[[st.DrawFn, Tree], Tree | None]
"""Returns a forged record; None where there is nothing to forge."""


def leave_out(key: str) -> Forgery:
    """Return a forgery that leaves out an entry of a step."""
    return lambda draw, record: _change(draw, record, key, lambda entry: [])


def twice(key: str) -> Forgery:
    """Return a forgery that has an entry of a step twice."""
    return lambda draw, record: _change(draw, record, key, lambda entry: [entry, entry])


def done_by_another(draw: st.DrawFn, record: Tree) -> Tree | None:
    """Let another team have done a task."""
    robots = len(record["start"])
    if robots == 1:
        return None
    return _change(draw, record, "done", lambda entry: [[entry[0], (entry[1] + 1) % robots]])


def jump(draw: st.DrawFn, record: Tree) -> Tree | None:
    """Put a team where nobody can be."""
    return _change(draw, record, "teams", lambda at: [[at[0], at[1] + 900, *at[2:]]])


def other_makespan(draw: st.DrawFn, record: Tree) -> Tree | None:
    """Say that the last task was done a step sooner or later."""
    end = record["end"]
    if end["makespan"] is None:
        return None
    return record | {"end": end | {"makespan": end["makespan"] + pick(draw, (1, -1))}}


def other_counts(draw: st.DrawFn, record: Tree) -> Tree:
    """Say that there was one more of something than there was."""
    end, key = record["end"], pick(draw, ("steps", "tasks_done", "joins", "splits"))
    return record | {"end": end | {key: end[key] + 1}}


def robot_in_two_teams(draw: st.DrawFn, record: Tree) -> Tree | None:
    """Let a robot start in two teams."""
    if len(record["start"]) < 2:
        return None
    first, (slot, robots, x, y), *rest = record["start"]
    return record | {"start": [first, [slot, sorted([*robots, first[1][0]]), x, y], *rest]}


def fewer_steps(draw: st.DrawFn, record: Tree) -> Tree | None:
    """Leave out a step in which something was done."""
    numbers = [number for number, step in enumerate(record["steps"]) if "done" in step]
    if not numbers:
        return None
    number = pick(draw, numbers)
    return record | {"steps": record["steps"][:number] + record["steps"][number + 1 :]}


FORGERIES: dict[str, Forgery] = {
    "another makespan": other_makespan,
    "other counts": other_counts,
    "done by another": done_by_another,
    "jump": jump,
    "robot in two teams": robot_in_two_teams,
    "fewer steps": fewer_steps,
    **{f"no {key}": leave_out(key) for key in ("lost", "back", "done", "shown", "found")},
    **{f"twice {key}": twice(key) for key in ("joins", "splits", "lost", "teams", "done")},
}
"""Forgeries that are never legal."""


@st.composite
def forgeries(draw: st.DrawFn, name: str, record: Tree) -> Tree | None:
    """Return a record with a forgery of a kind; None where there is nothing to forge."""
    return FORGERIES[name](draw, copy.deepcopy(record))


@st.composite
def edited_records(draw: st.DrawFn, record: Tree) -> Any:
    """Return a record with something in it changed, legal or not."""
    for _ in range(pick(draw, (1, 1, 2))):
        record = edit(draw, record)
    return record


def _change(
    draw: st.DrawFn, record: Tree, key: str, change: Callable[[Any], list[Any]]
) -> Tree | None:
    """Let `change` replace one of the entries under a key of the steps."""
    spots = [(step, number) for step in record["steps"] for number in range(len(step.get(key, [])))]
    if not spots:
        return None
    step, number = pick(draw, spots)
    step[key][number : number + 1] = change(step[key][number])
    return record
