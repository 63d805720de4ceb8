"""Missions of which not everything is known: any mission, made uncertain in one way or in all."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from teamformer.model import Breakdown, Robot, Scenario, Task
from teamformer.plane import Plane

SURPRISES = ("durations", "needs", "needs30", "needs70", "places", "breakdowns", "mixed")
"""What may be uncertain; `needs30` is with a probability of 30%, `needs` of 50%."""

LASTS = (1, 10)
"""Steps that a task takes, nobody knows how many."""
CHANCE = 0.5
"""With what probability a task needs a capability that it may need."""
WITHIN = 3
"""How far a task may be from where it is believed to be, in cells or units."""
BREAKDOWN = Breakdown(0.005, (10, 40))
"""About every third robot in a hundred steps."""
MIXED_RATE = 0.0025
SHARE_MIXED = 0.5
"""Of the tasks, where all kinds are mixed: with uncertain durations, and with uncertain needs."""


def make_uncertain(mission: Scenario, kind: str, rng: np.random.Generator) -> Scenario:
    """Return a mission with surprises of a kind of `SURPRISES`.

    Of each capability that a task needs but one, drawn at random, and of each that it needs twice,
    one becomes what it may need.
    """
    tasks, robots = mission.tasks, mission.robots
    if kind == "durations":
        tasks = tuple(replace(task, lasts=LASTS) for task in tasks)
    elif kind == "places":
        within = WITHIN * (mission.world.unit if isinstance(mission.world, Plane) else 1.0)
        tasks = tuple(replace(task, within=within) for task in tasks)
    elif kind == "breakdowns":
        robots = _break(robots, BREAKDOWN.rate)
    elif kind == "mixed":
        tasks = tuple(
            replace(
                _may_need(task, CHANCE, rng) if is_open else task, lasts=LASTS if lasts else None
            )
            for task, is_open, lasts in zip(
                tasks,
                rng.random(len(tasks)) < SHARE_MIXED,
                rng.random(len(tasks)) < SHARE_MIXED,
                strict=True,
            )
        )
        robots = _break(robots, MIXED_RATE)
    else:
        percent = re.sub("^needs", "", kind)
        chance = int(percent) / 100 if percent else CHANCE
        tasks = tuple(_may_need(task, chance, rng) for task in tasks)
    return replace(mission, tasks=tasks, robots=robots, step_limit=0)


def _may_need(task: Task, chance: float, rng: np.random.Generator) -> Task:
    sure_cap = str(rng.choice(list(task.needs)))
    sure = {cap: max(int(cap == sure_cap), count - 1) for cap, count in task.needs.items()}
    open_caps = [cap for cap, count in task.needs.items() if count > sure[cap]]
    needs = {cap: count for cap, count in sure.items() if count > 0}
    return replace(task, needs=needs, may_need=dict.fromkeys(open_caps, chance))


def _break(robots: tuple[Robot, ...], rate: float) -> tuple[Robot, ...]:
    return tuple(
        replace(robot, breaks=None if robot.absences else replace(BREAKDOWN, rate=rate))
        for robot in robots
    )
