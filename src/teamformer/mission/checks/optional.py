"""Missions that are over at a time, and tasks that may be left out: what is wrong with these."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.checks.links import linked_with
from teamformer.mission.checks.windows import earliest_ends

if TYPE_CHECKING:
    from teamformer.mission.model import Mission


SAME = 1e-9
"""By such a share a time may be later: it is rounded."""


def has_optional(mission: Mission) -> bool:
    """Say whether a task of a mission may be left out."""
    return any(task.optional for task in mission.tasks)


def is_in_time(end: float, until: float | None) -> bool:
    """Say whether what ends at a time has ended when the mission is over; sums are rounded."""
    return until is None or end <= until + SAME * max(1.0, until)


def find_optional_problems(mission: Mission) -> Iterator[Problem]:
    """Return what is wrong with optional tasks, whose order and links are otherwise good."""
    if not has_optional(mission):
        if mission.cost and mission.cost.get("missed", 0) > 0:
            message = "the cost counts what is missed, but no task is optional"
            yield Problem(("cost", "missed"), f"{message}; make tasks optional, or drop missed")
        return
    first = next(number for number, task in enumerate(mission.tasks) if task.optional)
    if mission.until is None:
        message = f"task '{mission.tasks[first].name}' is optional, but the mission has no until"
        remedy = "write until: TIME, the time by which as much as possible is to be done"
        yield Problem(("tasks", first, "optional"), f"{message}; {remedy}")
    if mission.cost and "missed" not in mission.cost:
        message = "tasks are optional, but the cost has no missed, so that none is worth its way"
        yield Problem(("cost",), f"{message}; add missed to the cost, or drop the cost")
    yield from _problems_of_order(mission)
    yield from _problems_of_links(mission)


def _problems_of_order(mission: Mission) -> Iterator[Problem]:
    """Return the tasks that must be done and come after one that may be left out."""
    named = {task.name: task for task in mission.tasks}
    for number, task in enumerate(mission.tasks):
        for entry, name in enumerate(task.after if not task.optional else ()):
            if name in named and named[name].optional:
                message = f"task '{task.name}' is after '{name}', which may be left out"
                remedy = f"make '{task.name}' optional, too, or drop '{name}' from after"
                yield Problem(("tasks", number, "after", entry), f"{message}; {remedy}")


def _problems_of_links(mission: Mission) -> Iterator[Problem]:
    """Return the links between a task that may be left out and one that must be done."""
    names = {task.name for task in mission.tasks}
    if not all(names.issuperset(task.starts) for task in mission.tasks):
        return  # which has been told
    for number, others in enumerate(linked_with(mission.tasks)):
        task = mission.tasks[number]
        for other in sorted(others) if task.optional else ():
            fixed = mission.tasks[other]
            if not fixed.optional:
                message = f"task '{task.name}' is optional and '{fixed.name}' is not, but their"
                remedy = "make both optional, or drop the link"
                place = ("tasks", number if fixed.name in task.starts else other, "starts")
                yield Problem(place, f"{message} starts are linked; {remedy}")


def find_hopeless_until(mission: Mission) -> Iterator[Problem]:
    """Return the tasks that nobody can have done when the mission is over.

    The mission has no other faults. Durations that are not known count as short as they may be.
    """
    if mission.until is None:
        return
    ends = earliest_ends(mission)
    over = f"but the mission is over at {mission.until:g}"
    for number, task in enumerate(mission.tasks):
        if not task.optional and ends[task.name] > mission.until:
            message = f"task '{task.name}' ends at {ends[task.name]:g} at the earliest, {over}"
            remedy = "raise until, or make the task optional"
            yield Problem(("tasks", number, "duration"), f"{message}; {remedy}")
    if all(task.optional for task in mission.tasks) and min(ends.values()) > mission.until:
        message = f"the first task ends at {min(ends.values()):g} at the earliest, {over}"
        yield Problem(("until",), f"{message}; raise until")
