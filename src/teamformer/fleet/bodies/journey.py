"""Where somebody is on a way: in a cell of a grid, anywhere in a plane, between places of roads."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

from teamformer.mission.model import World
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.roads import Roads
from teamformer.world.continuous.events import Passed
from teamformer.world.continuous.ways import part_of_way

SAME = 1e-9
"""Seconds by which sums of times may be off."""


@dataclass(frozen=True, slots=True)
class Journey:
    """A way, on which somebody may have `stopped` at a time between two places of roads.

    `way` has the place that was passed last and those to come; who stands at a place has one.
    """

    way: tuple[Passed, ...]
    stopped: float = math.inf

    @property
    def goal(self) -> Place:
        """Return where the way leads."""
        return self.way[-1].place

    @property
    def end(self) -> float:
        """Return when the last place is reached; infinite for who has stopped, or is there."""
        return self.way[-1].at if len(self.way) > 1 and self.stopped == math.inf else math.inf

    def passed(self, now: float) -> int:
        """Return which place of the way was passed last."""
        when = min(now, self.stopped) + SAME
        return max(0, bisect_right(self.way, when, key=lambda passed: passed.at) - 1)

    def place(self, now: float, world: World) -> Place:
        """Return where one is; on roads the next place, and how many seconds it is away."""
        at, when = self.passed(now), min(now, self.stopped)
        here = self.way[at]
        if isinstance(world, Grid) or at == len(self.way) - 1 or when <= here.at:
            return here.place
        after = self.way[at + 1]
        if here.place == after.place:  # it pauses there
            return here.place
        if isinstance(world, Roads):
            return after.place[0], after.at - when
        return part_of_way(here.place, after.place, (when - here.at) / (after.at - here.at))

    def stop(self, now: float, world: World) -> Journey:
        """Return that one stays where one is, be it between two places of roads."""
        at = self.passed(now)
        if isinstance(world, Roads) and self.place(now, world)[1] > 0:
            return Journey(self.way[at : at + 2], min(now, self.stopped))
        return Journey((Passed(now, self.place(now, world)),))

    def beginning(self, now: float, world: World) -> tuple[Passed, ...]:
        """Return what a new way begins with: where one is, or on roads the places around."""
        at, late = self.passed(now), max(0.0, now - self.stopped)
        if isinstance(world, Roads) and self.place(now, world)[1] > 0:
            return tuple(Passed(when + late, place) for when, place in self.way[at : at + 2])
        return (Passed(now, self.place(now, world)),)
