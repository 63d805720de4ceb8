"""When tasks may begin and must have ended, and missions whose times cannot be kept or played."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task

LONGEST_PLAY = 1_000_000
"""Steps that a mission may take at least: every step is made and recorded, a minute for so many."""


def opening_step(task: Task) -> int:
    """Return how many steps have been made when a task may begin, those before it being done."""
    return max(math.ceil(task.appears), window_opens(task))


def window_opens(task: Task) -> int:
    """Return how many steps have been made when the window of a task begins."""
    return math.ceil(task.between[0]) if task.between else 0


def may_begin_at_once(task: Task) -> bool:
    """Say whether a task may begin in the first step."""
    return not task.after and opening_step(task) == 0


def latest_end(between: tuple[float, float] | None) -> float:
    """Return when a task must have ended not to be late."""
    return math.inf if between is None else between[1]


def find_endless_play(mission: Mission) -> Iterator[Problem]:
    """Return what makes a mission in steps so long that nobody waits for its end.

    A mission whose step limit is lower ends with that.
    """
    if mission.step_limit <= LONGEST_PLAY:
        return
    allowed = f"more than the {LONGEST_PLAY:,} steps that are played"
    remedy = "let a step stand for more time, set a lower step_limit"
    ends = earliest_ends(mission)
    for number, task in enumerate(mission.tasks):
        begins = max([0.0, *(ends[name] for name in task.after)])
        if ends[task.name] > LONGEST_PLAY >= begins:
            message = f"task '{task.name}' ends in step {ends[task.name]:,.0f} at the earliest"
            yield Problem(("tasks", number, _longest_part(task)), f"{message}, {allowed}; {remedy}")


def _longest_part(task: Task) -> str:
    """Return the key of a task that most of its time is for."""
    parts = {"duration": task.duration, "unload": task.unload, "appears": task.appears}
    parts["between"] = window_opens(task)
    return max(parts, key=parts.__getitem__)


def find_hopeless_windows(mission: Mission) -> Iterator[Problem]:
    """Return the tasks that are late in every plan, because of the tasks that they are after.

    The mission has no other faults. Durations that are not known count as short as they may be.
    Whoever builds a `Mission` may have such windows, and so may the truth of a mission: there a
    task may turn out to take long.
    """
    ends = earliest_ends(mission)
    for number, task in enumerate(mission.tasks):
        last = max(task.after, key=ends.__getitem__, default=None)
        if last is None or ends[last] <= _release(mission, task):
            continue
        due = latest_end(task.between)
        if ends[task.name] > due:
            message = (
                f"task '{task.name}' is to be done by {due:g}, but ends at {ends[task.name]:g} at "
                f"the earliest: it is after '{last}', which ends at {ends[last]:g} at the earliest"
            )
            remedy = f"move one of the windows, or drop '{last}' from after"
            yield Problem(("tasks", number, "between"), f"{message}; {remedy}")


def earliest_ends(mission: Mission) -> dict[str, float]:
    """Return when each task is over at the earliest, by name, without ways, teams and links."""
    ends: dict[str, float] = {}
    left = list(mission.tasks)
    while left:
        for task in left:
            if all(name in ends for name in task.after):
                begin = max([_release(mission, task), *(ends[name] for name in task.after)])
                end = begin + _least_time(mission, task)
                ends[task.name] = end if task.cancelled is None else min(end, task.cancelled)
        left = [task for task in left if task.name not in ends]
    return ends


def _release(mission: Mission, task: Task) -> float:
    """Return when a task may begin by its own keys."""
    return opening_step(task) if mission.time == "steps" else release_of(task)


def release_of(task: Task) -> float:
    """Return when a task may begin in continuous time, whoever is there."""
    return max(float(task.appears), task.between[0] if task.between else 0.0)


def _least_time(mission: Mission, task: Task) -> float:
    """Return what a task takes at least; in steps it begins in the step after it may."""
    duration = task.duration if task.lasts is None else task.lasts[0]
    return duration + task.unload + (1 if mission.time == "steps" else 0)
