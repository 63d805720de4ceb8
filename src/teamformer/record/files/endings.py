"""How a trial ended, as the record's file has it: with counts of steps, or in continuous time."""

from __future__ import annotations

from typing import Any

from teamformer.record.files.values import (
    DamageError,
    check_keys,
    count_of,
    inside,
    list_of,
    rows_of,
    short,
    text_of,
    time_of,
)
from teamformer.record.record import STATUSES, Ending

COUNTS = ("steps", "tasks_done", "joins", "splits", "illegal_decisions")
IN_STEPS = ("status", "makespan", *COUNTS, "blocked_tasks")
IN_CONTINUOUS_TIME = (
    *("status", "makespan", "tasks_done", "blocked_tasks", "cost", "late", "broken_links"),
)


def ending_to_tree(end: Ending, is_continuous: bool) -> dict[str, Any]:
    """Return an ending as the tree of its file."""
    if not is_continuous:
        tree = {key: _listed(getattr(end, key)) for key in IN_STEPS}
    else:
        tree = {key: _listed(getattr(end, key)) for key in IN_CONTINUOUS_TIME}
        tree |= {
            "late": dict(end.late),
            "broken_links": [list(pair) for pair in end.broken_links],
        }
    return tree | ({"missed": list(end.missed)} if end.missed else {})


def ending_from_tree(tree: Any, is_continuous: bool) -> Ending:
    """Return the ending of a file; raises `DamageError` for what is none."""
    keys = IN_CONTINUOUS_TIME if is_continuous else IN_STEPS
    check_keys(tree, (*keys, "missed"), keys)
    if tree["status"] not in STATUSES:
        raise DamageError(f"the status is {short(tree['status'])}, not one of {STATUSES}")
    blocked = tuple(text_of(name) for name in list_of(tree["blocked_tasks"]))
    missed = tuple(text_of(name) for name in list_of(tree.get("missed", [])))
    if is_continuous:
        return Ending(
            status=tree["status"],
            makespan=_time_or_none(tree["makespan"]),
            tasks_done=count_of(tree["tasks_done"]),
            blocked_tasks=blocked,
            cost=_time_or_none(tree["cost"]),
            late=_late(tree["late"]),
            broken_links=tuple(
                (text_of(name), text_of(other)) for name, other in rows_of(tree["broken_links"], 2)
            ),
            missed=missed,
        )
    makespan = None if tree["makespan"] is None else count_of(tree["makespan"])
    steps, tasks_done, joins, splits, illegal = (count_of(tree[key]) for key in COUNTS)
    counts = steps, tasks_done, joins, splits, illegal, blocked
    return Ending(tree["status"], makespan, *counts, missed=missed)


def _late(tree: Any) -> dict[str, float]:
    with inside("late"):
        if not isinstance(tree, dict):
            raise DamageError(f"{short(tree)} stands where a mapping belongs")
        return {name: time_of(by) for name, by in tree.items()}


def _time_or_none(value: Any) -> float | None:
    return None if value is None else time_of(value)


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
