"""Zones: tasks of which only so many can be served at once."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from teamformer.mission.parts.grid import Place

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task


ENDS = ("done", "broken", "cancel", "missed")
"""Events after which a task is not under way."""


@dataclass(frozen=True)
class Zone:
    """A zone with room for so many services at once.

    Its tasks are those within an `area`, of which it has two corners, at some `places`, or named.
    """

    name: str
    area: tuple[Place, ...] = ()
    tasks: tuple[str, ...] = ()
    places: tuple[Place, ...] = ()
    room: int = 1

    def tasks_in(self, tasks: Sequence[Task]) -> list[int]:
        """Return the numbers of those of some tasks that are in the zone, by where they begin."""
        return [number for number, task in enumerate(tasks) if self._has(task)]

    def _has(self, task: Task) -> bool:
        return task.name in self.tasks or self.has_place(task.at)

    def has_place(self, place: Place) -> bool:
        """Say whether tasks at a place are in the zone whatever their names."""
        if self.area:
            (left, low), (right, high) = self.area
            return left <= place[0] <= right and low <= place[1] <= high
        return place in self.places


class ZoneRoom(NamedTuple):
    """Of some tasks, by number, so many are served at once; `zone` is the number of their zone."""

    zone: int
    tasks: frozenset[int]
    room: int

    def has_turn(self, waiting: Sequence[int], under_way: Collection[int], task: int) -> bool:
        """Say whether a task may begin that is not under way: there is room, and nobody before it.

        `waiting` has the tasks that are to begin, in the order of the plan.
        """
        if len(self.tasks.intersection(under_way)) >= self.room:
            return False
        return next((other for other in waiting if other in self.tasks), task) == task


def all_rooms_of(mission: Mission) -> list[ZoneRoom]:
    """Return the room of each of a mission's zones."""
    return [
        ZoneRoom(number, frozenset(zone.tasks_in(mission.tasks)), zone.room)
        for number, zone in enumerate(mission.zones)
    ]


def rooms_of(mission: Mission) -> list[ZoneRoom]:
    """Return the rooms of a mission's zones that are too small for all tasks in them at once."""
    return [room for room in all_rooms_of(mission) if room.room < len(room.tasks)]


def zones_by_name(mission: Mission) -> tuple[Zone, ...]:
    """Return a mission's zones with their tasks by name: so they hold them wherever these are."""
    return tuple(
        Zone(zone.name, tasks=tuple(mission.tasks[k].name for k in inside), room=zone.room)
        for zone in mission.zones
        if (inside := zone.tasks_in(mission.tasks))
    )


def may_enter(
    rooms: Sequence[ZoneRoom], waiting: Sequence[int], under_way: Collection[int], task: int
) -> bool:
    """Say whether a task has its turn in all zones that it is in."""
    return all(room.has_turn(waiting, under_way, task) for room in rooms if task in room.tasks)


def lets_in(
    rooms: Sequence[ZoneRoom],
    moment: Sequence[tuple[int, str, int]],
    under_way: Collection[int],
    task: int,
) -> Iterator[int]:
    """Yield the events of a moment, by number, that let a task into its zones.

    Those are the starts of tasks before it, and ends if a zone was full. `moment` has the number,
    the kind and the task of each; `under_way` what goes on once all that has happened.
    """
    for room in rooms:
        if task not in room.tasks:
            continue
        others = [(number, kind) for number, kind, other in moment if other in room.tasks - {task}]
        ends = [number for number, kind in others if kind in ENDS]
        yield from (number for number, kind in others if kind == "serve")
        if len(room.tasks.intersection(under_way) - {task}) + len(ends) >= room.room:
            yield from ends


def that_share_zones(rooms: Sequence[ZoneRoom]) -> Iterator[tuple[int, frozenset[int]]]:
    """Yield each task with all that are in a zone with it, itself included; once for each zone."""
    return ((task, room.tasks) for room in rooms for task in sorted(room.tasks))
