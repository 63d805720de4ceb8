"""Missions of which not everything is known: any mission, made uncertain in one way or in all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from teamformer.mission.model import Arrivals, Breakdown, Delays, Mission, Robot, Task
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads

Kind = Callable[[Mission, np.random.Generator], Mission]
"""Makes a mission uncertain."""

LASTS = (1, 10)
"""Steps that a task takes, nobody knows how many."""
CHANCE = 0.5
"""With what probability a task needs a capability that it may need."""
WITHIN = 3
"""How far a task may be from where it is believed to be, in cells or units."""
NEIGHBOUR = 12.0
"""How long the way there takes at most on roads: a lane of a drawn site."""
DELAYS = Delays(0.1)
"""How often robots stand still."""
CALLS = Arrivals(0.1, 100)
"""About ten tasks that appear at random."""
BREAKDOWN = Breakdown(0.005, (10, 40))
"""About every third robot in a hundred steps."""
MIXED_RATE = 0.0025
"""The rate of breakdowns where kinds are mixed."""
SHARE_MIXED = 0.5
"""Of the tasks, where kinds are mixed: with uncertain durations, needs, places."""


def make_uncertain(mission: Mission, kind: str, rng: np.random.Generator) -> Mission:
    """Return a mission with surprises of a kind of `SURPRISES`."""
    return replace(SURPRISES[kind](mission, rng), step_limit=0)


def _durations(mission: Mission, rng: np.random.Generator) -> Mission:
    return replace(mission, tasks=tuple(replace(task, lasts=LASTS) for task in mission.tasks))


def _needs(chance: float) -> Kind:
    def make(mission: Mission, rng: np.random.Generator) -> Mission:
        return replace(mission, tasks=tuple(_may_need(t, chance, rng) for t in mission.tasks))

    return make


def _places(mission: Mission, rng: np.random.Generator) -> Mission:
    within = WITHIN * (mission.world.unit if isinstance(mission.world, Plane) else 1.0)
    within = NEIGHBOUR if isinstance(mission.world, Roads) else within
    return replace(mission, tasks=tuple(replace(task, within=within) for task in mission.tasks))


def _delays(mission: Mission, rng: np.random.Generator) -> Mission:
    return replace(mission, robots=tuple(replace(r, delays=DELAYS) for r in mission.robots))


def _calls(mission: Mission, rng: np.random.Generator) -> Mission:
    return replace(mission, arrivals=CALLS)


def _breakdowns(mission: Mission, rng: np.random.Generator) -> Mission:
    return replace(mission, robots=_break(mission.robots, BREAKDOWN.rate))


def _mixed(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return a mission with uncertain durations and needs, and with breakdowns."""
    tasks = mission.tasks
    tasks = tuple(
        replace(_may_need(task, CHANCE, rng) if is_open else task, lasts=LASTS if lasts else None)
        for task, is_open, lasts in zip(
            tasks,
            rng.random(len(tasks)) < SHARE_MIXED,
            rng.random(len(tasks)) < SHARE_MIXED,
            strict=True,
        )
    )
    return replace(mission, tasks=tasks, robots=_break(mission.robots, MIXED_RATE))


def _all(mission: Mission, rng: np.random.Generator) -> Mission:
    """Return the same mission with uncertain places, delays and calls too."""
    mixed = _mixed(mission, rng)
    hidden = zip(mixed.tasks, _places(mixed, rng).tasks, strict=True)
    tasks = tuple(away if rng.random() < SHARE_MIXED else there for there, away in hidden)
    return _calls(_delays(replace(mixed, tasks=tasks), rng), rng)


SURPRISES: Mapping[str, Kind] = {
    "durations": _durations,
    "needs": _needs(CHANCE),
    "needs10": _needs(0.1),
    "needs30": _needs(0.3),
    "needs70": _needs(0.7),
    "places": _places,
    "delays": _delays,
    "calls": _calls,
    "breakdowns": _breakdowns,
    "mixed": _mixed,
    "all": _all,
}
"""What may be uncertain; `needs10` is with a probability of 10%, `needs` of 50%."""


def _may_need(task: Task, chance: float, rng: np.random.Generator) -> Task:
    """Return a task of which one of each capability is not sure to be needed, but for one.

    That is drawn at random; of what it needs twice, one is sure.
    """
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
