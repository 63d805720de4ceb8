"""Rows: what is kept of a trial, one JSON object a line."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from types import UnionType
from typing import Any, get_args, get_origin, get_type_hints

Key = tuple[str, str, int]
"""Setting, method and world seed: what tells one trial from all others in a folder."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """A trial, as `run --json` tells it, and everything needed to run it again.

    `cost` is what a completed mission cost, None if it has none; `missed` is the weight of tasks
    that were missed, None without `until`. `decision_seconds` is by the clock on the wall,
    `decision_cpu_seconds` what the process used; a trial that ran with others `side_by_side` has
    its share of theirs, by its `decisions` (rows of views answered).
    `list_schedule` is the makespan of the list schedule along the task order, `relaxed` that of the
    planner's schedule; in both joining is free. `code` tells states of this package's files
    apart; `version` is its version, empty in rows older than this field.
    `curve` is the planner's: (seconds, makespan) of each improvement. In continuous time
    `makespan`, `steps` and the bars are in the mission's unit, `decisions` are plans, and
    `decision_cpu_seconds` are of the whole trial. None: not known, or not measured.
    """

    suite: str
    setting: str
    world_seed: int
    mission: str
    method: str
    seed: int
    completed: bool
    makespan: float | None
    cost: float | None = None
    missed: float | None = None
    steps: float | None = None
    tasks_done: int | None = None
    tasks: int
    robots: int
    capabilities: int
    joins: int | None = None
    splits: int | None = None
    illegal_decisions: int | None = None
    decisions: int | None = None
    decision_seconds: float | None = None
    decision_cpu_seconds: float | None = None
    total_seconds: float | None = None
    side_by_side: int = 1
    best_known: float | None = None
    lower_bound: float | None = None
    list_schedule: int | None = None
    relaxed: int | None = None
    relaxed_bound: int | None = None
    curve: list[list[float]] | None = None
    time_limit: float | None = None
    code: str
    rerun: str
    version: str = ""

    @property
    def key(self) -> Key:
        """Return what tells this trial from all others."""
        return self.setting, self.method, self.world_seed

    def to_line(self) -> str:
        """Return the row as a line of JSON."""
        return json.dumps(vars(self), ensure_ascii=False) + "\n"


LATER: dict[str, Any] = {"version": "", "cost": None, "missed": None}
"""What rows of older versions do not have."""

KINDS: dict[str, tuple[type, ...]] = {
    name: tuple(
        get_origin(kind) or kind
        for kind in (get_args(hint) if isinstance(hint, UnionType) else (hint,))
    )
    for name, hint in get_type_hints(Row).items()
}


def row_of(line: str) -> Row | None:
    """Read a line; None if it is no row, a cut-off one for example."""
    try:
        tree = json.loads(line)
    except ValueError:
        return None
    if not isinstance(tree, dict):
        return None
    tree = LATER | tree
    if set(tree) != {field.name for field in fields(Row)}:
        return None
    return Row(**tree) if all(_is_of(tree[name], KINDS[name]) for name in KINDS) else None


def _is_of(value: Any, kinds: tuple[type, ...]) -> bool:
    if isinstance(value, bool):
        return bool in kinds
    return isinstance(value, kinds) or (isinstance(value, int) and float in kinds)


def with_bars(rows: Iterable[Row]) -> list[Row]:
    """Fill in what all trials of a world know together: its best makespan and its best bound."""
    rows = list(rows)
    best: dict[tuple[str, int], float] = {}
    bound: dict[tuple[str, int], float] = {}
    listed: dict[tuple[str, int], int] = {}
    for row in rows:
        world = row.setting, row.world_seed
        if row.makespan is not None:
            best[world] = min(row.makespan, best.get(world, row.makespan))
        known = max(row.lower_bound or 0, row.relaxed_bound or 0)
        bound[world] = max(known, bound.get(world, 0))
        if row.list_schedule is not None:
            listed[world] = row.list_schedule
    return [
        replace(
            row,
            best_known=best.get((row.setting, row.world_seed)),
            lower_bound=bound[row.setting, row.world_seed] or None,
            list_schedule=listed.get((row.setting, row.world_seed)),
        )
        for row in rows
    ]
