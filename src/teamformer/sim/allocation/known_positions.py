"""Where everybody knows the robots to be: from the tasks that they did, and the way they go on.

Robots that do a task are there, and a company. From there, or from its start, a company walks to
the earliest of its next tasks, and waits.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.jit import kernel
from teamformer.rules.constants import NOBODY
from teamformer.rules.coverage import helps
from teamformer.sim.arrays import NEVER, World
from teamformer.sim.motion import advance, straight_on, travel


@kernel
def is_needed(world: World, robot: int, task: int) -> bool:
    """Say whether a task needs something that a robot brings, and it can get there."""
    if world.robots[robot].region != world.tasks[task].region:
        return False
    return helps(world.brings[robot], world.needs[task])


@kernel
def note_doers(world: World, task: int) -> None:
    """Note that the robots that have just done a task are there, and are one company."""
    team = world.tasks[task].done_by
    for robot in range(world.rules.robots):
        if world.robots[robot].team == team and world.robots[robot].company == robot:
            _leave_behind(world, robot, team)
    for robot in range(world.rules.robots):
        if world.robots[robot].team == team:
            world.robots[robot].company = team
            world.robots[robot].spot_x = world.tasks[task].x
            world.robots[robot].spot_y = world.tasks[task].y
            world.robots[robot].left_at = world.count.steps


@kernel
def _leave_behind(world: World, leader: int, team: int) -> None:
    """Make those of a robot's company that are not in its team a company of their own."""
    heir = NOBODY
    for robot in range(world.rules.robots):
        if world.robots[robot].company == leader and world.robots[robot].team != team:
            heir = robot if heir == NOBODY else heir
            world.robots[robot].company = heir


@kernel
def be_alone_from(world: World, robot: int, step: int) -> None:
    """Note that a robot that was lost is back where that was, a company of its own."""
    heir = NOBODY
    for other in range(world.rules.robots):
        if world.robots[other].company == robot and other != robot:
            heir = other if heir == NOBODY else heir
            world.robots[other].company = heir
    world.robots[robot].company = robot
    world.robots[robot].spot_x = world.robots[robot].x
    world.robots[robot].spot_y = world.robots[robot].y
    world.robots[robot].left_at = step


@kernel
def bring_up_to_date(world: World) -> None:
    """Move every company on to where it must be by now, on its way to its earliest next task."""
    for leader in range(world.rules.robots):
        pace, goal = np.float64(NEVER), np.int32(NOBODY)
        for robot in range(world.rules.robots):
            if world.robots[robot].company == leader and world.robots[robot].team != NOBODY:
                pace = min(pace, world.robots[robot].pace)
                task = world.robots[robot].next
                is_earlier = goal == NOBODY or world.tasks[task].rank < world.tasks[goal].rank
                if task != NOBODY and is_earlier:
                    goal = task
        if pace < NEVER:
            _move_company(world, leader, goal, pace)


@kernel
def _move_company(world: World, leader: int, goal: int, pace: float) -> None:
    x, y = world.robots[leader].spot_x, world.robots[leader].spot_y
    if goal != NOBODY:
        length = pace * (world.count.steps - world.robots[leader].left_at)
        x, y = _walk(world, x, y, goal, length)
    for robot in range(leader, world.rules.robots):
        if world.robots[robot].company == leader:
            world.robots[robot].spot_x, world.robots[robot].spot_y = x, y
            world.robots[robot].left_at = world.count.steps


@kernel
def _walk(world: World, x: float, y: float, goal: int, length: float) -> tuple[Any, Any]:
    """Return where one is after so much of the way to a task."""
    if world.rules.is_plane:
        return straight_on(x, y, world.tasks[goal].x, world.tasks[goal].y, length)
    for _ in range(min(np.int64(length), travel(world, x, y, goal))):
        x, y = advance(world, x, y, goal)
    return x, y
