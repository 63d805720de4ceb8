"""Looking ahead while looking for a task: the next place is the one that leads to it soonest.

Any place left is as likely as any other. For each of the nearest ones a robot is imagined that
walks there, and then always to the nearest place that it has not seen yet: what it takes until it
stands at the task, added up over all places, says which is best.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.world.rules.constants import NOBODY, ROUNDING

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World

CHOICES = 8
"""How many of the nearest places are compared."""

MOST_PLACES = 100
"""In a wider region robots look in the nearest place next."""


class Looking(NamedTuple):
    """Where a task may be, in whole cells or units from the first place in its list."""

    at_x: Array  # (places,)
    at_y: Array  # (places,)
    spot: Array  # (places,) its number in the list
    is_left: Array  # (places,) not seen on the imagined way
    radius: float  # how far one sees


@allocating_kernel
def soonest_left(world: World, task: int, seeker: int) -> np.int64:
    """Return the place left from which a team's looking on takes least on average.

    Of equally good ones the nearest, of equally near ones the first in the list. NOBODY if there
    are too many to compare.
    """
    left = 0
    for spot in range(world.spots.shape[1]):
        left += world.spots[task, spot].is_possible
    if left > MOST_PLACES:
        return np.int64(NOBODY)
    search = _empty_search(left, (world.rules.finding_radius + ROUNDING) / world.rules.unit)
    filled = 0
    for spot in range(world.spots.shape[1]):
        if world.spots[task, spot].is_possible:
            search.spot[filled] = spot
            search.at_x[filled] = _units(world, world.spots[task, spot].x, world.spots[task, 0].x)
            search.at_y[filled] = _units(world, world.spots[task, spot].y, world.spots[task, 0].y)
            filled += 1
    x = _units(world, world.teams[seeker].x, world.spots[task, 0].x)
    y = _units(world, world.teams[seeker].y, world.spots[task, 0].y)
    best, least = 0, np.int64(-1)
    is_tried = np.zeros(left, np.bool_)
    for _ in range(min(left, CHOICES)):
        choice = _nearest(search, x, y, is_tried)
        is_tried[choice] = True
        cost = _cost_of_walk(search, x, y, choice)
        if least < 0 or cost < least:
            best, least = choice, cost
    return np.int64(search.spot[best])


@allocating_kernel
def _empty_search(left: int, radius: float) -> Looking:
    return Looking(
        np.zeros(left, np.int64), np.zeros(left, np.int64), np.zeros(left, np.int64),
        np.zeros(left, np.bool_), radius,
    )  # fmt: skip


@kernel
def _units(world: World, along: float, origin: float) -> np.int64:
    return np.int64(np.rint((along - origin) / world.rules.unit))


@kernel
def _nearest(search: Looking, x: int, y: int, is_out: Array) -> int:
    """Return the nearest place that is not out, of equally near ones the first."""
    found, shortest = -1, 0
    for place in range(len(search.at_x)):
        if not is_out[place]:
            away = abs(search.at_x[place] - x) + abs(search.at_y[place] - y)
            if found < 0 or away < shortest:
                found, shortest = place, away
    return found


@kernel
def _cost_of_walk(search: Looking, x: int, y: int, first: int) -> np.int64:
    """Return the steps until a robot that looks somewhere first is at the task, for all places."""
    cost, steps, left, target = np.int64(0), np.int64(0), len(search.at_x), first
    is_seen = search.is_left
    is_seen[:] = False
    while left > 0:
        if abs(search.at_x[target] - x) >= abs(search.at_y[target] - y):
            x += 1 if search.at_x[target] > x else -1
        else:
            y += 1 if search.at_y[target] > y else -1
        steps += 1
        for place in range(len(is_seen)):
            if not is_seen[place]:
                away_x, away_y = abs(search.at_x[place] - x), abs(search.at_y[place] - y)
                if away_x * away_x + away_y * away_y <= search.radius * search.radius:
                    is_seen[place] = True
                    left -= 1
                    cost += steps + away_x + away_y
        if left > 0 and is_seen[target]:
            target = _nearest(search, x, y, is_seen)
    return cost
