"""One step, phase by phase."""

from __future__ import annotations

from collections.abc import Mapping

from teamformer.mission.model import Mission
from teamformer.world.reference.allocation import allocate_tasks
from teamformer.world.reference.carrying import put_down
from teamformer.world.reference.charging import charge, spend_standing
from teamformer.world.reference.completion import (
    complete_tasks,
    drop_assignments,
    miss_tasks,
    release_tasks,
)
from teamformer.world.reference.finding import find_tasks
from teamformer.world.reference.formation import join_teams, read_decisions, split_teams
from teamformer.world.reference.losses import call_off, lose_robots, return_robots
from teamformer.world.reference.motion import move_teams
from teamformer.world.reference.needs import expect_needs, show_needs
from teamformer.world.reference.state import Happenings, PlainWorld, Wish


def begin(
    mission: Mission,
    truth: Mission | None = None,
    is_coordinated: bool = False,
    foresight: str = "scouting",
) -> PlainWorld:
    """Return a mission before its first step; `truth` is what an uncertain one really is."""
    world = PlainWorld(mission, truth, is_coordinated, foresight)
    expect_needs(world)
    release_tasks(world)
    return world


def make_step(world: PlainWorld, wishes: Mapping[int, Wish]) -> Happenings:
    """Make a step; return what happened, which the world keeps as `happened` until the next.

    `wishes` says by slot what teams want that do not just maintain.
    """
    world.happened = happened = Happenings()
    stays, joins = read_decisions(world, wishes)
    split_teams(world, stays)
    walks = join_teams(world, joins)
    allocate_tasks(world)
    charge(world, walks)
    move_teams(world, walks)
    spend_standing(world)
    happened.named = [slot for slot, team in world.in_slot_order() if team.is_commanded]
    call_off(world)
    lose_robots(world)
    return_robots(world)
    if happened.lost or happened.back:
        expect_needs(world)
    find_tasks(world)
    show_needs(world)
    complete_tasks(world)
    miss_tasks(world)
    put_down(world)
    world.steps += 1
    release_tasks(world)
    world.order = [task for task in world.order if task in world.open]
    if is_news(world):
        drop_assignments(world)
    return happened


def is_news(world: PlainWorld) -> bool:
    """Say whether something has happened in a step after which teams are allocated anew."""
    happened = world.happened
    arrived = happened.known if world.is_coordinated else happened.opened
    return bool(
        happened.lost or happened.back or happened.cancelled
        or happened.is_elsewhere or happened.shown or arrived
    )  # fmt: skip
