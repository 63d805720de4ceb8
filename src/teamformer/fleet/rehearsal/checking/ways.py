"""Whether robots of a trace go where they can, no faster than they can, and where they are then."""

from __future__ import annotations

import math
from collections.abc import Collection
from itertools import pairwise

from teamformer.fleet.bodies.walking import Walked
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.roads import Roads
from teamformer.world.continuous.events import Passed

SLOWER = 1e-6
"""By such a share a way may be shorter than it takes: sums are rounded."""


class WayChecker:
    """Judges the ways of one mission's robots."""

    def __init__(self, mission: FleetMission) -> None:
        self._mission, self._map = mission, mission.source.world

    def place(self, walk: Walked, now: float) -> Place:
        """Return where a robot is; on roads the next place, and how far away that is."""
        way, when = walk.journey.way, min(now, walk.journey.stopped)
        at = sum(passed.at <= when + SLOWER for passed in way) - 1
        if at < 0 or at == len(way) - 1:
            return way[max(0, at)].place
        (begun, (x, y)), (ends, (to_x, to_y)) = way[at : at + 2]
        if isinstance(self._map, Grid) or (x, y) == (to_x, to_y):  # it pauses there
            return x, y
        if isinstance(self._map, Roads):
            return to_x, (ends - when if when > begun else 0.0)
        part = (when - begun) / (ends - begun)
        return x + part * (to_x - x), y + part * (to_y - y)

    def blocked(self, event: Walked) -> list[Place]:
        """Return the places of a way that a robot cannot get to, or not so soon."""
        if isinstance(self._map, Grid):
            flies = self._mission.source.robots[event.robot].flies
            points = [] if flies else [passed.place for passed in event.journey.way]
            return [at for at in points if not self._map.is_free(at)]
        if not isinstance(self._map, Roads):
            return []
        pairs = pairwise(_ahead(event))
        return [b.place for a, b in pairs if not self._can_go(event.robot, a, b)]

    def can_carry(self, event: Walked, carriers: Collection[int]) -> bool:
        """Say whether a way with a load is no faster than all can go who carry it."""
        way = _ahead(event)
        if isinstance(self._map, Roads):  # by the ways of one of them
            return all(self._can_go(robot, way[0], way[-1]) for robot in carriers)
        pace = min(self._mission.paces[robot] for robot in carriers)
        slack = 2 * self._mission.radius
        return all(
            self._metres(one, after) <= pace * (after.at - one.at) * (1 + SLOWER) + slack
            for one, after in pairwise(way)
        )

    def _can_go(self, robot: int, one: Passed, after: Passed) -> bool:
        """Say whether a robot can get so fast from one place of roads to another."""
        assert isinstance(self._map, Roads), "the caller has looked"
        times = self._map.ways[self._mission.source.robots[robot].moves]
        way = times[int(one.place[0])][int(after.place[0])]
        return way <= (after.at - one.at) * self._mission.paces[robot] + SLOWER * max(1.0, way)

    def _metres(self, one: Passed, after: Passed) -> float:
        return 1.0 if isinstance(self._map, Grid) else math.dist(one.place, after.place)


def _ahead(event: Walked) -> tuple[Passed, ...]:
    """Return the places of a way but those that were passed before it was set out on."""
    way = event.journey.way
    passed = sum(one.at < event.at - SLOWER for one in way)
    return way[passed:] or way[-1:]
