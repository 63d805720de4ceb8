"""Who gets where: walls part a map for robots on the ground; robots that fly get everywhere."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from teamformer.capabilities import total

if TYPE_CHECKING:
    from teamformer.grid import Place
    from teamformer.model import Robot, World


def can_reach(world: World, robot: Robot, place: Place) -> bool:
    """Say whether a way leads a robot from its start to a place, alone."""
    return robot.flies or world.region(robot.at) == world.region(place)


def totals_by_region(world: World, robots: Iterable[Robot]) -> Mapping[int, dict[str, float]]:
    """Add up what robots can do together in each connected part of a map.

    In each part these are the robots that start in it and all that fly; so a part in which nobody
    starts has the latter, whichever it is asked for.
    """
    around: dict[int, list[Robot]] = {}
    flying: list[Robot] = []
    for robot in robots:
        if robot.flies:
            flying.append(robot)
        else:
            around.setdefault(world.region(robot.at), []).append(robot)
    in_the_air = total(robot.can for robot in flying)
    by_region = {
        region: total(robot.can for robot in (*members, *flying))
        for region, members in around.items()
    }
    return defaultdict(in_the_air.copy, by_region)
