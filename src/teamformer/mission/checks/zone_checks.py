"""What is wrong with zones, and which missions with zones are not run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.checks.links import groups_of, longest_gaps
from teamformer.mission.keys.unknown import Found, told_once
from teamformer.mission.keys.zone_keys import MOST_ROOM
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.zones import rooms_of

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task
    from teamformer.mission.parts.zones import Zone

SAYS_WHERE = ("area", "tasks", "places")


def find_zone_problems(mission: Mission) -> Iterator[Problem]:
    """Return which zones say nothing, too much or nonsense, have too little room, or no task."""
    is_good = True
    for zone in mission.zones:
        where, what = ("zones", zone.name), f"zone '{zone.name}'"
        if not (zone.room == int(zone.room) and 1 <= zone.room <= MOST_ROOM):
            message = f"{what} has room for {zone.room} services; use 1 to {MOST_ROOM}"
            yield Problem((*where, "room"), message)
        faults = [*_faults_of_where(mission, zone, what)]
        yield from faults
        if not faults and not mission.arrivals and not _is_used(mission, zone):
            key = next(key for key in SAYS_WHERE if getattr(zone, key))
            yield Problem((*where, key), f"no task is in {what}; move it, or drop it")
        is_good &= not faults
    if is_good:
        yield from _find_narrow_zones(mission)


def _is_used(mission: Mission, zone: Zone) -> bool:
    """Say whether a task is in a zone, or a load is brought there."""
    return bool(zone.tasks_in(mission.tasks) or zone.loads_in(mission.tasks))


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
        has = "one corner" if len(corners) == 1 else f"{len(corners)} corners"
        message = f"the area of {what} has {has}; write two, [[x, y], [x, y]]"
        yield Problem(where, message)
    elif any(one > other for one, other in zip(*corners, strict=True)):
        message = f"the area of {what} goes from {corners[0]} to {corners[1]}"
        yield Problem(where, f"{message}; write the smaller coordinates first")


def _find_narrow_zones(mission: Mission) -> Iterator[Problem]:
    """Return which zones have less room than tasks that are under way at once by their links."""
    names = {task.name for task in mission.tasks}
    if not names.issuperset(name for task in mission.tasks for name in task.starts):
        return
    groups = [group for group in groups_of(mission.tasks) if len(group) > 1]
    for room in rooms_of(mission):
        zone = mission.zones[room.zone]
        for group in groups:
            linked = [mission.tasks[number] for number in group]
            inside = [mission.tasks[number] for number in group if number in room.tasks]
            at_once = _most_at_once(linked, inside)
            if len(at_once) > room.room:
                listed = ", ".join(f"'{task.name}'" for task in at_once)
                message = f"zone '{zone.name}' has room for {room.room}, and by their links"
                message = f"{message} {listed} go on at once; give it more room, or drop a link"
                yield Problem(("zones", zone.name, "room"), message)


def _most_at_once(linked: Sequence[Task], inside: Sequence[Task]) -> list[Task]:
    """Return tasks of a group, of those inside a zone, that go on at once whenever they start.

    The most that are found, beginning with each of them.
    """
    longest = longest_gaps(linked)

    def overlap(one: Task, other: Task) -> bool:
        """Say whether each starts before the other one can have ended."""
        latest, earliest = -longest[other.name, one.name], longest[one.name, other.name]
        return latest < _shortest(one) and -earliest < _shortest(other)

    most: list[Task] = []
    for first in inside:
        found = [first]
        for task in inside:
            if task is not first and all(overlap(one, task) for one in found):
                found.append(task)
        most = max(most, found, key=len)
    return most


def _shortest(task: Task) -> float:
    """Return how long a task takes at least."""
    return task.duration if task.lasts is None else task.lasts[0]


def zones_not_served(mission: Mission) -> Iterator[Problem]:
    """Return what a mission has that zones do not go with yet in steps and in fleets."""
    if not mission.zones:
        return
    name = mission.zones[0].name
    rest = f"which does not go with zone '{name}' yet; drop one of the two"
    yield from told_once(mission, _found_beside_zones(mission), lambda _: rest)


def _found_beside_zones(mission: Mission) -> Iterator[Found]:
    for number, task in enumerate(mission.tasks):
        if task.to is not None and any(_touches(zone, task) for zone in mission.zones):
            yield ("tasks", number, "to"), f"task '{task.name}' has a load"


def _touches(zone: Zone, task: Task) -> bool:
    """Say whether a load is taken up or set down in a zone."""
    return bool(zone.tasks_in([task])) or (task.to is not None and zone.has_place(task.to))
