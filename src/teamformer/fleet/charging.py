"""Batteries as a fleet goes by them: by what is left of a full one, that bodies tell of robots."""

from __future__ import annotations

import math
from collections.abc import Hashable

from teamformer.fleet.messages import TaskFact
from teamformer.mission.model import Mission
from teamformer.mission.parts.charging import longest_carry, walks_at
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.world.continuous.ways import Ways
from teamformer.world.rules.charging.standing import charge_rules
from teamformer.world.rules.constants import NOBODY

RESERVE = 0.02
"""The share of a full battery that a robot means to keep: it turns, and waits for others."""


class FleetCharging:
    """Who has to charge before what, by the rule of the world; times are in the mission's units."""

    def __init__(self, source: Mission, ways: Ways) -> None:
        self._source, self._ways = source, ways
        self.batteries = [robot.battery for robot in source.robots]
        self.chargers = [charger.at for charger in source.chargers]
        self.rooms = [charger.room for charger in source.chargers]
        self._rules = charge_rules(source, self._way)

    def _way(self, robot: int, here: Hashable, there: Hashable) -> float:
        assert isinstance(here, tuple), "places are pairs"
        assert isinstance(there, tuple), "places are pairs"
        it = self._source.robots[robot]
        return self._ways.length(here, there, it.moves) / walks_at(self._source, it)

    def starts(self, robot: int) -> float:
        """Return how full the battery of a robot is as the mission begins, 0 to 1."""
        battery = self.batteries[robot]
        return 1.0 if battery is None else battery.starts

    def spent_on(self, robot: int, task: TaskFact, step: float) -> float:
        """Return what a task takes a robot, with its load where that lies; a step takes seconds."""
        battery, own = self.batteries[robot], self._source.tasks
        if battery is None:
            return 0.0
        carried = 0.0
        if task.key < len(own):
            carried = longest_carry(self._source, own[task.key], (task.x, task.y), self._way)
        return battery.serving * (task.duration + task.unload) / step + carried

    def wanted(self, robot: int, task: TaskFact, step: float) -> float:
        """Return what a robot has to have left at a task to do it and get to a charger."""
        end = task.to or (task.x, task.y)
        return self._rules.wanted(robot, self.spent_on(robot, task, step), end)

    def stop(self, robot: int, here: Place, charge: float, goal: Place, wanted: float) -> int:
        """Return the charger that a robot goes to before a goal; NOBODY if straight on.

        `here` is where it is or comes to next, and `charge` what it has there, 0 to 1.
        """
        battery = self.batteries[robot]
        if battery is None:
            return NOBODY
        reserve = 0.0 if charge == 1.0 else RESERVE * battery.lasts
        return self._rules.stop(robot, here, charge * battery.lasts, goal, wanted + reserve)

    def onward(self, robot: int, place: Place) -> float:
        """Return how long a robot takes from a place to the nearest charger."""
        return self._rules.nearest(robot, place)

    def is_able(self, robot: int, task: TaskFact, step: float) -> bool:
        """Say whether a robot can do a task from a charger, full, and then get to one."""
        battery, at = self.batteries[robot], (task.x, task.y)
        if battery is None:
            return True
        there = min((self._way(robot, c, at) for c in self.chargers), default=math.inf)
        return battery.suffices(battery.lasts, there + self.wanted(robot, task, step))


def next_place(world: object, at: Place, step: float) -> tuple[Place, float]:
    """Return where a robot is or comes to next, and how long that takes, in the mission's units."""
    return ((at[0], 0), at[1] / step) if isinstance(world, Roads) else (at, 0.0)
