"""What the physical world keeps of each robot and of each piece of work: data, to be copied."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass

from teamformer.mission.parts.grid import Place
from teamformer.world.continuous.events import Passed
from teamformer.world.continuous.ways import part_of_way
from teamformer.world.rules.constants import NOBODY

FORMING, SERVING, CARRYING, UNLOADING, QUEUEING = range(5)
"""The parts of work. The service of a load is taking it up, and the others follow.

A team that has brought a load to a zone queues until there is room to unload it.
"""


SAME = 1e-9
"""Moments nearer than this share of the time that has passed are the same: sums are rounded."""


@dataclass(slots=True)
class RealRobot:
    """A robot as it really is.

    `way` has the place that it passed last and those to come; a robot that stands has one.
    """

    way: tuple[Passed, ...]
    came_from: Place  # where it last did something: who comes from one place needs not form
    task: int = NOBODY  # that it goes to, or waits at
    work: int = NOBODY  # the task that it is at work on or forms for
    is_lost: bool = False
    rest: float = 0.0  # of a lost robot: how long it is from the next place
    walked: float = 0.0  # and how long it has walked since the place before
    since: int = NOBODY  # the latest event of it
    set_out: int = NOBODY  # the event with which it set out
    left: float = math.inf  # in its battery at `left_at`
    left_at: float = 0.0
    charger: int = NOBODY  # that it goes to, or queues or charges at
    charges_for: int = NOBODY  # the task for which it charges
    at_charger: float = math.inf  # since when it queues
    queue: int = NOBODY  # the event with which it began to wait for room
    charge: int = NOBODY  # the event with which it began to charge

    @property
    def is_charging(self) -> bool:
        """Say whether it charges."""
        return self.charge != NOBODY

    @property
    def is_walking(self) -> bool:
        """Say whether it is on its way; when it arrives it is not."""
        return len(self.way) > 1


@dataclass(slots=True)
class TeamWork:
    """A team is at work on a task, or forms for it; the part at hand ends at `end`."""

    robots: tuple[int, ...]
    part: int
    begun: float
    end: float
    all_done: float  # when the task is done if nothing happens
    expected: float  # when it is believed to be done
    event: int  # with which the part began
    way: tuple[Passed, ...] = ()  # of its load

    @property
    def is_service(self) -> bool:
        """Say whether the task has begun; until then its team only forms."""
        return self.part != FORMING


def turning(way: tuple[Passed, ...], now: float, is_plane: bool) -> tuple[Passed, ...]:
    """Return what a new way begins with: where one is, or the places before and after.

    In a plane one can turn anywhere, elsewhere at the next place of the way.
    """
    if len(way) == 1:
        return (Passed(now, way[0].place),)
    following = bisect_left(way, now, key=lambda passed: passed.at)
    if following >= len(way):
        return (Passed(now, way[-1].place),)
    after = way[following]
    if following == 0 or after.at == now:
        return (Passed(now, after.place),)
    before = way[following - 1]
    if now - before.at <= SAME * max(1.0, now):
        return (Passed(now, before.place),)
    if is_plane or before.place == after.place:  # it pauses there
        part = (now - before.at) / (after.at - before.at)
        return (Passed(now, part_of_way(before.place, after.place, part)),)
    return before, after
