"""Why tasks were left out of a mission that is over at a time."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from teamformer.mission.checks.optional import is_in_time
from teamformer.mission.checks.windows import opening_step, release_of
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, total


def why_left_out(truth: Mission, task: int, comes: Iterable[tuple[float, int]]) -> str:
    """Return why nobody has begun a task, in a word of `WHY_MISSED`.

    `comes` says when each robot can be there that goes there at once, from the start: the time or
    the step, and its number. A task is too far if not even those who are there first could end it
    in time.
    """
    wanted, there = truth.tasks[task], sorted(comes)
    if _earliest_start(truth, task, there) is None:
        return "nobody able"
    if truth.charging is not None:
        able = truth.charging.able(range(len(truth.robots)), task)
        there = [one for one in there if one[1] in able]
    if (at := _earliest_start(truth, task, there)) is None:
        return "too far for its battery"
    begins = opening_step(wanted) + 1 if truth.time == "steps" else release_of(wanted)
    takes = wanted.duration + wanted.unload
    if not is_in_time(max(at, begins) + takes, truth.until):
        return "too far"
    at = _earliest_start(truth, task, sorted(_in_shifts(truth, there, begins, takes)))
    if at is None or not is_in_time(max(at, begins) + takes, truth.until):
        return "no shift"
    if truth.cost is not None and wanted.optional:
        return "not worth it"
    return "nobody free"


def _in_shifts(
    truth: Mission, comes: Iterable[tuple[float, int]], begins: float, takes: float
) -> Iterator[tuple[float, int]]:
    """Yield when a task that takes so long first fits into a shift of each robot, and its number.

    A task that begins in a step takes that step, too. Who has no such shift is left out.
    """
    step = 1 if truth.time == "steps" else 0
    for at, number in comes:
        rota = truth.robots[number].rota
        fits = rota.fits(max(rota.walked(0, at), begins) - step, takes + step) + step
        if fits < math.inf:
            yield fits, number


def _earliest_start(truth: Mission, task: int, comes: Iterable[tuple[float, int]]) -> float | None:
    """Return when enough robots can be at a task, of those who come in turn, or None."""
    there: list[int] = []
    for at, number in comes:
        there.append(number)
        if covers(total(truth.robots[robot].can for robot in there), truth.tasks[task].needs):
            return at
    return None
