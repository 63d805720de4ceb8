"""Windows of time that a mission's precedence makes impossible to keep."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from teamformer.errors import Problem
from teamformer.mission.rules import latest_end, opening_step

if TYPE_CHECKING:
    from teamformer.model import Scenario, Task


def find_hopeless_windows(scenario: Scenario) -> Iterator[Problem]:
    """Return the tasks that are late in every plan, because of the tasks that they are after.

    The scenario has no other faults. Durations that are not known count as short as they may be.
    Whoever builds a `Scenario` may have such windows, and so may the truth of a mission: there a
    task may turn out to take long.
    """
    ends = _earliest_ends(scenario)
    for number, task in enumerate(scenario.tasks):
        last = max(task.after, key=ends.__getitem__, default=None)
        if last is None or ends[last] <= _release(scenario, task):
            continue
        due = latest_end(task.between)
        if ends[task.name] > due:
            message = (
                f"task '{task.name}' is to be done by {due:g}, but ends at {ends[task.name]:g} at "
                f"the earliest: it is after '{last}', which ends at {ends[last]:g} at the earliest"
            )
            remedy = f"move one of the windows, or drop '{last}' from after"
            yield Problem(("tasks", number, "between"), f"{message}; {remedy}")


def _earliest_ends(scenario: Scenario) -> dict[str, float]:
    """Return when each task ends at the earliest, by name: ways, teams and links are left out."""
    ends: dict[str, float] = {}
    left = list(scenario.tasks)
    while left:
        for task in left:
            if all(name in ends for name in task.after):
                begin = max([_release(scenario, task), *(ends[name] for name in task.after)])
                ends[task.name] = begin + _least_time(scenario, task)
        left = [task for task in left if task.name not in ends]
    return ends


def _release(scenario: Scenario, task: Task) -> float:
    """Return when a task may begin by its own keys."""
    return opening_step(task) if scenario.time == "steps" else release_of(task)


def release_of(task: Task) -> float:
    """Return when a task may begin in continuous time, whoever is there."""
    return max(float(task.appears), task.between[0] if task.between else 0.0)


def _least_time(scenario: Scenario, task: Task) -> float:
    """Return what a task takes at least; in steps it begins in the step after it may."""
    duration = task.duration if task.lasts is None else task.lasts[0]
    return duration + task.unload + (1 if scenario.time == "steps" else 0)
