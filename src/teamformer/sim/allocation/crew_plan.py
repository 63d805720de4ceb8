"""Crews while a trial runs: when they are planned, from what, and who goes where by their lists.

All of it rests on what everybody knows: the fleet list, who was lost, the open tasks, and who did
the others when.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.jit import allocating_kernel, kernel
from teamformer.planning.crews.plan import plan_crews
from teamformer.planning.crews.routes import Shared, bits_of
from teamformer.rules.constants import MICROMETRES, NOBODY
from teamformer.sim.allocation.known_positions import bring_up_to_date, is_needed, note_doers
from teamformer.sim.completion import is_possible
from teamformer.sim.motion import travel

if TYPE_CHECKING:
    from teamformer.rules.arrays import Array
    from teamformer.sim.arrays import World

ROUNDS = 1500
"""How many changes are tried for each open task in a plan."""
ROUNDS_AGAIN = 300
"""The same when a crew has nothing left to do."""


@allocating_kernel
def update_plan(world: World) -> None:
    """Plan the crews where need be; call it after each step.

    Crews are planned at the start, when tasks appear, when robots are lost or back, when it shows
    what a task needs or that it is elsewhere, and when a crew has nothing left to do.
    """
    any_new, any_done = world.count.arrived > 0, world.count.noted < world.count.done
    is_changed = _forget_lost(world)
    is_changed |= world.count.back > world.count.planned_back
    is_changed |= world.count.shown > world.count.planned_shown
    is_changed |= world.count.found > world.count.planned_found
    world.count.planned_back = world.count.back
    world.count.planned_shown = world.count.shown
    world.count.planned_found = world.count.found
    is_idle = _note_done(world)
    if world.count.open > 0 and (any_new or is_changed or is_idle):
        rounds = ROUNDS if any_new or is_changed else ROUNDS_AGAIN
        _plan(world, rounds * world.count.open)
    if any_new or any_done or is_changed:
        _find_next_tasks(world)


@kernel
def _forget_lost(world: World) -> bool:
    """Take lost robots off their crews; say whether there are any."""
    any_lost = False
    for robot in range(world.rules.robots):
        if world.robots[robot].team == NOBODY and world.robots[robot].crew != NOBODY:
            world.robots[robot].crew = NOBODY
            any_lost = True
    return any_lost


@kernel
def _note_done(world: World) -> bool:
    """Note who is where a task was done; say whether a crew has just done its last.

    Only if another crew has more than one left.
    """
    is_idle = False
    if world.count.noted < world.count.done:
        for task in range(world.rules.tasks):
            if world.tasks[task].done_at == world.count.steps:
                note_doers(world, task)
                is_idle |= _has_nothing_left(world, world.tasks[task].crew)
        world.count.noted = world.count.done
    return is_idle and _any_has_several_left(world)


@kernel
def _has_nothing_left(world: World, crew: int) -> bool:
    for position in range(world.count.open):
        if world.tasks[world.order[position]].crew == crew:
            return False
    return True


@kernel
def _any_has_several_left(world: World) -> bool:
    for position in range(world.count.open):
        for later in range(position + 1, world.count.open):
            crew = world.tasks[world.order[position]].crew
            if crew == world.tasks[world.order[later]].crew:
                return True
    return False


@kernel
def _find_next_tasks(world: World) -> None:
    """Find each robot's next task: the first open one of its crew's list that needs it."""
    for robot in range(world.rules.robots):
        world.robots[robot].next = NOBODY
        crew = world.robots[robot].crew
        position = 0
        while crew != NOBODY and position < world.count.open:
            task = world.order[position]
            if world.tasks[task].crew == crew and is_needed(world, robot, task):
                world.robots[robot].next = task
                break
            position += 1


@allocating_kernel
def _plan(world: World, rounds: int) -> None:
    """Plan crews and order from the state that everybody knows.

    Tasks that wait for a robot to come back are on no crew's list, and last in the order.
    """
    bring_up_to_date(world)
    count = _put_possible_first(world)
    tasks = world.order[:count].copy()
    world.count.plans += 1
    if count == 0:
        for robot in range(world.rules.robots):
            world.robots[robot].crew = robot if world.robots[robot].team != NOBODY else NOBODY
        return
    robots = np.array([r for r in range(world.rules.robots) if world.robots[r].team != NOBODY])
    shared = _gather_shared(world, robots, tasks)
    crew = np.empty(len(robots), dtype=np.int64)
    task_crew = np.empty(count, dtype=np.int64)
    newest = NOBODY
    for index in range(len(robots)):
        crew[index] = world.robots[robots[index]].crew
        newest = max(newest, crew[index])
    for index in range(len(robots)):
        if crew[index] == NOBODY and newest != NOBODY:  # it is back: a crew of its own at first
            newest += 1
            crew[index] = newest
    for index in range(count):
        task_crew[index] = world.tasks[tasks[index]].crew
    sequence = plan_crews(shared, crew, task_crew, rounds)
    for index in range(len(robots)):
        world.robots[robots[index]].crew = crew[index]
    for position in range(count):
        task = tasks[sequence[position]]
        world.order[position] = task
        world.tasks[task].crew = task_crew[sequence[position]]
        world.tasks[task].rank = position


@kernel
def _put_possible_first(world: World) -> int:
    """Put what the robots that are left can do first in the order; return how many tasks these are.

    What they cannot do keeps its order behind, on nobody's list.
    """
    possible = 0
    for position in range(world.count.open):
        task = world.order[position]
        if is_possible(world, task, world.needs[task], False):
            for later in range(position, possible, -1):
                world.order[later] = world.order[later - 1]
            world.order[possible] = task
            possible += 1
    for position in range(possible, world.count.open):
        world.tasks[world.order[position]].crew = NOBODY
        world.tasks[world.order[position]].rank = position
    return possible


@allocating_kernel
def _gather_shared(world: World, robots: Array, tasks: Array) -> Shared:
    """Return what everybody knows of the robots that are left and of the open tasks."""
    caps = world.needs.shape[1]
    counts = np.empty((len(robots), caps), dtype=np.int64)
    needs = np.empty((len(tasks), caps), dtype=np.int64)
    slowness, robot_region = np.empty(len(robots)), np.empty(len(robots), dtype=np.int64)
    ready, place = np.empty(len(robots), dtype=np.int64), np.empty(len(robots), dtype=np.int64)
    company = np.empty(len(robots), dtype=np.int64)
    duration, task_region = np.empty(len(tasks), dtype=np.int64), np.empty(len(tasks), np.int64)
    ways = np.empty((len(tasks) + len(robots), len(tasks)))
    for index in range(len(tasks)):
        task = world.tasks[tasks[index]]
        needs[index] = world.needs[tasks[index]]
        duration[index], task_region[index] = task.duration, task.region
        for goal in range(len(tasks)):
            ways[index, goal] = travel(world, task.x, task.y, tasks[goal])
    for index in range(len(robots)):
        robot = world.robots[robots[index]]
        counts[index] = world.brings[robots[index]]
        slowness[index] = 1 / (robot.pace * (MICROMETRES if world.rules.is_plane else 1.0))
        robot_region[index], ready[index] = robot.region, robot.left_at
        other = same = 0
        while world.robots[robots[other]].company != robot.company:
            other += 1
        while not _is_same_spot(world.robots[robots[same]], robot):
            same += 1
        company[index], place[index] = other, len(tasks) + same
        for goal in range(len(tasks)):
            ways[len(tasks) + index, goal] = travel(world, robot.spot_x, robot.spot_y, tasks[goal])
    return Shared(
        np.int64(world.count.steps),
        ways,
        slowness,
        counts,
        needs,
        bits_of(needs),
        duration,
        robot_region,
        task_region,
        place,
        ready,
        company,
    )


@kernel
def _is_same_spot(robot: Any, other: Any) -> bool:
    return robot.spot_x == other.spot_x and robot.spot_y == other.spot_y
