"""What holds in records of fleets, be they snapshots or events: the end, shifts, what is missed.

Times are in the mission's unit, in steps the steps made. Clocks of robots differ, and who watches
hears of things a little later.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import takewhile

from teamformer.mission.model import Mission
from teamformer.mission.parts.shifts import Rota
from teamformer.record.record import Ending

CLOCKS = 0.06
"""The share of a time by which clocks of robots may differ from one another."""

A_MOMENT = 0.05
"""In which things count as happening at once, in units of time."""

SEEN_WITHIN = 2.0
"""Units of time in which an onlooker tells of what has happened."""

TOLD_WITHIN = 4.0
"""Steps, or seconds if these are more, in which snapshots show what has been done."""


def may_miss(mission: Mission, task: int, at: float, is_last: bool) -> bool:
    """Say whether a task may be missed: the mission is over, or it is given up in the end."""
    until = mission.until
    is_over = until is not None and at >= until * (1 - CLOCKS) - A_MOMENT
    return is_over or (mission.tasks[task].optional and is_last)


def is_too_late(mission: Mission, at: float) -> bool:
    """Say whether nothing begins any more at a time, as the mission is over."""
    until = mission.until
    return until is not None and at > until * (1 + CLOCKS) + SEEN_WITHIN


def told_within(mission: Mission) -> float:
    """Return within how many steps snapshots show what has been done."""
    return TOLD_WITHIN * max(1.0, 1.0 / mission.seconds_a_step)


def is_in_shift(rota: Rota, begin: float, end: float) -> bool:
    """Say whether a robot is in one shift between two moments, as far as clocks agree."""
    slack = CLOCKS * end + SEEN_WITHIN
    shifts = takewhile(lambda shift: shift[0] <= end + slack, rota.since(min(begin, end) - slack))
    return any(a - slack <= begin and end <= b + slack for a, b in shifts)


def wrong_status(
    mission: Mission, end: Ending, undone: Collection[str], missed: Collection[int]
) -> Iterator[str]:
    """Yield what cannot be of how a mission ended; `undone` are the names of what is not over."""
    must = {task for task in missed if not mission.tasks[task].optional}
    if (end.status == "too late") != bool(must):
        which = "a task that must be done" if must else "no task that must be done"
        yield f"the record says status {end.status}, and {which} is missed"
    elif (end.status == "completed") == bool(undone) and not must:
        yield f"the record says status {end.status}, with {len(undone)} tasks not done"
    if bool(end.blocked_tasks) != (end.status == "infeasible"):
        yield f"the record says status {end.status}, and of which tasks, or does not"
    if not set(end.blocked_tasks) <= set(undone):
        yield "some tasks that can never be done were done"
