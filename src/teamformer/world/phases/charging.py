"""Charging: which teams go to a charger before they go on, and who charges there.

A team acts as one: it goes where all its robots get to, and stays until all of them are full.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.energy import SHORT
from teamformer.world.phases.formation import JOIN, MAINTAIN
from teamformer.world.phases.motion import travel
from teamformer.world.rules.constants import MICROMETRES, NOBODY
from teamformer.world.state.spatial_index import stands_at

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def charge_teams(world: World) -> None:
    """Before motion: choose who goes to a charger, and let those charge who stand at theirs."""
    for team in range(world.rules.robots):
        if world.teams[team].size == 0 or world.teams[team].serves > 0:
            continue
        if world.rules.forming_steps == 0 or not world.teams[team].has_formed:
            _choose(world, team)
            if world.teams[team].charger != NOBODY and world.teams[team].intent == JOIN:
                world.teams[team].intent = MAINTAIN
    for robot in range(world.rules.robots):
        _queue(world, robot)
    for charger in range(world.rules.chargers):
        _fill(world, charger)
    for robot in range(world.rules.robots):
        if world.robots[robot].charges:
            left = world.robots[robot].left + world.robots[robot].filled
            world.robots[robot].left = left
            if left >= (1.0 - SHORT) * world.robots[robot].lasts:
                world.robots[robot].left = world.robots[robot].lasts
                world.robots[robot].charges = False
                world.robots[robot].queued = NOBODY


@kernel
def is_at_charger(world: World, team: int) -> bool:
    """Say whether a team stands where it is to charge."""
    charger = world.teams[team].charger
    if charger == NOBODY:
        return False
    is_there = world.teams[team].x == world.chargers[charger].x
    return bool(is_there and world.teams[team].y == world.chargers[charger].y)


@kernel
def _choose(world: World, team: int) -> None:
    """Say where a team charges before it goes on; who is about to charge goes on with that.

    Who has asked before and stands at its task begins, or waits.
    """
    task = world.teams[team].task
    has_asked = world.teams[team].charges_for == task
    is_same = has_asked and world.teams[team].charger != NOBODY
    if is_same and not (is_at_charger(world, team) and _is_full(world, team)):
        return
    world.teams[team].charger, world.teams[team].charges_for = NOBODY, task
    if task != NOBODY and not (has_asked and stands_at(world, team, task)):
        world.teams[team].charger = _charger_for(world, team, task)


@kernel
def _is_full(world: World, team: int) -> bool:
    for robot in range(team, world.rules.robots):
        is_short = world.robots[robot].left < world.robots[robot].lasts
        if is_short and world.robots[robot].team == team:
            return False
    return True


@kernel
def _charger_for(world: World, team: int, task: int) -> int:
    """Return the charger that a team goes to before a task; NOBODY if it has enough, or none helps.

    Of those that it gets to and from which it gets on, be it by others, the one with the least
    detour. If it gets to none, the nearest.
    """
    reach = spare = full = full_spare = np.inf  # lengths that all its robots get to walk
    for robot in range(team, world.rules.robots):
        lasts, pace = world.robots[robot].lasts, world.robots[robot].pace
        if world.robots[robot].team == team and lasts > 0:
            left, wanted = world.robots[robot].left + SHORT * lasts, world.wanted[robot, task]
            most = lasts + SHORT * lasts
            reach, spare = min(reach, left * pace), min(spare, (left - wanted) * pace)
            full, full_spare = min(full, most * pace), min(full_spare, (most - wanted) * pace)
    x, y = world.teams[team].x, world.teams[team].y
    if _length_to_task(world, x, y, task) <= spare:
        return NOBODY
    _measure_onward(world, task, full, full_spare)
    best, nearest, least, shortest, is_full = NOBODY, 0, np.inf, np.inf, _is_full(world, team)
    for charger in range(world.rules.chargers):
        way = _length_to_charger(world, x, y, charger)
        if way < shortest:
            nearest, shortest = charger, way
        detour = way + world.chargers[charger].onward
        if way <= reach and detour < least and not (is_full and way == 0):
            best, least = charger, detour
    return nearest if shortest > reach else best


@kernel
def _measure_onward(world: World, task: int, full: float, full_spare: float) -> None:
    """Measure ways from chargers to a task for a team that is full there, by others if need be."""
    count = world.rules.chargers
    for charger in range(count):
        x, y = world.chargers[charger].x, world.chargers[charger].y
        direct = _length_to_task(world, x, y, task)
        world.chargers[charger].onward = direct if direct <= full_spare else np.inf
    for _ in range(count):
        for charger in range(count):
            x, y = world.chargers[charger].x, world.chargers[charger].y
            for other in range(count):
                hop = _length_to_charger(world, x, y, other)
                onward = hop + world.chargers[other].onward
                if hop <= full and onward < world.chargers[charger].onward:
                    world.chargers[charger].onward = onward


@kernel
def _length_to_task(world: World, x: float, y: float, task: int) -> float:
    length = travel(world, x, y, task, False)
    return length / MICROMETRES if world.rules.is_plane else np.float64(length)


@kernel
def _length_to_charger(world: World, x: float, y: float, charger: int) -> float:
    away_x = abs(world.chargers[charger].x - x)
    away_y = abs(world.chargers[charger].y - y)
    if world.rules.is_plane:
        return np.rint(np.sqrt(away_x * away_x + away_y * away_y) * MICROMETRES) / MICROMETRES
    if world.rules.has_walls:
        return np.float64(world.to_charger[charger, int(y), int(x)])
    return away_x + away_y


@kernel
def _queue(world: World, robot: int) -> None:
    """Write down since when a robot is where its team charges; one that is full does not queue."""
    team = world.robots[robot].team
    is_short = world.robots[robot].left < world.robots[robot].lasts
    if team == NOBODY or not is_short or not is_at_charger(world, team):
        world.robots[robot].queued, world.robots[robot].charges = NOBODY, False
    elif world.robots[robot].queued == NOBODY:
        world.robots[robot].queued = world.count.steps


@kernel
def _fill(world: World, charger: int) -> None:
    """Let those charge who came first, as many as there is room for; of two, the lower number."""
    for _ in range(world.chargers[charger].room - _count_charging(world, charger)):
        first = NOBODY
        for robot in range(world.rules.robots):
            queued = world.robots[robot].queued
            if queued == NOBODY or world.robots[robot].charges:
                continue
            is_sooner = first == NOBODY or queued < world.robots[first].queued
            if is_sooner and world.teams[world.robots[robot].team].charger == charger:
                first = robot
        if first == NOBODY:
            return
        world.robots[first].charges = True


@kernel
def _count_charging(world: World, charger: int) -> int:
    taken = 0
    for robot in range(world.rules.robots):
        if world.robots[robot].charges:
            taken += world.teams[world.robots[robot].team].charger == charger
    return taken
