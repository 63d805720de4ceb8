"""What may happen in drawn missions in continuous time: losses, arrivals, calls off, surprises."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from teamformer.base.errors import MissionError
from teamformer.files.drawn.surprises import SURPRISES, make_uncertain
from teamformer.mission.checks.windows import find_hopeless_windows
from teamformer.mission.model import Absence, Mission, Task

WHEN = (5.0, 90.0)
"""Seconds at which something happens."""

FIFTH = 5
"""A fifth of the tasks appears later, or is called off."""

Incident = Callable[[Mission, np.random.Generator], Mission]


def robots_to_spare(mission: Mission) -> list[int]:
    """Return the robots without any one of which every task can be done, links included."""
    return [robot for robot in range(len(mission.robots)) if _can_do_without(mission, robot)]


def let_happen(mission: Mission, incident: str, rng: np.random.Generator) -> Mission:
    """Return the mission with an incident of `INCIDENTS`, drawn until it can be done as asked."""
    while True:
        try:
            changed = INCIDENTS[incident](mission, rng)
        except MissionError:  # as where linked tasks may need more than there is
            continue
        if not any(find_hopeless_windows(changed)):
            return changed


def _can_do_without(mission: Mission, robot: int) -> bool:
    left = tuple(other for number, other in enumerate(mission.robots) if number != robot)
    try:
        replace(mission, robots=left)
    except MissionError:
        return False
    return True


def _lose_one(mission: Mission, rng: np.random.Generator) -> Mission:
    number = int(rng.choice(robots_to_spare(mission)))
    robots = list(mission.robots)
    robots[number] = replace(robots[number], absences=(Absence(_draw_time(rng)),))
    return replace(mission, robots=tuple(robots))


def _let_arrive(mission: Mission, rng: np.random.Generator) -> Mission:
    tasks = list(mission.tasks)
    for number in _a_fifth(mission, rng):
        tasks[number] = replace(tasks[number], appears=_draw_time(rng))
    return replace(mission, tasks=tuple(tasks))


def _call_off(mission: Mission, rng: np.random.Generator) -> Mission:
    """Call off a fifth of the tasks, each some time after it is known."""
    tasks = list(mission.tasks)
    for number in _a_fifth(mission, rng):
        when = round(tasks[number].appears + _draw_time(rng), 1)
        tasks[number] = replace(tasks[number], cancelled=when)
    return replace(mission, tasks=tuple(tasks))


def _surprise(kind: str) -> Incident:
    """Return an incident that leaves something open; ranges of times need no whole numbers."""

    def happen(mission: Mission, rng: np.random.Generator) -> Mission:
        unsure = make_uncertain(mission, kind, rng)
        return replace(unsure, tasks=tuple(map(_by_the_clock, unsure.tasks)))

    return happen


def _by_the_clock(task: Task) -> Task:
    if task.lasts is None:
        return task
    least, most = task.lasts
    return replace(task, lasts=(float(least), float(most)))


INCIDENTS: Mapping[str, Incident] = {
    "lost": _lose_one,
    "arrivals": _let_arrive,
    "cancelled": _call_off,
    **{kind: _surprise(kind) for kind in SURPRISES},
}
"""By ending of a setting's name."""


def _a_fifth(mission: Mission, rng: np.random.Generator) -> list[int]:
    tasks = len(mission.tasks)
    chosen: list[int] = rng.permutation(tasks)[: tasks // FIFTH].tolist()
    return chosen


def _draw_time(rng: np.random.Generator) -> float:
    return round(float(rng.uniform(*WHEN)), 1)
