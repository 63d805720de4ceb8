"""Loads: who takes them up, carries them, and sets them down."""

from __future__ import annotations

import math

from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.reference.state import PlainTeam, PlainWorld
from teamformer.world.reference.ways import ROUNDING, apart


def take_up(world: PlainWorld, slot: int, team: PlainTeam, task: int) -> bool:
    """Let a team carry a load to where it goes; say whether it is unloaded there already."""
    wanted = world.mission.tasks[task]
    assert wanted.to is not None
    world.carried.add(task)
    world.happened.taken[task] = slot
    team.serving[task] = int(wanted.unload) + 1
    is_unloaded = carry(world, team, task)
    if team.serving.get(task):
        world.put_task(task, wanted.to)
    return is_unloaded


def steps_to_go(world: PlainWorld, team: PlainTeam, goal: Place, credit: float = 0.0) -> int:
    """Return how many steps a team takes to a place, by what it has saved of a cell."""
    if world.is_same(team.at, goal):
        return 0
    if isinstance(world.world, Plane):
        way = apart(team.at, goal) - world.here
    else:
        way = world.ways.length(team.at, goal, team.flies) - credit
    return math.ceil(way / team.pace - ROUNDING)


def carry(world: PlainWorld, team: PlainTeam, task: int) -> bool:
    """End a step with a load; say whether it has been long enough where it goes.

    A team that has lost what the task needs lets go of it.
    """
    to = world.mission.tasks[task].to
    assert to is not None
    if not world.covers(team.has, task):
        del team.serving[task]
        world.served.discard(task)
        world.let_go[task] = team.at
        world.happened.any_broken_off = True
    elif world.is_same(team.at, to):
        team.serving[task] -= 1
    return team.serving.get(task) == 0


def put_down(world: PlainWorld) -> None:
    """At the end of a step, let loads lie where they were let go of."""
    world.happened.left = dict(sorted(world.let_go.items()))
    for task, place in world.let_go.items():
        world.carried.remove(task)
        world.put_task(task, place)
    world.let_go = {}
