"""Finding: tasks whose place is not known are looked for, place by place, until a team is near.

`world.tasks` holds where each is believed to be. What teams have looked at in vain is ruled out;
if the place believed in is, the nearest that is left is believed in, or, with a view to what may
come, the one from which looking on takes least. So there is an end to it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.world.phases.looking import soonest_left
from teamformer.world.phases.motion import field_towards
from teamformer.world.rules.constants import MICROMETRES, NOBODY, ROUNDING
from teamformer.world.state.arrays import ANYWHERE, FOUND, SCOUTING
from teamformer.world.state.task_places import put_task

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@allocating_kernel
def find_tasks(world: World) -> bool:
    """Let teams look around for the open tasks that are not found.

    Says whether one was found elsewhere than everybody believed.
    """
    step, any_news = world.count.steps + 1, False
    for task in range(world.rules.tasks):
        if not (world.tasks[task].is_open and world.tasks[task].hides_place):
            continue
        any_ruled_out = False
        for team in range(world.rules.robots):
            if world.teams[team].size > 0:
                any_ruled_out |= _rule_out(world, task, team)
        lies_in, believed_in = world.tasks[task].lies_in, world.tasks[task].believed_in
        if not world.spots[task, lies_in].is_possible:
            world.tasks[task].hides_place = False
            world.tasks[task].found_at = step
            world.count.news |= FOUND
            if lies_in != believed_in:
                any_news = True
                _believe_in(world, task, lies_in, step)
        elif any_ruled_out:
            _look_on(world, task, step)
    return any_news


@allocating_kernel
def _look_on(world: World, task: int, step: int) -> None:
    """Believe in the next place to look in, where the one believed in is ruled out or not best."""
    spot, believed_in = np.int64(NOBODY), world.tasks[task].believed_in
    if world.rules.foresight == SCOUTING:
        spot = soonest_left(world, task, _nearest_team(world, task))
    if spot == NOBODY and not world.spots[task, believed_in].is_possible:
        spot = _nearest_left(world, task, _nearest_team(world, task))
    if spot != NOBODY and spot != believed_in:
        _believe_in(world, task, spot, step)


@kernel
def _rule_out(world: World, task: int, team: int) -> bool:
    """Strike the places that a team is near to from those that a task may be in; say if any is."""
    radius = world.rules.finding_radius + ROUNDING
    farthest = radius + world.tasks[task].reach
    if _apart_squared(world, task, 0, team) > farthest * farthest + 1:  # rounding
        return False
    any_is = False
    for spot in range(world.spots.shape[1]):
        if world.spots[task, spot].is_possible:
            is_near = _apart_squared(world, task, spot, team) <= radius * radius
            world.spots[task, spot].is_possible = not is_near
            any_is |= is_near
    return any_is


@kernel
def _apart_squared(world: World, task: int, spot: int, team: int) -> float:
    away_x = world.teams[team].x - world.spots[task, spot].x
    away_y = world.teams[team].y - world.spots[task, spot].y
    return away_x * away_x + away_y * away_y


@kernel
def _nearest_team(world: World, task: int) -> np.int64:
    """Return the team that is nearest to where a task is believed to be, the lowest slot first."""
    seeker, least = np.int64(NOBODY), np.int64(0)
    for team in range(world.rules.robots):
        if world.teams[team].size > 0:
            away = _micrometres(_apart_squared(world, task, world.tasks[task].believed_in, team))
            if seeker == NOBODY or away < least:
                seeker, least = np.int64(team), away
    return seeker


@allocating_kernel
def _nearest_left(world: World, task: int, seeker: int) -> np.int64:
    """Return the place left that a team is nearest to.

    Of equally near places the one that is nearest to where the task was first believed to be.
    """
    x, y = world.teams[seeker].x, world.teams[seeker].y
    has_walls = world.rules.has_walls and world.teams[seeker].region != ANYWHERE
    field = field_towards(world, x, y) if has_walls else np.empty((0, 0), np.int32)
    nearest, shortest = np.int64(NOBODY), np.int64(0)
    for spot in range(world.spots.shape[1]):
        if world.spots[task, spot].is_possible:
            way = _way(world, field, has_walls, x, y, task, spot)
            if nearest == NOBODY or way < shortest:
                nearest, shortest = np.int64(spot), way
    return nearest


@kernel
def _way(
    world: World, field: Array, has_walls: bool, x: float, y: float, task: int, spot: int
) -> np.int64:
    """Return the way from where a field begins to a place of a task, as `travel` does."""
    to_x, to_y = world.spots[task, spot].x, world.spots[task, spot].y
    if has_walls:
        return np.int64(field[int(to_y), int(to_x)])
    away_x, away_y = abs(to_x - x), abs(to_y - y)
    if world.rules.is_plane:
        return _micrometres(away_x * away_x + away_y * away_y)
    return np.int64(away_x + away_y)


@kernel
def _micrometres(squared: float) -> np.int64:
    """Return a length as a whole number of millionths, so that equal ones are equal."""
    return np.int64(np.rint(np.sqrt(squared) * MICROMETRES))


@allocating_kernel
def _believe_in(world: World, task: int, spot: int, step: int) -> None:
    """Believe a task to be in one of its places."""
    put_task(world, task, world.spots[task, spot].x, world.spots[task, spot].y)
    world.tasks[task].believed_in, world.tasks[task].moved_at = spot, step
