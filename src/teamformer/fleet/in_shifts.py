"""Whether robots of a fleet that work in shifts can still do a task together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import islice

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.mission.parts.grid import Place

MOST_SHIFTS = 50
"""So many shifts of each robot are looked at."""


def who_can(
    mission: FleetMission,
    task: TaskFact,
    places: Mapping[int, Place],
    age: float,
    spare: float = 0.0,
) -> tuple[int, ...]:
    """Return the robots that can do a task together at the first moment at which some can.

    They are there by then, and it fits into a shift of each, from an age of the mission on; nobody
    if that never is. `places` says where they are, and the task what it takes. So many seconds of
    each shift are left to `spare`.
    """
    able = {robot: at for robot, at in places.items() if mission.reach(robot, task, at)}
    comes = {r: mission.comes(r, at, (task.x, task.y), age) for r, at in able.items()}
    there = {robot: at for robot, at in comes.items() if at < math.inf}
    starts = {
        start for robot, at in there.items() for start in _starts(mission, robot, task, at, spare)
    }
    for start in sorted(starts):
        who = [robot for robot, at in there.items() if at <= start]
        who = [robot for robot in who if mission.fits(task, (robot,), start, spare) <= start]
        if mission.covers(who, task.needs):
            return tuple(sorted(who))
    return ()


def can_still_do(
    mission: FleetMission, task: TaskFact, places: Mapping[int, Place], age: float
) -> bool:
    """Say whether robots can do a task together in shifts that are left, by `who_can`."""
    is_free = not mission.has_shifts or not any(task.needs)
    return is_free or bool(who_can(mission, task, places, age))


def _starts(
    mission: FleetMission, robot: int, task: TaskFact, at: float, spare: float
) -> Iterator[float]:
    """Yield the moments from which a task fits into the next shifts of a robot that is there."""
    rota, step = mission.source.robots[robot].rota, mission.step
    for opens, _ in islice(rota.since(at / step), MOST_SHIFTS):
        start = max(at, opens * step)
        if mission.fits(task, (robot,), start, spare) <= start:
            yield start
