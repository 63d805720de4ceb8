"""Makes a schedule that fails as small as it gets, so that a person can follow what happens."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.rehearsal.faults import Faults
from teamformer.mission.model import Mission

Fails = Callable[[FleetMission, Faults], bool]
"""Says whether a mission still fails under a schedule."""

LISTS = ("cuts", "crashes", "pauses", "stuck", "orders", "withdrawals", "drained")
CALM: dict[str, Any] = {
    **{"loss": 0.0, "twice": 0.0, "late": 0.0, "delay": 0.0, "radio": None, "junk": 0.0},
    **{"stutter": 0.0, "skew": (), "drift": (), "lag": ()},
}


def shrink(
    mission: FleetMission, faults: Faults, fails: Fails, most: int = 200
) -> tuple[FleetMission, Faults]:
    """Return the smallest mission and schedule found that fail alike, in `most` trials.

    Takes away one thing after another, faults first, then tasks, and keeps what still fails.
    """
    trials = 0
    goes_on = True
    while goes_on and trials < most:
        goes_on = False
        for smaller in _smaller(mission, faults):
            if trials == most:
                break
            trials += 1
            if fails(*smaller):
                mission, faults = smaller
                goes_on = True
                break
    return mission, faults


def _smaller(mission: FleetMission, faults: Faults) -> Iterator[tuple[FleetMission, Faults]]:
    for name, calm in CALM.items():
        if getattr(faults, name) != calm:
            one: dict[str, Any] = {name: calm}
            yield mission, replace(faults, **one)
    for name in LISTS:
        items = getattr(faults, name)
        for number in range(len(items)):
            fewer: dict[str, Any] = {name: (*items[:number], *items[number + 1 :])}
            yield mission, replace(faults, **fewer)
    source = mission.source
    for half in _fewer_tasks(source):
        yield FleetMission(half, mission.step, mission.timers), faults


def _fewer_tasks(mission: Mission) -> Iterator[Mission]:
    tasks = mission.tasks
    if len(tasks) > 3:
        middle = len(tasks) // 2
        yield replace(mission, tasks=tasks[:middle])
        yield replace(mission, tasks=tasks[middle:])
    if len(tasks) > 1:
        for number in range(len(tasks)):
            yield replace(mission, tasks=(*tasks[:number], *tasks[number + 1 :]))
