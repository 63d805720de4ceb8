"""What a plan wants each team to do now: part, wait and join, or go on.

A robot's next task is the one that it scouts, while there is something to see; else the first
open one in the plan's order that has it in its coalition. A team whose robots have different next
tasks parts, those of the earliest staying; whoever has none stays behind. Teams that wait at a task
for one another join, pair by pair in slot order. On a plane both may be there and yet too far apart
to join, on either side of it: they walk on to its middle until they are near enough.
"""

from __future__ import annotations

from typing import Any

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.world.guidance.parts import Parts, parts_at
from teamformer.world.phases.assignment import find_earliest_tasks
from teamformer.world.phases.delays import may_join
from teamformer.world.phases.formation import choose_stayers, is_in_reach
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import RUNNING, World, Worlds, world_at
from teamformer.world.state.spatial_index import stands_at


@entry
def follow_plans(worlds: Worlds, parts: Parts, is_new: Array) -> None:
    """Write what teams are to do next in all coordinated worlds; `is_new` (worlds,) says which."""
    for w in range(len(worlds.rules)):
        world = world_at(worlds, w)
        if world.rules.is_coordinated and world.count.status != RUNNING:
            parts.took[w] = NOBODY  # what robots exchanged before the end they did not after it
        elif world.rules.is_coordinated:
            _follow(world, parts_at(parts, w), is_new[w])


@kernel
def _follow(world: World, parts: Parts, is_new: Array) -> None:
    _find_next_tasks(world, parts, is_new)
    find_earliest_tasks(world)
    if len(world.zones) > 0:
        _find_who_is_awaited(world, parts)
    for position in range(world.count.open):
        parts.waiting[world.order[position]] = NOBODY
    _find_who_parts(world, parts)
    for team in range(world.rules.robots):
        for cap in range(world.has.shape[1]):
            parts.wanted[team, cap] = world.has[team, cap]
        if world.teams[team].size == 0 or world.teams[team].serves > 0:
            continue
        if parts.is_parting[team]:
            _part(world, parts, team)
        else:
            _join_who_waits(world, parts, team)
    if is_new:  # the plan is written down with these exchanges made
        for robot in range(world.rules.robots):
            parts.took[robot] = NOBODY


@kernel
def _find_next_tasks(world: World, parts: Parts, is_new: Array) -> None:
    """Find each robot's next task, where its last one is done or the plan is new."""
    for robot in range(world.rules.robots):
        parts.took[robot] = NOBODY
        task = world.robots[robot].next
        if not is_new and (task == NOBODY or world.tasks[task].is_open):
            continue
        world.robots[robot].next = NOBODY
        if world.robots[robot].team == NOBODY:
            continue
        scouted = parts.scouts[robot]
        if scouted != NOBODY and world.tasks[scouted].is_open and _is_unseen(world, scouted):
            world.robots[robot].next = scouted
            continue
        part = parts.part[robot]
        for place in range(parts.first[part], parts.first[part + 1]):
            if world.tasks[parts.task[place]].is_open:
                world.robots[robot].next = parts.task[place]
                break


@kernel
def _find_who_is_awaited(world: World, parts: Parts) -> None:
    """Find the tasks that somebody is to do who is there: in zones others let them go first."""
    for task in range(world.rules.tasks):
        world.tasks[task].is_awaited = False
    for robot in range(world.rules.robots):
        part = parts.part[robot]
        if world.robots[robot].team != NOBODY:
            for place in range(parts.first[part], parts.first[part + 1]):
                world.tasks[parts.task[place]].is_awaited = True


@kernel
def _is_unseen(world: World, task: int) -> bool:
    """Say whether nobody knows what a task needs, or where it is."""
    return world.tasks[task].hides_needs or world.tasks[task].hides_place


@kernel
def _find_who_parts(world: World, parts: Parts) -> None:
    """Find the teams whose robots have different next tasks."""
    for team in range(world.rules.robots):
        parts.is_parting[team] = False
    for robot in range(world.rules.robots):
        team = world.robots[robot].team
        if team != NOBODY and world.robots[robot].next != world.robots[team].next:
            parts.is_parting[team] = True


@kernel
def _join_who_waits(world: World, parts: Parts, team: int) -> None:
    """Let a team at its task be joined by the next in slot order that is there and in reach."""
    task = world.teams[team].next
    if task == NOBODY or not stands_at(world, team, task) or not may_join(world, team):
        return
    other = parts.waiting[task]
    if other == NOBODY:
        parts.waiting[task] = team
    if other == NOBODY or not is_in_reach(world, team, other):
        return
    parts.waiting[task] = NOBODY
    for cap in range(world.has.shape[1]):
        parts.wanted[other, cap] += world.has[team, cap]


@kernel
def _part(world: World, parts: Parts, team: int) -> None:
    """Choose the counts to keep so that the robots of one way stay, or all others.

    Ways are looked at in the plan's order. Members stay in robot order while they fit, so it may
    be like ones that stay: they exchange their parts of the plan. If no way can be parted from the
    others like that, the lowest robot goes its own way.
    """
    task = world.teams[team].next
    while task != NOBODY:
        for leaves in (False, True):
            _want_way(world, parts, team, task, leaves)
            choose_stayers(world, team, parts.wanted[team])
            if _are_alike(world, parts, team, task, leaves):
                _exchange(world, parts, team, task, leaves)
                return
        task = _next_way(world, team, task)
    for cap in range(world.has.shape[1]):
        parts.wanted[team, cap] = world.brings[team, cap]


@kernel
def _next_way(world: World, team: int, task: int) -> Any:
    """Return the way of a team's robots that comes after one in the plan's order, or NOBODY."""
    found = NOBODY
    for robot in range(team, world.rules.robots):
        other = world.robots[robot].next
        if world.robots[robot].team != team or other == NOBODY:
            continue
        is_later = world.tasks[other].rank > world.tasks[task].rank
        if is_later and (found == NOBODY or world.tasks[other].rank < world.tasks[found].rank):
            found = other
    return found


@kernel
def _is_meant_to_stay(world: World, robot: int, task: int, leaves: bool) -> bool:
    """Say whether a robot is of the way of a task, or of another if that one leaves."""
    return (world.robots[robot].next == task) != leaves


@kernel
def _want_way(world: World, parts: Parts, team: int, task: int, leaves: bool) -> None:
    """Write the counts of those who are meant to stay."""
    for cap in range(world.has.shape[1]):
        parts.wanted[team, cap] = 0
    for robot in range(team, world.rules.robots):
        if world.robots[robot].team == team and _is_meant_to_stay(world, robot, task, leaves):
            for cap in range(world.has.shape[1]):
                parts.wanted[team, cap] += world.brings[robot, cap]


@kernel
def _are_alike(world: World, parts: Parts, team: int, task: int, leaves: bool) -> bool:
    """Say whether as many robots of each kind stay as are meant to."""
    more = world.near_key  # (robots,) by kind
    for robot in range(world.rules.robots):
        more[robot] = 0
    for robot in range(team, world.rules.robots):
        if world.robots[robot].team == team:
            kind = parts.kind[robot]
            more[kind] += world.robots[robot].stays
            more[kind] -= _is_meant_to_stay(world, robot, task, leaves)
    for robot in range(world.rules.robots):
        if more[robot] != 0:
            return False
    return True


@kernel
def _exchange(world: World, parts: Parts, team: int, task: int, leaves: bool) -> None:
    """Let robots that stay take the parts of like ones that are meant to, and the other way round.

    Each does so at most once, as one that is meant to stay then stays.
    """
    for robot in range(team, world.rules.robots):
        if world.robots[robot].team != team or not world.robots[robot].stays:
            continue
        if _is_meant_to_stay(world, robot, task, leaves):
            continue
        for other in range(team, world.rules.robots):
            is_like = parts.kind[other] == parts.kind[robot]
            leaves_team = world.robots[other].team == team and not world.robots[other].stays
            if is_like and leaves_team and _is_meant_to_stay(world, other, task, leaves):
                _swap_parts(world, parts, robot, other)
                break


@kernel
def _swap_parts(world: World, parts: Parts, robot: int, other: int) -> None:
    part = parts.part[robot]
    parts.part[robot] = parts.part[other]
    parts.part[other] = part
    scouted = parts.scouts[robot]
    parts.scouts[robot] = parts.scouts[other]
    parts.scouts[other] = scouted
    following = world.robots[robot].next
    world.robots[robot].next = world.robots[other].next
    world.robots[other].next = following
    parts.took[robot], parts.took[other] = other, robot
