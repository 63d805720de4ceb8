"""How long ways are in continuous time, and when robots pass the places on them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.shifts import ALWAYS
from teamformer.world.reference.ways import UNREACHABLE, PlainWays, apart

NEAR = 1e-9
"""Times and lengths nearer than this share are the same: sums are rounded."""

SHIFTS = ((13, 64), (-7, 64), (17, 64))
"""How a xorshift generator of 64 bits goes on."""


def is_near(one: float, other: float) -> bool:
    """Say whether two times or lengths are the same."""
    return abs(one - other) <= NEAR * max(1.0, abs(one), abs(other))


class Lengths:
    """Times that ways take at speed 1, and when robots that may stand still have made them."""

    def __init__(self, mission: Mission) -> None:
        self._world, self._robots = mission.world, mission.robots
        self._plain = PlainWays(mission.world) if isinstance(mission.world, Grid) else None
        self._stands: dict[int, list[bool]] = {}
        self._states: dict[int, int] = {}
        for number, robot in enumerate(mission.robots):
            if robot.delays is not None:
                self._stands[number] = []
                self._states[number] = (
                    (robot.delays.seed or 0) * 2654435769 + 88172645463325252
                ) % 2**64

    def between(self, here: Place, goal: Place, robot: int) -> float:
        """Return how long the way from one place to another is; infinite where there is none."""
        if here == goal:
            return 0.0
        moves = self._robots[robot].moves
        if isinstance(self._world, Roads):
            return float(self._world.ways[moves][int(here[0])][int(goal[0])])
        if self._plain is None:
            return apart(here, goal)
        length = self._plain.length(here, goal, self._robots[robot].flies)
        return math.inf if length >= UNREACHABLE else float(length)

    def when(self, robots: Sequence[int], begin: float, spent: float) -> float:
        """Return when robots that walk together have walked so long, from a time on.

        They walk only in units of time in which none of them stands still, one alone in its shifts.
        """
        rota = self._robots[robots[0]].rota if len(robots) == 1 else ALWAYS
        delayed = [robot for robot in robots if robot in self._stands]
        if not delayed:
            return rota.walked(begin, spent)
        now = begin
        while (now := rota.goes_on(now)) < math.inf:
            unit, border = math.floor(now), rota.next_border(now)
            until = min(unit + 1.0, math.inf if border is None else border[0])
            if not any(self._stands_still(robot, unit) for robot in delayed):
                if spent <= until - now:
                    return now + spent
                spent -= until - now
            now = until
        return math.inf

    def walked(self, robots: Sequence[int], begin: float, end: float) -> float:
        """Return how long robots that are together on their way walk between two times."""
        rota = self._robots[robots[0]].rota if len(robots) == 1 else ALWAYS
        delayed = [robot for robot in robots if robot in self._stands]
        if not delayed:
            return rota.worked(begin, end)
        done, now = 0.0, begin
        while now < end:
            until = min(math.floor(now) + 1.0, end)
            if not any(self._stands_still(robot, math.floor(now)) for robot in delayed):
                done += rota.worked(now, until)
            now = until
        return done

    def _stands_still(self, robot: int, unit: int) -> bool:
        drawn, delays = self._stands[robot], self._robots[robot].delays
        assert delays is not None, "only those are kept"
        while len(drawn) <= unit:
            state = self._states[robot]
            for by, bits in SHIFTS:
                state ^= state >> -by if by < 0 else (state << by) % 2**bits
            self._states[robot] = state
            drawn.append((state >> 11) / 2**53 < delays.chance)
        return drawn[unit]
