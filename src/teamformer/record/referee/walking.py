"""How long robots must have been on their way at least who have been in some places."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.world.reference.ways import MICROMETRES, PlainWays

WORDS_TAKE = 3
"""Steps by which a snapshot may be behind: words take their time, and places are rounded."""


class LeastWalks:
    """The least steps that robots take to places, in whatever order, from where they start.

    No order is taken for granted, as what robots did may be told late: a tree that joins all
    places is no longer than any way through them.
    """

    def __init__(self, mission: Mission) -> None:
        assert not isinstance(mission.world, Roads), "fleets of processes take no roads"
        self._mission, self._ways = mission, PlainWays(mission.world)
        self._been: list[list[Place]] = [[] for _ in mission.robots]

    def note(self, robot: int, place: Place) -> Sequence[Place]:
        """Note that a robot has been in a place; return all in which it has been."""
        self._been[robot].append(place)
        return self._been[robot]

    def least(self, robot: int, places: Sequence[Place]) -> float:
        """Return after how many steps at least a robot can have been in all of some places."""
        one = self._mission.robots[robot]
        apart = {place: self._length(one.at, place, one.flies) for place in places}
        length = 0.0
        while apart:
            near = min(apart, key=apart.__getitem__)
            length += apart.pop(near)
            for place in apart:
                apart[place] = min(apart[place], self._length(near, place, one.flies))
        return length / self._mission.world.pace(one.speed) - WORDS_TAKE

    def fastest(self, one: Place, other: Place) -> float:
        """Return after how many steps the fastest robot can have brought a load to a place."""
        paces = (self._mission.world.pace(robot.speed) for robot in self._mission.robots)
        return self._length(one, other) / max(paces) - WORDS_TAKE

    def _length(self, one: Place, other: Place, flies: bool = False) -> float:
        """Return how long the way between two places is, in cells or metres."""
        length, world = self._ways.length(one, other, flies=flies), self._mission.world
        if isinstance(world, Plane):
            return max(0.0, length / MICROMETRES - 2 * world.arrival_radius)
        return length
