"""Which zones of a mission the tasks of a fleet are in, those of operators too."""

from __future__ import annotations

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact


class FleetZones:
    """The zones of a mission, by number; `rooms` says how many services go on in each at once."""

    def __init__(self, mission: FleetMission) -> None:
        self._zones, own = mission.source.zones, mission.source.tasks
        self._inside = [frozenset(zone.tasks_in(own)) for zone in self._zones]
        self._own = len(own)
        self.rooms = tuple(zone.room for zone in self._zones)

    def of(self, task: TaskFact) -> list[int]:
        """Return the zones that a task is in: by where it began, as the mission has it."""
        if task.key < self._own:
            return [number for number, keys in enumerate(self._inside) if task.key in keys]
        place = task.x, task.y
        return [number for number, zone in enumerate(self._zones) if zone.has_place(place)]
