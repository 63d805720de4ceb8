"""Who charges and who queues in each step of a rehearsal, by what its trace holds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from teamformer.fleet.bodies.batteries import UNPLUGGED
from teamformer.fleet.rehearsal.checking.trace import Event, Said
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.record.phases import CHARGING, QUEUEING, is_same_place
from teamformer.world.continuous.events import Event as OfWorld
from teamformer.world.rules.constants import NOBODY

CHARGES = ("charge", "charged", "empty")
"""Kinds of events of batteries."""


class AtChargers:
    """Goes through a trace: `note` takes in its events, `of` says what a step shows."""

    def __init__(self, mission: Mission) -> None:
        self._mission = mission
        self._charging: set[int] = set()
        self._charged: set[int] = set()  # those that did as the step at hand began
        self._waiting: set[int] = set()  # that say that they are at their chargers
        self._queued: set[int] = set()

    def note(self, event: Event) -> None:
        """Note that a robot begins to charge, or does so no more, or what it says of that."""
        if isinstance(event, Said):
            waits = event.charger != NOBODY
            (self._waiting.add if waits else self._waiting.discard)(event.robot)
        elif isinstance(event, OfWorld) and event.kind == "charge":
            self._charging.update(event.robots)
        elif isinstance(event, OfWorld) and event.kind in (*CHARGES, UNPLUGGED):
            self._charging.difference_update(event.robots)

    def of(self, places: Mapping[int, Place]) -> dict[int, str]:
        """Return what robots do at chargers in a step, by where they are at its end.

        Those charge that did as it began and are still there. Who is at its charger and finds no
        room queues.
        """
        there = {robot: n for robot, at in places.items() if (n := self._at(at)) != NOBODY}
        self._charging &= there.keys()
        charged, queued = self._charged & there.keys(), self._queued & self._charging
        taken = [there[robot] for robot in charged | self._charging]
        for robot in (self._waiting & there.keys()) - self._charging - charged:
            if taken.count(there[robot]) >= self._room(there[robot]):
                queued.add(robot)
        self._charged, self._queued = set(self._charging), queued
        return dict.fromkeys(queued, QUEUEING) | dict.fromkeys(charged, CHARGING)

    def _room(self, charger: int) -> int:
        """Return how many charge where a charger is; there may be more of them."""
        place = self._mission.chargers[charger].at
        return sum(it.room for it in self._mission.chargers if it.at == place)

    def _at(self, place: Place) -> int:
        """Return the charger at a place; NOBODY for none."""
        chargers = enumerate(self._mission.chargers)
        near = (n for n, it in chargers if is_same_place(self._mission, place, it.at))
        return next(near, NOBODY)


def dry_in(events: Iterable[Event], step: float) -> dict[int, int]:
    """Return the robots that run dry, and in which step each does; `step` is in seconds."""
    moments = (it for it in events if isinstance(it, OfWorld) and it.kind == "empty")
    return {robot: max(1, math.ceil(it.at / step)) for it in moments for robot in it.robots}
