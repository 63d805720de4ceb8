"""What was done in the steps of a fleet's record: which of it one snapshot can show."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from teamformer.mission.model import Task
from teamformer.mission.parts.grid import Place

SLACK = 1e-9
"""By how many seconds something may come after the end of a step and still be of that step."""


@dataclass(frozen=True)
class Deed:
    """A task that was done in a step, or whose load was taken up, where, and by which robots."""

    task: int
    at: Place
    robots: tuple[int, ...]


def deed_of(number: int, tasks: Sequence[Task], robots: tuple[int, ...]) -> Deed:
    """Return that a task was done: a load, where it was brought."""
    task = tasks[number]
    return Deed(number, task.at if task.to is None else task.to, robots)


def deeds_by_step(
    finished: Iterable[tuple[float, int]], deeds: Mapping[int, Deed], step: float
) -> list[list[Deed]]:
    """Return what each step shows as done, from the first step to the last that shows anything.

    `finished` says when tasks were done, in order, and by which keys `deeds` has them.
    """
    waits = deque(finished)
    rows = list[list[Deed]]()
    waiting = list[Deed]()
    while waits or waiting:
        while waits and waits[0][0] <= (len(rows) + 1) * step + SLACK:
            waiting.append(deeds[waits.popleft()[1]])
        done, waiting = _at_once(waiting)
        rows.append(done)
    return rows


def _at_once(deeds: Sequence[Deed]) -> tuple[list[Deed], list[Deed]]:
    """Return the deeds that one step can show, and those that come in the next.

    A robot is in one team in a step: what it did with others than before waits for the next.
    """
    now, later = list[Deed](), list[Deed]()
    for deed in deeds:
        robots = set(deed.robots)
        is_clear = all(
            robots == set(other.robots) or robots.isdisjoint(other.robots)
            for other in (*now, *later)
        )
        (now if is_clear else later).append(deed)
    return now, later
