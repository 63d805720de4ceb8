"""Events of a mission in continuous time as the rows of a record's file: `[at, kind, {...}]`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from teamformer.mission.coordination import IDLE, NEWS, TAKEN_OVER
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.record.files.values import (
    DamageError,
    amount_of,
    check_keys,
    inside,
    list_of,
    metres,
    number_below,
    number_of,
    numbers_below,
    rows_of,
    short,
    text_of,
    time_of,
)
from teamformer.record.record import STATUSES
from teamformer.world.continuous.events import KINDS, Event, Passed, PlanMade, PlannedTask

CAUSE = "cause"
REASONS = (*NEWS, TAKEN_OVER)
REASONS_IN_TIME = (*REASONS, IDLE)
"""Why plans are made in steps, and in continuous time."""


def event_to_tree(event: Event) -> list[Any]:
    """Return an event as a row of the file; what has nothing to say is left out."""
    plain = Event(event.at, event.kind)._asdict()
    said = {key: value for key, value in event._asdict().items() if value != plain[key]}
    return [_short(event.at), event.kind, {key: _tree(value) for key, value in said.items()}]


def _tree(value: Any) -> Any:
    """Return a value as lists and plain numbers."""
    if isinstance(value, Mapping):
        return {key: _short(count) for key, count in value.items()}
    if isinstance(value, tuple):
        return [_tree(part) for part in value]
    return _short(value)


def _short(value: Any) -> Any:
    """Return a number that is whole without its point."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def events_from_tree(rows: Any, mission: Mission) -> tuple[Event, ...]:
    """Return the events of a file; raises `DamageError` for whatever is not one."""
    reader = _Reader(mission, len(list_of(rows)))
    events = []
    latest = 0.0
    for number, row in enumerate(rows):
        with inside(f"event {number}"):
            [fields] = rows_of([row], 3)
            event = reader.event(fields)
            if event.at < latest:
                raise DamageError(f"it happens at {event.at:g}, and the one before at {latest:g}")
            latest = event.at
            events.append(event)
    if any(event.kind == "over" for event in events[:-1]):
        raise DamageError("something happens after the mission is over")
    return tuple(events)


class _Reader:
    """Reads the fields of events of one mission, of which there are so many."""

    def __init__(self, mission: Mission, events: int) -> None:
        self._robots, self._tasks = len(mission.robots), len(mission.tasks)
        self._mission, self._events = mission, events
        self._along = metres if isinstance(mission.world, Plane) else number_of

    def event(self, row: Sequence[Any]) -> Event:
        at, name, tree = row
        kind = KINDS.get(name) if isinstance(name, str) else None
        if kind is None:
            raise DamageError(f"{short(name)} is no kind of event; known are {', '.join(KINDS)}")
        with inside(name):
            needed = [key for key in kind.fields if key not in kind.may_lack]
            check_keys(tree, (*kind.fields, CAUSE), needed)
            said = {key: self._read(key, value) for key, value in tree.items()}
            if "robots" in said and not said["robots"]:
                raise DamageError("there are no robots; leave the key out or name them")
        return Event(time_of(at), name, **said)

    def _read(self, key: str, value: Any) -> Any:
        with inside(key):
            match key:
                case "robots":
                    return numbers_below(value, self._robots)
                case "task":
                    return number_below(value, self._tasks)
                case "place":
                    return self._place(value)
                case "until":
                    return time_of(value)
                case "way":
                    return self._way(value)
                case "plan":
                    return self._plan(value)
                case "needs":
                    return self._needs(value)
                case "why":
                    return text_of(value)
                case "status":
                    return _status(value)
            return number_below(value, self._events)  # the cause

    def _place(self, value: Any) -> Place:
        """Return a place in the world; between two cells or places of roads there is none."""
        [[x, y]] = rows_of([value], 2)
        place = self._along(x), self._along(y)
        if not self._mission.world.is_inside(place):
            raise DamageError(f"{short(value)} is outside the world")
        return place

    def _way(self, value: Any) -> tuple[Passed, ...]:
        way = tuple(Passed(time_of(at), self._place(place)) for at, place in rows_of(value, 2))
        if not way:
            raise DamageError("it has no places")
        for one, other in pairwise(way):
            if other.at < one.at:
                raise DamageError(f"a place is passed at {other.at:g}, after one at {one.at:g}")
        return way

    def _plan(self, value: Any) -> PlanMade:
        [[reasons, rows]] = rows_of([value], 2)
        for reason in list_of(reasons):
            if reason not in REASONS_IN_TIME:
                raise DamageError(f"the reason is {short(reason)}, not one of {REASONS_IN_TIME}")
        tasks = tuple(
            PlannedTask(
                number_below(task, self._tasks),
                numbers_below(robots, self._robots),
                None if end is None else time_of(end),
            )
            for task, robots, end in rows_of(rows, 3)
        )
        return PlanMade(tuple(reasons), tasks)

    def _needs(self, value: Any) -> Counts:
        check_keys(value, self._mission.capabilities)
        return {cap: amount_of(count) for cap, count in value.items()}


def _status(value: Any) -> str:
    if value not in STATUSES:
        raise DamageError(f"the status is {short(value)}, not one of {STATUSES}")
    return text_of(value)
