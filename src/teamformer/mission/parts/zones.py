"""Zones: tasks of which only so many can be served at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from teamformer.mission.parts.grid import Place

if TYPE_CHECKING:
    from teamformer.mission.model import Task


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
        if self.area:
            (left, low), (right, high) = self.area
            return left <= task.at[0] <= right and low <= task.at[1] <= high
        return task.name in self.tasks or task.at in self.places
