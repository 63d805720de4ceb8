"""How a trial ends: what is given up, what is possible still, and how it stands after a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import entry, kernel
from teamformer.world.phases.completion import is_done_or_missed
from teamformer.world.phases.motion import is_way
from teamformer.world.rules.constants import NEVER, NOBODY
from teamformer.world.state.arrays import (
    COMPLETED,
    INFEASIBLE,
    RUNNING,
    STEP_LIMIT,
    TOO_LATE,
    world_at,
)

if TYPE_CHECKING:
    from teamformer.base.array_types import Array
    from teamformer.world.state.arrays import World, Worlds


@entry
def give_up_worlds(worlds: Worlds) -> None:
    """Let what is left be missed in worlds whose plans leave it out, if that may be.

    That is so if all that is left is optional and known, and no lost robot will be back. Nothing
    else changes in such a world: it is over, but for its first step.
    """
    for w in range(len(worlds.rules)):
        world = world_at(worlds, w)
        is_planned = world.rules.is_coordinated and world.rules.until < NEVER
        is_running = world.count.status == RUNNING and world.count.steps > 0
        if is_running and is_planned and _is_given_up(world):
            _give_up(world)


@kernel
def _is_given_up(world: World) -> bool:
    for robot in range(world.rules.robots):
        if world.robots[robot].team == NOBODY and world.robots[robot].back < NEVER:
            return False
        task = world.robots[robot].next
        if task != NOBODY and world.tasks[task].is_open:
            return False
    for task in range(world.rules.tasks):
        if is_done_or_missed(world, task) or world.tasks[task].cancelled <= world.count.steps:
            continue
        is_waiting = world.tasks[task].is_open and world.tasks[task].server == NOBODY
        is_left_out = world.tasks[task].is_optional and not world.tasks[task].is_planned
        if not is_waiting or not is_left_out:
            return False
    return True


@kernel
def _give_up(world: World) -> None:
    for task in range(world.rules.tasks):
        if world.tasks[task].is_open:
            world.tasks[task].missed_at = world.count.steps
            world.tasks[task].is_open = False
            world.count.missed += 1
    judge_status(world, False)


@kernel
def is_possible(world: World, task: int, needs: Array, counts_due: bool) -> bool:
    """Say whether the robots that are left and can get there cover the needs of a task together.

    With those that are due back, if `counts_due`; `needs` are (caps,). Those whose last shift is
    over are not left.
    """
    for cap in range(len(needs)):
        short = needs[cap]
        for robot in range(world.rules.robots):
            is_there = is_way(world.robots[robot].region, world.tasks[task].region)
            is_there &= world.count.steps < world.robots[robot].over
            is_due = counts_due and world.count.steps < world.robots[robot].back < NEVER
            if short > 0 and is_there and (is_due or world.robots[robot].team != NOBODY):
                short -= world.brings[robot, cap]
        if short > 0:
            return False
    return True


@kernel
def judge_status(world: World, is_news: bool) -> None:
    """Say how the trial stands after a step: done, impossible, out of steps, or running.

    What was possible stays so unless there is news, as robots may have been lost, or the last shift
    of one is over. A task that is to be called off stops nobody.
    """
    if world.count.done + world.count.cancelled + world.count.missed == world.rules.tasks:
        world.count.status = TOO_LATE if _has_failed(world) else COMPLETED
        return
    if is_news or _any_stops(world):
        for task in range(world.rules.tasks):
            needs = world.true_needs[task] if world.rules.hides_needs else world.needs[task]
            is_wanted = world.tasks[task].cancelled == NEVER and not world.tasks[task].is_optional
            is_wanted = is_wanted and not is_done_or_missed(world, task)
            if is_wanted and not is_possible(world, task, needs, True):
                world.count.status = INFEASIBLE
                return
    if world.count.steps >= world.rules.step_limit:
        world.count.status = STEP_LIMIT


@kernel
def _any_stops(world: World) -> bool:
    """Say whether the last shift of a robot has just ended."""
    for robot in range(world.rules.robots):
        if world.robots[robot].over == world.count.steps:
            return True
    return False


@kernel
def _has_failed(world: World) -> bool:
    """Say whether a task is missed that must be done."""
    for task in range(world.rules.tasks):
        if world.tasks[task].missed_at != NOBODY and not world.tasks[task].is_optional:
            return True
    return False
