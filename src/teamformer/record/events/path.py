"""The critical path of a record in continuous time: a walk along the causes of its events."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from teamformer.mission.parts.zones import ZoneRoom, rooms_of
from teamformer.record.critical_path.stretches import (
    CLOSED,
    LINKED,
    NEWS,
    UNKNOWN,
    Stretch,
    in_order,
    in_shifts,
)
from teamformer.record.phases import (
    CARRYING,
    CHARGING,
    FORMING,
    IDLE,
    LOADING,
    OFF,
    QUEUEING,
    SERVING,
    UNLOADING,
    WAITING,
    WALKING,
)
from teamformer.record.record import Record
from teamformer.world.continuous.events import Event
from teamformer.world.rules.constants import NOBODY

LASTS = {
    "walk": WALKING,
    "form": FORMING,
    "serve": SERVING,
    "lift": CARRYING,
    "unload": UNLOADING,
    "charge": CHARGING,
    "queue": QUEUEING,
}
"""What goes on from an event until one that hung on it."""

SHIFTS = ("rests", "works")
"""What comes by a robot's shifts, whatever it does."""

BEFORE = {"appear": UNKNOWN, "opens": CLOSED, "works": OFF}
"""What there was before an event that came from outside; before any other, older news."""


def path_along_causes(record: Record) -> tuple[Stretch, ...]:
    """Return the stretches that the end of a completed mission is the sum of, the first one first.

    It is empty if the mission was not completed.
    """
    events = record.events
    if not record.end.makespan or not events or events[-1].kind != "over":
        return ()
    return tuple(in_shifts(record.mission, in_order(_stretches(record, events))))


def _stretches(record: Record, events: Sequence[Event]) -> Iterator[Stretch]:
    """Yield the stretches, the last one first."""
    now, follows, seen = events[-1], NOBODY, set[int]()
    rooms = rooms_of(record.mission)
    number = len(events) - 1
    waits: Event | None = None  # with which a robot began to wait for one that charges
    while (before := _before(events, number)) != NOBODY and before not in seen:
        seen.add(before)
        waits = _queued(events, number) or waits
        number, cause = before, events[before]
        doing = _between(record, cause, now)
        robot = _who(events, cause, now, follows)
        if doing == LINKED:
            yield Stretch(cause.at, now.at, LINKED, task=cause.task)
        elif waits is not None and doing == CHARGING and waits.at < now.at:
            begun = max(waits.at, cause.at)  # until then nobody waited for it
            yield Stretch(begun, now.at, QUEUEING, waits.robots[0])
            yield Stretch(cause.at, begun, CHARGING, robot)
            waits = waits if waits.at < cause.at else None
        else:
            about = cause.task if cause.kind in LASTS or doing == OFF else now.task
            zone = _zone_waited_for(rooms, events, cause)
            yield Stretch(cause.at, now.at, doing, robot, about, zone)
        follows = robot if cause.at != now.at else follows
        now = cause
    yield Stretch(0, now.at, BEFORE.get(now.kind, NEWS), task=now.task)


def _zone_waited_for(rooms: Sequence[ZoneRoom], events: Sequence[Event], event: Event) -> int:
    """Return the zone whose room let a service begin, or a load be unloaded; NOBODY if none's."""
    if event.kind not in ("serve", "unload") or event.cause == NOBODY:
        return NOBODY
    other = events[event.cause]
    is_own = other.task in (event.task, NOBODY) or bool(set(other.robots) & set(event.robots))
    is_load = event.kind == "unload"
    shared = (
        room.zone
        for room in rooms
        if other.task in room.tasks | room.loads
        and event.task in (room.loads if is_load else room.tasks)
    )
    return NOBODY if is_own else next(shared, NOBODY)


def _before(events: Sequence[Event], number: int) -> int:
    """Return on which event one hung; where a shift begins or ends, what its robot did last."""
    event = events[number]
    if event.kind not in SHIFTS:
        return event.cause
    mine = (k for k in range(number - 1, -1, -1) if event.robots[0] in events[k].robots)
    return next((k for k in mine if events[k].kind not in SHIFTS), NOBODY)


def _queued(events: Sequence[Event], number: int) -> Event | None:
    """Return with which event a robot began to wait that charges as soon as there is room."""
    event = events[number]
    if event.kind != "charge" or event.robots == events[event.cause].robots:
        return None
    mine = (events[k] for k in range(number - 1, -1, -1) if event.robots[0] in events[k].robots)
    return next((one for one in mine if one.kind == "queue"), None)


def _between(record: Record, cause: Event, event: Event) -> str:
    """Return what went on between an event and its cause."""
    if event.kind == "opens" and cause.task not in (NOBODY, event.task):
        return LINKED
    if event.kind == "works":
        return OFF
    if cause.kind == "serve" and record.mission.tasks[cause.task].to is not None:
        return LOADING
    return LASTS.get(cause.kind, IDLE if event.task == NOBODY else WAITING)


def _who(events: Sequence[Event], cause: Event, event: Event, follows: int) -> int:
    """Return the robot that a stretch is told of: the one that the path goes on with, if it can be.

    So a team forms, and serves, from when its last robot is there, and both are told of that one.
    """
    robots = cause.robots or event.robots
    before = events[cause.cause].robots if cause.cause != NOBODY else ()
    come = [robot for robot in before if robot in robots]
    chosen = come or robots
    return follows if follows in chosen else (*chosen, NOBODY)[0]
