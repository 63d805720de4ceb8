"""What a robot can be about in a step: the phases that records, tables and chains tell."""

from __future__ import annotations

import math

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.rules.constants import NOBODY

PHASES = (
    *("walking", "waiting", "forming", "serving"),
    *("loading", "carrying", "unloading"),
    *("idle", "lost", "off", "charging", "queueing"),
)
WALKING, WAITING, FORMING, SERVING, LOADING, CARRYING, UNLOADING, IDLE, LOST, OFF = PHASES[:-2]
CHARGING, QUEUEING = PHASES[-2:]
"""A load is not served: it is loaded where it lies, carried, and unloaded where it goes. Who is off
is outside its shifts. Who queues waits for room at a charger."""

CHARGE = (CHARGING, QUEUEING, "")
"""What a robot does at a charger; nothing if it does so no more, or is full."""

WHY_AT_CHARGER = {
    CHARGING: "it charges until it is full: else it could not do what comes next",
    QUEUEING: "others charge there, and there is no room for one more",
}
"""Why robots are at chargers, by what they do there."""

AT_WORK = (SERVING, LOADING, CARRYING, UNLOADING)


def phase_of(
    is_lost: bool, has_formed: bool, work: str | None, has_moved: bool, task: int, is_there: bool
) -> str:
    """Return the phase of a robot in a step.

    `work` is what its team does for a task, one of AT_WORK or None. `task` is what the team is
    about, or NOBODY; `is_there` says whether it stands where that is.
    """
    if is_lost:
        return LOST
    if has_formed:
        return FORMING
    if work is not None:
        return work
    if has_moved:
        return WALKING
    if task == NOBODY:
        return IDLE
    return WAITING if is_there else WALKING


def is_same_place(mission: Mission, one: Place, other: Place) -> bool:
    """Say whether two places are one: the same cell, or points within the arrival radius."""
    if isinstance(mission.world, Plane):
        return math.dist(one, other) <= mission.world.arrival_radius + 1e-9
    return one == other
