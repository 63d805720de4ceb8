"""Who is together with whom while a plan is timed, what that group can do, and when."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array, Floats
from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.world.rules.constants import FAR, NOBODY


class Groups(NamedTuple):
    """Room to time a plan in; a group has the number of its last task, or tasks + its leader."""

    company: Array  # (robots,) the lowest robot of the team it is in at the start
    forming: Array  # (1,) steps that a split costs
    losses: Array  # (1,) whether robots will be lost, and it is known when
    of: Array  # (robots,) group
    start: Array  # (tasks,) the step in which its service begins
    end: Array  # (groups,) the step in which its last task is done
    free: Array  # (groups,) the step in which all that it serves there is done
    size: Array  # (groups,) robots in it that have not gone on
    splits: Array  # (groups,)
    pace: Array  # (groups,) the slowest of those that leave together
    leaving: Array  # (groups,) how many these are
    until: Array  # (groups,) the step until which these are busy on the way
    seen: Array  # (groups,) the last task that it took part in
    touched: Array  # (robots,) groups that take part in the task at hand
    arrive: Array  # (robots,) when they get there
    is_done: Array  # (tasks,)
    slot: Array  # (tasks,) the lowest robot of those who do it
    passed_to: Array  # (tasks,) the task that a group headed for when it did this one, or NOBODY
    passed_from: Array  # (tasks,) that group
    passes: Array  # (1,) how many tasks are done on the way to others
    too_early: Array  # (4,) a task passed before it is done, where that leads, the group, the step
    spare: Array  # (2,) a task that can be done without some group that comes to it, and that group
    moved: Array  # (tasks,) the tasks in the order in which they are done, as it is worked out
    spares: Array  # (robots,) those of a coalition that it can do without
    together: Array  # (robots,) those of a coalition or a group whose shifts are looked at
    permits: Array  # (permits,) the step from which each can be used again
    left: Floats  # (robots,) what each has in its battery; empty if nobody has one
    dry: Array  # (1,) how often a robot has nothing left after a task
    reach: Floats  # (5,) how far the robots of a team get that is looked at
    onward: Floats  # (chargers,) how far it is from each to a task for them


def empty_groups(problem: Relaxed, company: Array, forming_steps: int) -> Groups:
    """Return room to time plans of a fleet in; `company` is the lowest robot of each one's team."""
    tasks, robots = len(problem.appears), len(problem.pace)
    by_task, by_robot, by_group = tasks, robots, tasks + robots
    return Groups(
        company=company.astype(np.int32),
        forming=np.array([forming_steps], np.int32),
        losses=np.array([problem.lost.min() < FAR]),
        of=np.zeros(by_robot, np.int32),
        start=np.zeros(by_task, np.int32),
        end=np.zeros(by_group, np.int32),
        free=np.zeros(by_group, np.int32),
        size=np.zeros(by_group, np.int32),
        splits=np.zeros(by_group, np.int32),
        pace=np.zeros(by_group, np.int32),
        leaving=np.zeros(by_group, np.int32),
        until=np.zeros(by_group, np.int32),
        seen=np.zeros(by_group, np.int32),
        touched=np.zeros(by_robot, np.int32),
        arrive=np.zeros(by_robot, np.int32),
        is_done=np.zeros(by_task, np.bool_),
        slot=np.zeros(by_task, np.int32),
        passed_to=np.zeros(by_task, np.int32),
        passed_from=np.zeros(by_task, np.int32),
        passes=np.zeros(1, np.int32),
        too_early=np.zeros(4, np.int32),
        spare=np.zeros(2, np.int32),
        moved=np.zeros(by_task, np.int32),
        spares=np.zeros(by_robot, np.int32),
        together=np.zeros(by_robot, np.int32),
        permits=np.zeros(problem.permits.number, np.int32),
        left=np.zeros(len(problem.batteries.lasts)),
        dry=np.zeros(1, np.int32),
        reach=np.zeros(5),
        onward=np.zeros(len(problem.batteries.fro)),
    )


@kernel
def gather_at_start(problem: Relaxed, groups: Groups) -> None:
    """Put all robots into the teams that they start in, with nothing done."""
    tasks = len(problem.duration)
    for group in range(len(groups.end)):
        groups.size[group] = groups.splits[group] = 0
        groups.seen[group] = NOBODY
    for robot in range(len(groups.of)):
        group = tasks + groups.company[robot]
        groups.of[robot] = group
        groups.size[group] += 1
        groups.end[group] = groups.free[group] = problem.ready[robot]
    for permit in range(len(groups.permits)):
        groups.permits[permit] = problem.permits.free[permit]
    for robot in range(len(groups.left)):
        groups.left[robot] = problem.batteries.left[robot]
    for task in range(tasks):
        groups.is_done[task] = False
        groups.start[task] = groups.end[task] = FAR
        groups.passed_to[task] = NOBODY
    groups.passes[0] = groups.dry[0] = 0
    groups.too_early[0] = groups.spare[0] = NOBODY


@kernel
def opens(problem: Relaxed, groups: Groups, task: int) -> Any:
    """Return the first step in which a task may start; FAR if one before it is not done yet."""
    opens = problem.appears[task] + 1
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if not groups.is_done[other]:
            return FAR
        opens = max(opens, groups.end[other] + 1)
    return opens


@kernel
def may_begin(problem: Relaxed, groups: Groups, task: int, step: int) -> bool:
    """Say whether a task may start in a step, and ends before the mission is over."""
    if step < opens(problem, groups, task):
        return False
    until = problem.misses.until
    return len(until) == 0 or step + problem.duration[task] <= until[0]


@kernel
def can_do(
    problem: Relaxed,
    plan: CoalitionPlan,
    groups: Groups,
    group: int,
    task: int,
    other: int,
    is_with: bool = True,
) -> bool:
    """Say whether the robots of a group that go to a task can do another one.

    Or, if not `is_with`, those that go there and are not of the group.
    """
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[other, cap]
        if lacking > 0:
            for seat in range(plan.size[task]):
                robot = plan.coalition[task, seat]
                if (groups.of[robot] == group) == is_with:
                    lacking -= problem.counts[robot, cap]
            if lacking > 0:
                return False
    return True


@kernel
def is_crew(plan: CoalitionPlan, groups: Groups, group: int, task: int, other: int) -> bool:
    """Say whether another task is planned for those who do one, all of them from one group."""
    if plan.size[task] != plan.size[other]:
        return False
    for seat in range(plan.size[task]):
        is_of_group = groups.of[plan.coalition[task, seat]] == group
        if not is_of_group or groups.of[plan.coalition[other, seat]] != group:
            return False
    return True


@kernel
def slot_of(plan: CoalitionPlan, groups: Groups, group: int, task: int) -> int:
    """Return the lowest robot of a group that goes to a task, or of one that is there."""
    slot = len(groups.of)
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        if groups.of[robot] == group:
            slot = min(slot, robot)
    return slot


@kernel
def is_begun(groups: Groups, task: int, step: int, slot: int) -> bool:
    """Say whether others have begun a task before a team could in a step.

    Of two teams that could begin it in one step that of the lower slot does.
    """
    is_before = groups.start[task] < step
    is_before |= groups.start[task] == step and groups.slot[task] <= slot
    return bool(groups.is_done[task] and is_before)


@kernel
def do_on_the_way(
    groups: Groups, group: int, task: int, other: int, start: int, end: int, slot: int
) -> None:
    """Have a group on its way to a task do another one; `slot` is its lowest robot."""
    groups.is_done[other], groups.slot[other] = True, slot
    groups.start[other], groups.end[other] = start, end
    groups.passed_to[other], groups.passed_from[other] = task, group


@kernel
def note_too_early(groups: Groups, group: int, task: int, other: int, step: int) -> None:
    """Note that a group on its way to a task does another one before those planned for it."""
    groups.too_early[0], groups.too_early[1] = other, task
    groups.too_early[2], groups.too_early[3] = group, step
