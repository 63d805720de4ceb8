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
    return carry(world, team, task)


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

    A team that has lost what the task needs lets go of it, and so does one whose shift is over. In
    a zone it waits there for room.
    """
    to = world.mission.tasks[task].to
    assert to is not None
    is_in_shift = world.is_in_shift(team.robots, world.begun_at[task], world.steps + 1)
    if not (is_in_shift and world.covers(team.has, task)):
        del team.serving[task]
        world.served.discard(task)
        world.let_go[task] = team.at
        world.stop_unloading(task)
        world.happened.any_broken_off = True
    elif world.is_same(team.at, to) and task in world.brought_to_zones - world.unloading:
        world.came.setdefault(task, world.steps + 1)
    elif world.is_same(team.at, to):
        team.serving[task] -= 1
    return team.serving.get(task) == 0


def put_down(world: PlainWorld) -> None:
    """At the end of a step, let loads lie where they were let go of, or head for where they go."""
    world.happened.left = dict(sorted(world.let_go.items()))
    for task, place in world.let_go.items():
        world.carried.remove(task)
        world.stop_unloading(task)
        world.put_task(task, place)
    for task in world.happened.taken.keys() & world.carried:
        to = world.mission.tasks[task].to
        assert to is not None
        world.put_task(task, to)
    if world.let_go and world.rooms:
        world.lies |= world.let_go
        world.list_rooms()
    world.let_go = {}
