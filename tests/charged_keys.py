"""Other keys for random missions with batteries: each alone, or several at once."""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from charging_missions import charged_mission
from teamformer.base.errors import MissionError
from teamformer.files.drawn.surprises import make_uncertain
from teamformer.mission.checks.rules import rules_not_run
from teamformer.mission.model import Absence, Arrivals, Delays, Mission
from teamformer.mission.parts.zones import Zone
from teamformer.record.record import Record

ROTAS = (((0.0, 150.0), (170.0, 400.0)), ((20.0, 330.0),), ((0.0, 90.0), (100.0, 320.0)), ())
EVERY = 420.0
MOST_DRAWS = 1000


def with_windows(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission half of whose tasks have windows."""
    tasks = tuple(
        replace(task, between=(begin := rng.randint(0, 120), begin + rng.randint(30, 90)))
        if rng.random() < 0.5
        else task
        for task in mission.tasks
    )
    return replace(mission, tasks=tasks)


def with_shifts(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission whose robots work in shifts that come again."""
    robots = tuple(
        replace(robot, shifts=shifts, every=EVERY if shifts else 0.0)
        for robot in mission.robots
        for shifts in [rng.choice(ROTAS)]
    )
    return replace(mission, robots=robots)


def with_optional(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission that is over before all its tasks are done, but for a few all optional."""
    ends = {task.name for task in mission.tasks if rng.random() < 0.15 and not task.after}
    tasks = tuple(
        replace(task, optional=task.name not in ends, weight=rng.choice([1, 1, 2, 5]))
        for task in mission.tasks
    )
    cost = mission.cost and {**mission.cost, "missed": 20}
    return replace(mission, tasks=tasks, until=float(rng.randint(70, 160)), cost=cost)


def with_cost(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission whose plans have a cost in which the time on the way counts."""
    cost = {"makespan": 1, "travel": rng.choice([0.2, 1, 5])}
    if mission.until is not None:
        cost["missed"] = 20
    return replace(mission, cost=cost)


def with_loads(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission half of whose tasks have loads."""
    spots = [task.at for task in mission.tasks]
    tasks = tuple(
        replace(task, to=to, unload=float(rng.randint(0, 5)))
        if rng.random() < 0.5 and (to := rng.choice(spots)) != task.at
        else task
        for task in mission.tasks
    )
    return replace(mission, tasks=tasks)


def with_zones(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission most of whose tasks are in a zone with little room, and some in another."""
    names = [task.name for task in mission.tasks]
    dock = tuple(name for name in names if rng.random() < 0.8) or tuple(names)
    tool = tuple(name for name in names if rng.random() < 0.4)
    zones = [Zone("dock", tasks=dock, room=rng.choice([1, 1, 2]))]
    zones += [Zone("tool", tasks=tool)] if len(tool) > 1 else []
    return replace(mission, zones=tuple(zones))


def with_links(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission in which some tasks start so long after the one before them."""
    tasks = list(mission.tasks)
    for number in range(1, len(tasks), 2):
        one, other = tasks[number], tasks[number - 1]
        if rng.random() < 0.7 and not one.after and not other.after:
            gap = (least := rng.randint(0, 10), least + rng.choice([0, 10]))
            tasks[number] = replace(one, starts={other.name: gap})
    return replace(mission, tasks=tuple(tasks))


def with_delays(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission half of whose robots are held up at times."""
    robots = tuple(
        replace(robot, delays=Delays(0.2, rng.randrange(99))) if rng.random() < 0.5 else robot
        for robot in mission.robots
    )
    return replace(mission, robots=robots)


def with_losses(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission half of whose robots are lost and back."""
    robots = tuple(
        replace(robot, absences=(Absence(rng.randint(10, 60), rng.randint(70, 120)),))
        if rng.random() < 0.5
        else robot
        for robot in mission.robots
    )
    return replace(mission, robots=robots)


def with_appearing(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission in which some tasks appear later."""
    tasks = tuple(
        replace(task, appears=rng.randint(1, 90)) if rng.random() < 0.3 else task
        for task in mission.tasks
    )
    return replace(mission, tasks=tasks)


def with_arrivals(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission in which tasks appear at random."""
    return replace(mission, arrivals=Arrivals(0.05, 60, 2, 5))


def with_hidden(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission in which some tasks are near to where they are believed to be."""
    tasks = tuple(
        replace(task, within=3.0) if rng.random() < 0.5 else task for task in mission.tasks
    )
    return replace(mission, tasks=tasks)


def with_surprises(mission: Mission, rng: random.Random) -> Mission:
    """Return a mission in which tasks last as long as nobody knows, and may need more."""
    return make_uncertain(
        mission,
        "durations" if rng.random() < 0.5 else "needs",
        np.random.default_rng(rng.randrange(99)),
    )


KEYS: Mapping[str, Callable[[Mission, random.Random], Mission]] = {
    "windows": with_windows,
    "shifts": with_shifts,
    "optional": with_optional,
    "cost": with_cost,
    "loads": with_loads,
    "zones": with_zones,
    "links": with_links,
    "delays": with_delays,
    "arrivals": with_arrivals,
    "hidden": with_hidden,
    "surprises": with_surprises,
    "losses": with_losses,
    "appearing": with_appearing,
}


FORESEEN = ("windows", "shifts", "optional", "cost", "loads", "zones", "links")
"""The keys with which a run is as its plan foresees it."""


def check_foreseen(record: Record) -> None:
    """Check that tasks end when the first plan of a record says, if it can be kept."""
    if record.end.status == "too late":
        return  # what must be done takes longer than the mission
    plan = next(event.plan for event in record.events if event.plan is not None)
    done = {event.task: event.at for event in record.events if event.kind == "done"}
    assert [done.get(row.task) for row in plan.tasks] == [
        pytest.approx(row.end, rel=1e-9, abs=1e-9) for row in plan.tasks
    ]


def drawn_with(keys: str, seed: int, robots: int = 4, tasks: int = 6) -> Mission:
    """Draw a mission with batteries that has some keys, such as `windows shifts`."""
    rng = random.Random(seed)
    for _ in range(MOST_DRAWS):
        mission = charged_mission(rng.randrange(10**6), robots, tasks)
        try:
            for key in keys.split():
                mission = KEYS[key](mission, rng)
        except MissionError:
            continue
        if any(rules_not_run(mission)):
            continue
        return replace(mission, name=f"{keys} {seed}")
    raise AssertionError(f"no mission with {keys} can be done")
