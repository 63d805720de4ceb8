"""What is wrong with zones, and which missions with zones are not run."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.keys.zone_keys import MOST_ROOM
from teamformer.mission.parts.roads import Roads

if TYPE_CHECKING:
    from teamformer.mission.model import Mission
    from teamformer.mission.parts.zones import Zone

SAYS_WHERE = ("area", "tasks", "places")


def find_zone_problems(mission: Mission) -> Iterator[Problem]:
    """Return which zones say nothing, too much or nonsense, have no room, or hold no task."""
    for zone in mission.zones:
        where, what = ("zones", zone.name), f"zone '{zone.name}'"
        if not (zone.room == int(zone.room) and 1 <= zone.room <= MOST_ROOM):
            message = f"{what} has room for {zone.room} services; use 1 to {MOST_ROOM}"
            yield Problem((*where, "room"), message)
        faults = [*_faults_of_where(mission, zone, what)]
        yield from faults
        if not faults and not zone.tasks_in(mission.tasks):
            key = next(key for key in SAYS_WHERE if getattr(zone, key))
            yield Problem((*where, key), f"no task is in {what}; move it, or drop it")


def _faults_of_where(mission: Mission, zone: Zone, what: str) -> Iterator[Problem]:
    where, said = ("zones", zone.name), [key for key in SAYS_WHERE if getattr(zone, key)]
    if not said:
        yield Problem(where, f"{what} holds nothing; write area, tasks or places")
    elif len(said) > 1:
        yield Problem((*where, said[1]), f"{what} has {' and '.join(said)}; keep one of them")
    if zone.area:
        yield from _faults_of_area(mission, zone, what)
    names = {task.name for task in mission.tasks}
    for number, name in enumerate(zone.tasks):
        if name not in names:
            message = f"{what} holds '{name}', which is no task; name one"
            yield Problem((*where, "tasks", number), message)


def _faults_of_area(mission: Mission, zone: Zone, what: str) -> Iterator[Problem]:
    where, corners = ("zones", zone.name, "area"), list(map(list, zone.area))
    if isinstance(mission.world, Roads):
        yield Problem(where, f"{what} has an area, and on roads there is none; name places")
    elif len(corners) != 2:
        message = f"the area of {what} has {len(corners)} corners; write two, [[x, y], [x, y]]"
        yield Problem(where, message)
    elif any(one > other for one, other in zip(*corners, strict=True)):
        message = f"the area of {what} goes from {corners[0]} to {corners[1]}"
        yield Problem(where, f"{message}; write the smaller coordinates first")


def zones_not_served(mission: Mission) -> Iterator[Problem]:
    """Return that nobody keeps to zones yet."""
    if mission.zones:
        message = "missions with zones are checked, but not run yet; drop zones"
        yield Problem(("zones",), message)
