"""What the critic sees: every team and every open task of every world, in relations.

Unlike a view this is global; it is used in training only, and like a view's relations it names
no capability.
"""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.world.rules.constants import NOBODY
from teamformer.world.state.arrays import Worlds, world_at

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World

OPEN_TASKS = 16
"""How many of the open tasks the critic sees, first ones first."""


class TeamFeature(IntEnum):
    """What a team's token says."""

    SIZE = 0
    COUNTS = 1
    HAS_TASK = 2
    DISTANCE = 3
    IS_AT_TASK = 4
    COVERED = 5
    RANK = 6
    TO_FIRST_TASK = 7
    TASKS_ALONE = 8
    HERE = 9


class TaskFeature(IntEnum):
    """What the token of an open task says."""

    POSITION = 0
    NEEDS = 1
    NEAREST = 2
    NEAREST_ABLE = 3
    COVERED_AT_BEST = 4
    IS_COVERED = 5
    COVERED_BY_ASSIGNED = 6
    ASSIGNED = 7
    FROM_PREVIOUS = 8


class WorldFeature(IntEnum):
    """What is said of a world."""

    OPEN_TASKS = 0
    IS_LAST_TASK = 1
    TEAMS = 2
    ROBOTS = 3
    LARGEST_TEAM = 4
    WAY_AHEAD = 5
    IS_ONE_TEAM = 6
    SENSING_RADIUS = 7
    LONGEST_WAY = 8


TEAM_FEATURES, TASK_FEATURES, WORLD_FEATURES = map(len, (TeamFeature, TaskFeature, WorldFeature))
FARTHEST = 20.0  # cells


class GlobalState(NamedTuple):
    """Tokens for all teams and open tasks of each world; float32 and bool."""

    teams: Array  # (worlds, robots, TEAM_FEATURES)
    is_team: Array  # (worlds, robots)
    tasks: Array  # (worlds, tasks, TASK_FEATURES)
    is_task: Array  # (worlds, tasks)
    world: Array  # (worlds, WORLD_FEATURES)


def global_state_of(worlds: Worlds) -> GlobalState:
    """Return the state of every world of a batch."""
    count, robots, _ = worlds.has.shape
    tasks = min(OPEN_TASKS, worlds.needs.shape[1])
    state = GlobalState(
        teams=np.zeros((count, robots, TEAM_FEATURES), dtype=np.float32),
        is_team=np.zeros((count, robots), dtype=np.bool_),
        tasks=np.zeros((count, tasks, TASK_FEATURES), dtype=np.float32),
        is_task=np.zeros((count, tasks), dtype=np.bool_),
        world=np.zeros((count, WORLD_FEATURES), dtype=np.float32),
    )
    _fill(worlds, *state)
    return state


@entry
def _fill(
    worlds: Worlds, teams: Array, is_team: Array, tasks: Array, is_task: Array, about: Array
) -> None:
    for w in range(len(worlds.rules)):
        world = world_at(worlds, w)
        shown = min(is_task.shape[1], world.count.open)
        for position in range(shown):
            is_task[w, position] = True
            _write_task(world, tasks[w, position], position)
        for team in range(world.rules.robots):
            if world.teams[team].size > 0:
                is_team[w, team] = True
                _write_team(world, teams[w, team], team, shown)
        _write_world(world, about[w], shown)


@kernel
def _away(world: World, team: int, task: int) -> float:
    away = abs(world.teams[team].x - world.tasks[task].x)
    return min(away + abs(world.teams[team].y - world.tasks[task].y), FARTHEST) / FARTHEST


@kernel
def _share(world: World, team: int, task: int) -> float:
    covered = needed = 0
    for cap in range(world.has.shape[1]):
        needed += world.needs[task, cap]
        covered += min(world.has[team, cap], world.needs[task, cap])
    return covered / max(needed, 1)


@kernel
def _write_team(world: World, out: Array, team: int, shown: int) -> None:
    task, counts, alone, here = world.teams[team].task, 0, 0, 0
    for cap in range(world.has.shape[1]):
        counts += world.has[team, cap]
    for position in range(shown):
        alone += _share(world, team, world.order[position]) == 1.0
    for other in range(world.rules.robots):
        if other != team and world.teams[other].size > 0:
            here += (
                world.teams[other].x == world.teams[team].x
                and world.teams[other].y == world.teams[team].y
            )
    out[TeamFeature.SIZE] = min(world.teams[team].size, 16) / 16
    out[TeamFeature.COUNTS] = min(counts, 16) / 16
    out[TeamFeature.HAS_TASK] = task != NOBODY
    if task != NOBODY:
        out[TeamFeature.DISTANCE] = _away(world, team, task)
        out[TeamFeature.IS_AT_TASK] = out[TeamFeature.DISTANCE] == 0.0
        out[TeamFeature.COVERED] = _share(world, team, task)
        out[TeamFeature.RANK] = min(world.tasks[task].rank, 8) / 8
    if shown > 0:
        out[TeamFeature.TO_FIRST_TASK] = _away(world, team, world.order[0])
    out[TeamFeature.TASKS_ALONE] = alone / max(shown, 1)
    out[TeamFeature.HERE] = min(here, 8) / 8


@kernel
def _write_task(world: World, out: Array, position: int) -> None:
    task, needed, assigned = world.order[position], 0, 0
    nearest, nearest_able, best, best_assigned = 1.0, 1.0, 0.0, 0.0
    for cap in range(world.has.shape[1]):
        needed += world.needs[task, cap]
    for team in range(world.rules.robots):
        if world.teams[team].size == 0:
            continue
        away, share = _away(world, team, task), _share(world, team, task)
        nearest, best = min(nearest, away), max(best, share)
        if share == 1.0:
            nearest_able = min(nearest_able, away)
        if world.teams[team].task == task:
            assigned += 1
            best_assigned = max(best_assigned, share)
    out[TaskFeature.POSITION] = position / 16
    out[TaskFeature.NEEDS] = min(needed, 10) / 10
    out[TaskFeature.NEAREST] = nearest
    out[TaskFeature.NEAREST_ABLE] = nearest_able
    out[TaskFeature.COVERED_AT_BEST] = best
    out[TaskFeature.IS_COVERED] = best == 1.0
    out[TaskFeature.COVERED_BY_ASSIGNED] = best_assigned
    out[TaskFeature.ASSIGNED] = min(assigned, 8) / 8
    if position > 0:
        out[TaskFeature.FROM_PREVIOUS] = _between(world, world.order[position - 1], task)


@kernel
def _between(world: World, task: int, other: int) -> float:
    away = abs(world.tasks[task].x - world.tasks[other].x)
    return min(away + abs(world.tasks[task].y - world.tasks[other].y), FARTHEST) / FARTHEST


@kernel
def _write_world(world: World, out: Array, shown: int) -> None:
    teams = largest = 0
    for team in range(world.rules.robots):
        teams += world.teams[team].size > 0
        largest = max(largest, world.teams[team].size)
    way = 0.0
    for position in range(1, shown):
        way += _between(world, world.order[position - 1], world.order[position])
    out[WorldFeature.OPEN_TASKS] = world.count.open / 10
    out[WorldFeature.IS_LAST_TASK] = shown == 1
    out[WorldFeature.TEAMS] = teams / 10
    out[WorldFeature.ROBOTS] = world.rules.robots / 10
    out[WorldFeature.LARGEST_TEAM] = largest / max(world.rules.robots, 1)
    out[WorldFeature.WAY_AHEAD] = way / 5
    out[WorldFeature.IS_ONE_TEAM] = teams == 1
    out[WorldFeature.SENSING_RADIUS] = min(world.rules.sensing_radius, 10.0) / 10
    out[WorldFeature.LONGEST_WAY] = _longest_way(world, shown) / 5


@kernel
def _longest_way(world: World, shown: int) -> float:
    """Return the longest way along the open tasks, in order from any of them."""
    longest = 0.0
    for first in range(shown):
        way, last = 0.0, world.order[first]
        for position in range(first + 1, shown):
            task = world.order[position]
            way += _between(world, last, task)
            last = task
        longest = max(longest, way)
    return longest
