"""Who gets where: walls part a map for robots on the ground; robots that fly get everywhere.

On roads a robot gets where the ways of its mover lead, which need not lead back.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from teamformer.mission.parts.capabilities import Counts, total
from teamformer.mission.parts.roads import Roads

if TYPE_CHECKING:
    from teamformer.mission.model import Robot, World
    from teamformer.mission.parts.grid import Place


def can_reach(world: World, robot: Robot, place: Place) -> bool:
    """Say whether a way leads a robot from its start to a place, alone."""
    if isinstance(world, Roads):
        return world.leads(robot.moves, robot.at, place)
    return robot.flies or world.region(robot.at) == world.region(place)


def way_for(world: World, them: str) -> str:
    """Return what to do about a way that robots, such as `them`, lack."""
    if isinstance(world, Roads):
        return "give such a way a time under roads"
    return f"open the map, or let {them} fly with moves: air"


def totals_there(world: World, robots: Sequence[Robot]) -> Callable[[Place], Counts]:
    """Return what adds up, for any place, what the robots that get there can do together."""
    if isinstance(world, Roads):
        return lambda place: total(r.can for r in robots if can_reach(world, r, place))
    by_region = totals_by_region(world, robots)
    return lambda place: by_region[world.region(place)]


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
