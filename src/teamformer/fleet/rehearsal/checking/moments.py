"""When robots of a trace may begin tasks: by windows, the mission's end, and their shifts."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import islice

from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact


class MomentChecker:
    """Judges the beginnings of one mission's tasks; `tasks` are all, as they really are."""

    def __init__(self, mission: FleetMission, tasks: Mapping[int, TaskFact]) -> None:
        self._mission, self._tasks = mission, tasks

    def opens(self, key: int) -> float:
        """Return when a task may begin by its window."""
        return self._mission.opens.get(key, 0.0)

    def latest_start(self, key: int) -> float:
        """Return when a task may begin at the latest, as long as it is to take."""
        return self._mission.until - self._lasts(key)

    def _lasts(self, key: int) -> float:
        """Return how long robots believe a task to take at least, without the way of its load."""
        own = self._mission.tasks
        known = own[key] if key < len(own) else self._tasks[key]
        return known.duration + known.unload

    def is_in_shift(self, robot: int, key: int, now: float, slack: float) -> bool:
        """Say whether a task fits into a shift of a robot from now on, by clocks that may differ.

        They may by `slack` seconds.
        """
        rota, step = self._mission.source.robots[robot].rota, self._mission.step
        begin, end = now + slack, now + self._lasts(key) - slack
        shifts = islice(rota.since(max(0.0, now - slack) / step), 2)
        return any(opens * step <= begin and end <= closes * step for opens, closes in shifts)
