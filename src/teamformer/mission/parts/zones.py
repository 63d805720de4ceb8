"""Zones: tasks of which only so many can be served at once."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from teamformer.mission.parts.grid import Place

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task


LEAVES = ("done", "broken", "cancel", "missed", "lift")
"""Events after which a task takes no room any more where it took some."""


@dataclass(frozen=True)
class Zone:
    """A zone with room for so many services at once.

    Its tasks are those within an `area`, of which it has two corners, at some `places`, or named.
    Loads are unloaded in it that are brought there; `loads` names others.
    """

    name: str
    area: tuple[Place, ...] = ()
    tasks: tuple[str, ...] = ()
    places: tuple[Place, ...] = ()
    room: int = 1
    loads: tuple[str, ...] = ()

    def tasks_in(self, tasks: Sequence[Task]) -> list[int]:
        """Return the numbers of those of some tasks that are in the zone, by where they begin."""
        return [number for number, task in enumerate(tasks) if self.has(task, task.at)]

    def loads_in(self, tasks: Sequence[Task]) -> list[int]:
        """Return the numbers of those of some tasks whose loads are unloaded in the zone."""
        return [number for number, task in enumerate(tasks) if self._has_goal(task)]

    def has(self, task: Task, at: Place) -> bool:
        """Say whether a task is in the zone if it is at a place."""
        return task.name in self.tasks or self.has_place(at)

    def _has_goal(self, task: Task) -> bool:
        return task.to is not None and (task.name in self.loads or self.has_place(task.to))

    def has_place(self, place: Place) -> bool:
        """Say whether tasks at a place are in the zone whatever their names."""
        if self.area:
            (left, low), (right, high) = self.area
            return left <= place[0] <= right and low <= place[1] <= high
        return place in self.places


class AtWork(NamedTuple):
    """What goes on at a moment, by number: tasks that are served or whose loads are taken up.

    Then loads that are unloaded, and those whose teams stand where they are brought to and wait for
    room, who came first before who came later.
    """

    served: Collection[int]
    unloaded: Collection[int] = ()
    queue: Sequence[int] = ()

    @property
    def under_way(self) -> set[int]:
        """Return all tasks that take room, or wait for it with a load."""
        return {*self.served, *self.unloaded, *self.queue}


class ZoneRoom(NamedTuple):
    """So many of some tasks, by number, take room at once; `zone` is the number of their zone.

    They take it while they are served, or their loads taken up; `loads` while they are unloaded.
    """

    zone: int
    tasks: frozenset[int]
    room: int
    loads: frozenset[int] = frozenset()

    def inside(self, work: AtWork) -> list[int]:
        """Return the tasks that take room in the zone."""
        return sorted(
            {*self.tasks.intersection(work.served), *self.loads.intersection(work.unloaded)}
        )

    def has_turn(self, waiting: Sequence[int], work: AtWork, task: int) -> bool:
        """Say whether a task may begin that is not under way: there is room, and nobody before it.

        `waiting` has the tasks that are to begin, in the order of the plan. Whoever waits with a
        load is before them all.
        """
        if len(self.inside(work)) >= self.room or self.loads.intersection(work.queue):
            return False
        return next((other for other in waiting if other in self.tasks), task) == task

    def lets_unload(self, work: AtWork, task: int) -> bool:
        """Say whether a load may be unloaded that waits: there is room, and it came first."""
        first = next(other for other in work.queue if other in self.loads)
        return len(self.inside(work)) < self.room and first == task


def all_rooms_of(mission: Mission, lies: Mapping[int, Place] | None = None) -> list[ZoneRoom]:
    """Return the room of each of a mission's zones; `lies` says where loads were set down."""
    placed = [(task, (lies or {}).get(k, task.at)) for k, task in enumerate(mission.tasks)]
    return [
        ZoneRoom(
            number,
            frozenset(k for k, (task, at) in enumerate(placed) if zone.has(task, at)),
            zone.room,
            frozenset(zone.loads_in(mission.tasks)),
        )
        for number, zone in enumerate(mission.zones)
    ]


def rooms_of(mission: Mission, lies: Mapping[int, Place] | None = None) -> list[ZoneRoom]:
    """Return the rooms of a mission's zones that are too small for all that may be in them at once.

    Those are the tasks in them, and loads, which may be set down anywhere.
    """
    loads = {k for k, task in enumerate(mission.tasks) if task.to is not None}
    return [room for room in all_rooms_of(mission, lies) if room.room < len(room.tasks | loads)]


def loads_at_zones(rooms: Sequence[ZoneRoom]) -> frozenset[int]:
    """Return the loads that are unloaded in zones: their teams may have to wait for it."""
    return frozenset[int]().union(*(room.loads for room in rooms))


def has_loads_at_zones(mission: Mission) -> bool:
    """Say whether loads are taken up or unloaded in zones that may be full."""
    tasks = mission.tasks
    rooms = rooms_of(mission)
    return any(room.loads or any(tasks[k].to is not None for k in room.tasks) for room in rooms)


def zones_by_name(mission: Mission, lies: Mapping[int, Place] | None = None) -> tuple[Zone, ...]:
    """Return a mission's zones with their tasks by name: so they hold them wherever these are."""
    names = [task.name for task in mission.tasks]
    return tuple(
        Zone(
            zone.name,
            tasks=tuple(names[k] for k in sorted(room.tasks)),
            room=zone.room,
            loads=tuple(names[k] for k in sorted(room.loads)),
        )
        for zone, room in zip(mission.zones, all_rooms_of(mission, lies), strict=True)
        if room.tasks or room.loads
    )


def may_enter(rooms: Sequence[ZoneRoom], waiting: Sequence[int], work: AtWork, task: int) -> bool:
    """Say whether a task has its turn in all zones that it is in."""
    return all(room.has_turn(waiting, work, task) for room in rooms if task in room.tasks)


def may_unload(rooms: Sequence[ZoneRoom], work: AtWork, task: int) -> bool:
    """Say whether a load that waits for it may be unloaded, by all zones that it is brought to."""
    return all(room.lets_unload(work, task) for room in rooms if task in room.loads)


def lets_in(
    rooms: Sequence[ZoneRoom],
    moment: Sequence[tuple[int, str, int]],
    work: AtWork,
    task: int,
    is_load: bool = False,
) -> Iterator[int]:
    """Yield the events of a moment, by number, that let a task into its zones, or unload there.

    Those are the starts of tasks before it, and ends if a zone was full. `moment` has the number,
    the kind and the task of each; `work` what goes on once all that has happened.
    """
    for room in rooms:
        own = room.loads if is_load else room.tasks
        if task not in own:
            continue
        others = [(number, kind, other) for number, kind, other in moment if other != task]
        ends = [number for number, kind, other in others if _leaves(room, kind, other)]
        for number, kind, other in others:
            if (kind == "serve" and other in room.tasks and not is_load) or (
                kind == "unload" and other in room.loads
            ):
                yield number
        if len(set(room.inside(work)) - {task}) + len(ends) >= room.room:
            yield from ends


def _leaves(room: ZoneRoom, kind: str, task: int) -> bool:
    """Say whether an event of a task may be the end of what took room in a zone."""
    return kind in LEAVES and task in (room.tasks if kind == "lift" else room.tasks | room.loads)


def that_share_zones(rooms: Sequence[ZoneRoom]) -> Iterator[tuple[int, frozenset[int]]]:
    """Yield each task with all that are in a zone with it, itself included; once for each zone."""
    for room in rooms:
        inside = room.tasks | room.loads
        yield from ((task, inside) for task in sorted(inside))
