"""Formation: what the teams' decisions mean, and the splits and joins that follow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.world.phases.delays import may_join
from teamformer.world.rules.constants import NEVER, NOBODY
from teamformer.world.rules.splitting import fits
from teamformer.world.state.arrays import ANYWHERE
from teamformer.world.state.spatial_index import distance_squared, distance_squared_to, find_near

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World

MAINTAIN, SPLIT, JOIN = 0, 1, 2


@kernel
def read_decisions(world: World, wanted: Array, named: Array, first_row: int) -> None:
    """Phase 1: what each team's decision means in the state at the start of the step.

    `wanted` is (teams, caps) and `named` is (teams,), one row for each team in slot order from
    `first_row` on. What is illegal counts as maintain, and is counted.
    """
    row = first_row
    for team in range(world.rules.robots):
        world.teams[team].has_formed = False
        world.teams[team].intent = MAINTAIN
        world.teams[team].partner = NOBODY
        world.teams[team].row = NOBODY
        world.teams[team].is_commanded = False
        if world.teams[team].size == 0:
            continue
        world.teams[team].row = row
        intent, is_legal = _intent(world, team, wanted[row], named[row] == NOBODY)
        task = named[row]
        if task != NOBODY:
            if 0 <= task < world.rules.tasks and world.tasks[task].is_open:
                world.teams[team].is_commanded = True
            else:
                is_legal = False
        world.teams[team].intent = intent
        world.count.illegal += not is_legal
        row += 1


@kernel
def _intent(world: World, team: int, wanted: Array, prefers_mates: bool) -> tuple[int, bool]:
    """Return what a team is about to do and whether it asked for something legal."""
    asks_more = asks_less = False
    for cap in range(len(wanted)):
        asks_more |= wanted[cap] > world.has[team, cap]
        asks_less |= wanted[cap] < world.has[team, cap]
    if not asks_more and not asks_less:
        return MAINTAIN, True
    if (asks_more and asks_less) or world.teams[team].serves > 0:
        return MAINTAIN, False
    if asks_more and not may_join(world, team):
        return MAINTAIN, False
    if asks_less:
        if choose_stayers(world, team, wanted) == 0:
            return MAINTAIN, False
        return SPLIT, True
    world.teams[team].partner = _find_partner(world, team, wanted, prefers_mates)
    if world.teams[team].partner == NOBODY:
        return MAINTAIN, False
    return JOIN, True


@kernel
def choose_stayers(world: World, team: int, wanted: Array) -> int:
    """Mark the members that stay: in robot order while they fit into `wanted`; return how many."""
    stayers = 0
    for cap in range(len(wanted)):
        world.room[cap] = wanted[cap]
    for robot in range(team, world.rules.robots):
        if world.robots[robot].team != team:
            continue
        world.robots[robot].stays = fits(world.brings[robot], world.room)
        if world.robots[robot].stays:
            stayers += 1
            for cap in range(len(wanted)):
                world.room[cap] -= world.brings[robot, cap]
    return stayers


@kernel
def _find_partner(world: World, team: int, wanted: Array, prefers_mates: bool) -> int:
    """Return the nearest team within the join radius that has exactly what is wanted more.

    Ties: the same assignment first, then the lower slot. By a plan, one that has the same task next
    comes before all others, unless the decision names a task.
    """
    partner, partner_away, partner_shares, partner_is_mate = NOBODY, 0.0, False, False
    for i in range(find_near(world, team, world.rules.join_radius)):
        other = world.near[i]
        if not may_join(world, other) or not _completes(world, team, other, wanted):
            continue
        away = distance_squared(world, team, other)
        task = world.teams[team].task
        shares = task != NOBODY and task == world.teams[other].task
        is_mate = prefers_mates and _are_mates(world, team, other)
        if partner == NOBODY or is_mate != partner_is_mate:
            is_better = partner == NOBODY or is_mate
        elif away != partner_away:
            is_better = away < partner_away
        else:
            is_better = shares > partner_shares or (shares == partner_shares and other < partner)
        if is_better:
            partner, partner_away, partner_shares = other, away, shares
            partner_is_mate = is_mate
    return partner


@kernel
def _are_mates(world: World, team: int, other: int) -> bool:
    """Say whether two teams have the same task next by a plan."""
    task = world.teams[team].next
    return world.rules.is_coordinated and task != NOBODY and task == world.teams[other].next


@kernel
def _completes(world: World, team: int, other: int, wanted: Array) -> bool:
    for cap in range(len(wanted)):
        if world.has[team, cap] + world.has[other, cap] != wanted[cap]:
            return False
    return True


@kernel
def split_teams(world: World, wanted: Array) -> None:
    """Phase 2: the robots that stay and the rest become two teams without assignment."""
    for team in range(world.rules.robots):
        if world.teams[team].intent == SPLIT and not world.teams[team].has_formed:
            choose_stayers(world, team, wanted[world.teams[team].row])
            _split_team(world, team)
            world.count.splits += 1


@kernel
def _split_team(world: World, team: int) -> None:
    x, y = world.teams[team].x, world.teams[team].y
    clear_slot(world, team)
    stay_slot = rest_slot = NOBODY
    for robot in range(team, world.rules.robots):
        if world.robots[robot].team != team:
            continue
        slot = stay_slot if world.robots[robot].stays else rest_slot
        if slot == NOBODY:
            slot = robot
            clear_slot(world, slot)
            world.teams[slot].x, world.teams[slot].y = x, y
            if world.robots[robot].stays:
                stay_slot = robot
            else:
                rest_slot = robot
        add_robot(world, slot, robot)
    world.teams[stay_slot].has_formed = world.teams[rest_slot].has_formed = True
    is_commanded = world.teams[team].is_commanded
    world.teams[stay_slot].is_commanded = world.teams[rest_slot].is_commanded = is_commanded
    world.teams[stay_slot].row, world.teams[rest_slot].row = world.teams[team].row, NOBODY


@kernel
def form_joins(world: World) -> None:
    """Phase 3: joins in slot order, of teams in the same place that have not formed in this step.

    A join whose partner has formed becomes maintain; a partner elsewhere is walked to later.
    """
    for team in range(world.rules.robots):
        if world.teams[team].intent != JOIN or world.teams[team].has_formed:
            continue
        partner = world.teams[team].partner
        if world.teams[partner].has_formed:
            world.teams[team].intent = MAINTAIN
        elif is_in_same_place(world, team, partner):
            join_teams(world, team, partner)
            world.count.joins += 1


@kernel
def is_in_same_place(world: World, team: int, other: int) -> bool:
    """Say whether two teams stand in the same cell; on a plane, within the arrival radius."""
    return distance_squared(world, team, other) <= world.rules.arrival_radius**2


@kernel
def is_in_reach(world: World, team: int, other: int) -> bool:
    """Say whether two teams are so near that one may join the other."""
    return distance_squared(world, team, other) <= world.rules.join_radius**2


@kernel
def join_teams(world: World, joiner: int, partner: int) -> None:
    """Make one team of two; it gets the lower slot, and the joiner's command if there is one."""
    slot, other = min(joiner, partner), max(joiner, partner)
    task = _task_of_union(world, joiner, partner)
    world.teams[slot].x, world.teams[slot].y = _place_of_union(world, joiner, partner, task)
    world.teams[slot].is_detour = False
    world.teams[slot].task = task
    world.teams[slot].credit = 0.0
    world.teams[slot].charger = world.teams[slot].charges_for = NOBODY
    world.teams[slot].has_walked = False
    for robot in range(other, world.rules.robots):
        if world.robots[robot].team == other:
            add_robot(world, slot, robot)
    clear_slot(world, other)
    world.teams[slot].has_formed = world.teams[other].has_formed = True
    world.teams[slot].intent = MAINTAIN
    commanding = joiner if world.teams[joiner].is_commanded else partner
    world.teams[slot].is_commanded = world.teams[commanding].is_commanded
    world.teams[slot].row = world.teams[commanding].row


@kernel
def _task_of_union(world: World, team: int, other: int) -> np.int32:
    """Return the earlier assignment in the order.

    If one of the two is free or on a detour, none: the union is allocated anew, from the first
    open task on, since tasks that the free one would have been given are waiting for it.
    """
    task, other_task = world.teams[team].task, world.teams[other].task
    any_free = task == NOBODY or other_task == NOBODY
    if any_free or world.teams[team].is_detour or world.teams[other].is_detour:
        return np.int32(NOBODY)
    return task if world.tasks[task].rank <= world.tasks[other_task].rank else other_task


@kernel
def _place_of_union(world: World, joiner: int, partner: int, task: int) -> tuple[Any, Any]:
    """Return where the partner is; or the joiner, if it is nearer to the union's assignment.

    So a union stands at its assignment if one of the two does. On a grid both are in one cell.
    """
    at = partner
    if task != NOBODY:
        away = distance_squared_to(world, partner, task)
        if distance_squared_to(world, joiner, task) < away:
            at = joiner
    return world.teams[at].x, world.teams[at].y


@kernel
def clear_slot(world: World, slot: int) -> None:
    """Leave no team at a slot."""
    world.teams[slot].size = 0
    for cap in range(world.has.shape[1]):
        world.has[slot, cap] = 0
    world.teams[slot].pace = NEVER
    world.teams[slot].region = ANYWHERE
    world.teams[slot].credit = 0.0
    world.teams[slot].task = NOBODY
    world.teams[slot].is_detour = False
    world.teams[slot].serves = 0
    world.teams[slot].charger = world.teams[slot].charges_for = NOBODY
    world.teams[slot].has_walked = False


@kernel
def add_robot(world: World, slot: int, robot: int) -> None:
    """Put a robot into the team at a slot."""
    world.robots[robot].team = slot
    world.teams[slot].size += 1
    world.teams[slot].pace = min(world.teams[slot].pace, world.robots[robot].pace)
    world.teams[slot].region = max(world.teams[slot].region, world.robots[robot].region)
    for cap in range(world.has.shape[1]):
        world.has[slot, cap] += world.brings[robot, cap]
