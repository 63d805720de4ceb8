"""When a robot has to charge before it goes on, and where: the plain rule.

Whoever plays a mission goes by it, and plans are timed by it. Energy is in units of time that a
robot walks alone; places are whatever ways are asked by.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field

from teamformer.mission.parts.charging import Battery
from teamformer.world.rules.constants import NOBODY


@dataclass(frozen=True)
class ChargeRules:
    """Batteries and chargers of a mission; `way(robot, here, there)` is how long a robot takes."""

    batteries: Sequence[Battery | None]  # by robot
    chargers: Sequence[Hashable]  # where they are
    rooms: Sequence[int]
    way: Callable[[int, Hashable, Hashable], float]
    _onward: dict[tuple[int, Hashable, float], list[float]] = field(default_factory=dict)
    _nearest: dict[tuple[int, Hashable], float] = field(default_factory=dict)

    def nearest(self, robot: int, place: Hashable) -> float:
        """Return how long a robot takes from a place to the charger that is nearest to it."""
        if (robot, place) not in self._nearest:
            ways = (self.way(robot, place, charger) for charger in self.chargers)
            self._nearest[robot, place] = min(ways, default=math.inf)
        return self._nearest[robot, place]

    def wanted(self, robot: int, spent: float, end: Hashable) -> float:
        """Return what a robot has to have left at a task that takes `spent` and ends at a place.

        It gets to a charger then.
        """
        return spent + self.nearest(robot, end)

    def stop(
        self, robot: int, here: Hashable, left: float, goal: Hashable, wanted: float = 0.0
    ) -> int:
        """Return the charger that a robot goes to first, by number; NOBODY if it goes straight on.

        It goes on if it gets to its goal and has left there what is `wanted`. Else it goes to the
        charger with the least detour, of those that it gets to and from which it gets on; by way of
        others if need be. One that gets to none goes to the nearest.
        """
        battery = self.batteries[robot]
        if battery is None or not self.chargers:
            return NOBODY
        if battery.suffices(left, self.way(robot, here, goal) + wanted):
            return NOBODY
        ways = [self.way(robot, here, charger) for charger in self.chargers]
        in_reach = [c for c, way in enumerate(ways) if battery.suffices(left, way)]
        if not in_reach:
            return ways.index(min(ways))
        onward = self.from_chargers(robot, goal, wanted)
        is_full = left >= battery.lasts
        detours = {c: ways[c] + onward[c] for c in in_reach if not (is_full and ways[c] == 0)}
        best = min(detours, key=detours.__getitem__, default=NOBODY)
        return best if best != NOBODY and math.isfinite(detours[best]) else NOBODY

    def from_chargers(self, robot: int, goal: Hashable, wanted: float) -> list[float]:
        """Return how long ways are from each charger to a goal for a robot that is full there."""
        key = (robot, goal, wanted)
        if key not in self._onward:
            battery = self.batteries[robot]
            assert battery is not None
            direct = [self.way(robot, charger, goal) for charger in self.chargers]
            onward = [
                way if battery.suffices(battery.lasts, way + wanted) else math.inf for way in direct
            ]
            for _ in self.chargers if math.inf in onward else ():
                onward = [self._by_another(robot, c, onward) for c in range(len(onward))]
            self._onward[key] = onward
        return self._onward[key]

    def _by_another(self, robot: int, charger: int, onward: Sequence[float]) -> float:
        """Return how long the way from a charger is if it may lead by another one."""
        battery, here = self.batteries[robot], self.chargers[charger]
        assert battery is not None
        ways = ((self.way(robot, here, other), c) for c, other in enumerate(self.chargers))
        hops = [way + onward[c] for way, c in ways if battery.suffices(battery.lasts, way)]
        return min([onward[charger], *hops])
