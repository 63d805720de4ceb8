"""Batteries: who goes to a charger before it goes on, who charges, and what everything takes.

A team acts as one: it goes where all its robots get to, and stays until all of them are full.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from teamformer.mission.parts.charging import Battery
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.reference.formation import Joins
from teamformer.world.reference.state import PlainTeam, PlainWorld
from teamformer.world.reference.ways import MICROMETRES, UNREACHABLE

SHORT = 1e-9
"""By such a share of a full battery what is left may be short of what is wanted."""

DRY = 1e-5
"""A robot has run dry that lacks such a share of a full battery: places are rounded."""


class TeamReach(NamedTuple):
    """How far all robots of a team get; `spare` is to a task, so that they can do it and charge."""

    reach: float
    spare: float
    full: float  # the same of full ones
    full_spare: float


def charge(world: PlainWorld, walks: Joins) -> None:
    """Before motion, choose who goes to a charger, and let those charge who stand at theirs.

    Who has to charge does not walk to a partner: it is taken out of `walks`.
    """
    if not world.with_battery:
        return
    for slot, team in world.in_slot_order():
        if not team.serving and not (team.has_formed and world.mission.forming_steps > 0):
            _choose(world, team)
            if team.charger is not None:
                walks.pop(slot, None)
    _queue(world)
    world.happened.charged = set(world.charging)
    world.happened.queued = world.queued.keys() - world.charging
    for robot in sorted(world.charging):
        battery = world.with_battery[robot]
        world.left[robot] += battery.lasts / battery.fills if battery.fills else battery.lasts
        if world.left[robot] >= (1.0 - SHORT) * battery.lasts:
            world.left[robot] = battery.lasts
            world.charging.remove(robot)
            del world.queued[robot]


def _choose(world: PlainWorld, team: PlainTeam) -> None:
    """Say where a team charges before it goes on; who is about to charge goes on with that.

    Who has asked before and stands at its task begins, or waits.
    """
    is_done = is_at_charger(world, team) and not _are_short(world, team)
    has_asked = team.charges_for == team.task
    if team.charger is not None and has_asked and not is_done:
        return
    team.charger, team.charges_for = None, team.task
    if team.task is None:
        return
    if not (has_asked and world.is_same(team.at, world.at[team.task])):
        team.charger = _charger_for(world, team, team.task)


def is_at_charger(world: PlainWorld, team: PlainTeam) -> bool:
    """Say whether a team stands where it is to charge."""
    return team.charger is not None and team.at == world.mission.chargers[team.charger].at


def _batteries(world: PlainWorld, team: PlainTeam) -> Iterator[tuple[int, Battery]]:
    return ((r, world.with_battery[r]) for r in team.robots if r in world.with_battery)


def _are_short(world: PlainWorld, team: PlainTeam) -> bool:
    """Say whether a robot of a team is not full."""
    return any(world.left[robot] < own.lasts for robot, own in _batteries(world, team))


def _range(world: PlainWorld, team: PlainTeam, task: int) -> TeamReach:
    least = [math.inf] * 4
    for robot, battery in _batteries(world, team):
        pace, wanted = world.pace_of(robot), world.wanted[robot][task]
        left, most = world.left[robot] + SHORT * battery.lasts, (1.0 + SHORT) * battery.lasts
        own = (left * pace, (left - wanted) * pace, most * pace, (most - wanted) * pace)
        least = [min(pair) for pair in zip(least, own, strict=True)]
    return TeamReach(*least)


def _charger_for(world: PlainWorld, team: PlainTeam, task: int) -> int | None:
    """Return the charger that a team goes to before a task; None if it has enough, or none helps.

    Of those that it gets to and from which it gets on, be it by others, the one with the least
    detour. If it gets to none, the nearest.
    """
    far, goal = _range(world, team, task), world.at[task]
    if _length(world, team.at, goal) <= far.spare:
        return None
    places = [charger.at for charger in world.mission.chargers]
    ways = [_length(world, team.at, place) for place in places]
    if min(ways) > far.reach:
        return ways.index(min(ways))
    onward = _onward(world, far, goal)
    is_full = not _are_short(world, team)
    in_reach = [c for c, way in enumerate(ways) if way <= far.reach and not (is_full and way == 0)]
    best = min(in_reach, key=lambda c: ways[c] + onward[c], default=None)
    return best if best is not None and math.isfinite(onward[best]) else None


def _onward(world: PlainWorld, far: TeamReach, goal: Place) -> list[float]:
    """Return how far it is from each charger to a goal for who is full there, by others maybe."""
    places = [charger.at for charger in world.mission.chargers]
    direct = (_length(world, place, goal) for place in places)
    onward = [way if way <= far.full_spare else math.inf for way in direct]
    for _ in places:
        for charger, place in enumerate(places):
            hops = [_length(world, place, other) for other in places]
            by_others = (hop + onward[c] for c, hop in enumerate(hops) if hop <= far.full)
            onward[charger] = min(onward[charger], *by_others)
    return onward


def _length(world: PlainWorld, here: Place, there: Place) -> float:
    """Return how far it is, in cells or metres."""
    length = world.ways.length(here, there, False)
    if isinstance(world.world, Plane):
        return length / MICROMETRES
    return math.inf if length == UNREACHABLE else float(length)


def _queue(world: PlainWorld) -> None:
    """Let those charge who came first, as many as there is room for; of two, the lower number."""
    for robot, battery in world.with_battery.items():
        slot = world.slot_of[robot]
        is_short = world.left[robot] < battery.lasts
        if slot is None or not is_short or not is_at_charger(world, world.teams[slot]):
            world.queued.pop(robot, None)
            world.charging.discard(robot)
        else:
            world.queued.setdefault(robot, world.steps)
    at: dict[int | None, list[tuple[bool, int, int]]] = {}
    for robot, since in world.queued.items():
        slot = world.slot_of[robot]
        assert slot is not None
        row = (robot not in world.charging, since, robot)
        at.setdefault(world.teams[slot].charger, []).append(row)
    for number, charger in enumerate(world.mission.chargers):
        first = sorted(at.get(number, []))[: charger.room]
        world.charging.update(robot for _, _, robot in first)


def spend_walking(world: PlainWorld, team: PlainTeam, length: float) -> None:
    """Let a team have walked so many cells or metres; each takes what it would take alone."""
    team.has_walked = length > 0
    for robot, _ in _batteries(world, team):
        world.left[robot] -= length / world.pace_of(robot)


def spend_standing(world: PlainWorld) -> None:
    """At the end of motion: what serving takes, unloading too, and waiting at a task."""
    for robot, battery in world.with_battery.items():
        slot = world.slot_of[robot]
        if slot is None or world.teams[slot].has_walked:
            continue
        team = world.teams[slot]
        is_there = team.task is not None and world.is_same(team.at, world.at[team.task])
        if team.serving:
            is_carrying = not world.carried.isdisjoint(team.serving)
            waits = not world.came.keys().isdisjoint(team.serving)
            standing = battery.waiting if waits else battery.serving
            world.left[robot] -= 0.0 if is_carrying and not is_there else standing
        elif is_there and team.charger is None and world.is_at_work([robot]):
            world.left[robot] -= battery.waiting


def is_dry(world: PlainWorld, robot: int) -> bool:
    """Say whether a robot has run dry."""
    battery = world.with_battery.get(robot)
    return battery is not None and world.left[robot] < -DRY * battery.lasts


def has_enough(world: PlainWorld, team: PlainTeam, task: int) -> bool:
    """Say whether all robots of a team can do a task where they are, and then get to a charger."""
    return all(
        world.left[robot] + SHORT * battery.lasts >= world.wanted[robot][task]
        for robot, battery in _batteries(world, team)
    )
