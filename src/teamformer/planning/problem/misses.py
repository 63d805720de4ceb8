"""What it is worth that tasks are done by the end of a mission, where some may be left out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Ints
from teamformer.mission.model import Mission, Task

LEFT_OUT = 2**56
"""When a task that is left out starts in a search: after all others, and before NEVER."""

FINEST = 1000
"""How finely weights of tasks are told apart: so many parts of one."""

MOST_UNITS = 2**52
"""What all tasks together are worth at most: floats hold it exactly."""


class Misses(NamedTuple):
    """What is missed if tasks end later than `until`; empty arrays if a mission has no end."""

    until: Ints  # (1,) in ticks
    judged: Ints  # (tasks,) what plans are judged by for each that is missed
    leads: Ints  # (tasks,) the same of what leads a search
    optional: Ints  # (tasks,) whether it may be left out


def no_misses() -> Misses:
    """Return what a mission has whose end is that of its last task."""
    nothing = np.zeros(0, np.int64)
    return Misses(nothing, nothing, nothing, nothing)


def can_miss(misses: Misses) -> bool:
    """Say whether tasks can be missed."""
    return len(misses.until) > 0


def misses_of(
    mission: Mission, tasks: Sequence[Task], until: int, most: int, leg: int, cost: float
) -> Misses:
    """Return what is missed of some tasks of a mission that is over at a tick.

    Without `missed` in the mission's cost nothing outweighs a missed task: no plan is worth `most`.
    With it a weight of one costs `cost`. A search takes a missed task of mean weight to cost a
    `leg`, what a task takes a robot about with the way: it leaves out too much if that is less. One
    that must be done outweighs all others.
    """
    optional = np.array([task.optional for task in tasks], np.int64)
    weights = np.array([task.weight for task in tasks])
    if mission.cost is not None and "missed" in mission.cost:
        judged = leads = np.rint(weights * cost).astype(np.int64) * optional
    else:
        units = np.rint(weights * FINEST).astype(np.int64) * optional
        units //= max(1, math.gcd(*units.tolist()))
        judged = units * min(most, max(1, MOST_UNITS // (1 + int(units.sum()) * (len(tasks) + 1))))
        mean = max(1.0, float(units.sum()) / max(1, int(optional.sum())))
        leads = np.maximum(1, units * leg / mean).astype(np.int64) * optional
    must = 1 - optional
    return Misses(
        until=np.array([until], np.int64),
        judged=judged + must * (int(judged.sum()) + most),
        leads=leads + must * (int(leads.sum()) + leg),
        optional=optional,
    )
