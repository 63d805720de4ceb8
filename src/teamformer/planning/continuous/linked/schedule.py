"""The times of a plan whose tasks are done group after group, in their order, and what it costs.

All tasks of a group are timed at once: each as soon as its robots are there, then later where a
gap says so. That is the earliest that the order allows, and nothing that is judged gains by later.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.jit import kernel
from teamformer.planning.continuous.linked.problem import (
    COMPLETION,
    FREE,
    HOME,
    MAKESPAN,
    MAX_TARDINESS,
    PARTS,
    TARDINESS,
    TRAVEL,
    Floats,
    LinkedProblem,
)
from teamformer.planning.continuous.problem import NOBODY, Ticks, Whole
from teamformer.planning.continuous.schedule import CoalitionPlan, copy_row, released


class LinkedSchedule(NamedTuple):
    """A plan, timed."""

    order: Whole  # (groups,)
    rank: Whole  # (groups,) positions in the order
    coalition: Whole  # (tasks, robots) the first `size` of them
    size: Whole  # (tasks,)
    last: Whole  # (groups + 1, robots) where each robot is before a position of the order
    start: Ticks  # (tasks,)
    end: Ticks  # (places,) 0 for the places where robots start
    way: Ticks  # (tasks,) what all robots of its coalition together take to get there
    part: Ticks  # (PARTS,) what the plan is judged by
    cost: Floats  # (1,)


def empty_linked_schedule(problem: LinkedProblem) -> LinkedSchedule:
    """Return room for a plan and its times."""
    (tasks, _), groups = problem.base.needs.shape, len(problem.members)
    robots = len(problem.base.counts)
    last = np.zeros((groups + 1, robots), np.int32)
    last[0] = problem.base.origin
    return LinkedSchedule(
        order=np.arange(groups, dtype=np.int32),
        rank=np.arange(groups, dtype=np.int32),
        coalition=np.full((tasks, robots), NOBODY, np.int32),
        size=np.zeros(tasks, np.int32),
        last=last,
        start=np.zeros(tasks, np.int64),
        end=np.zeros(problem.base.ways.shape[1], np.int64),
        way=np.zeros(tasks, np.int64),
        part=np.zeros(PARTS, np.int64),
        cost=np.zeros(1),
    )


def plan_of(problem: LinkedProblem, schedule: LinkedSchedule) -> CoalitionPlan:
    """Return what a schedule does as a plan; linked tasks stand beside one another."""
    members = problem.members[schedule.order]  # (groups, most)
    return CoalitionPlan(
        members[members != NOBODY].astype(np.int32),
        schedule.coalition.copy(),
        schedule.size.copy(),
    )


@kernel
def time_linked(problem: LinkedProblem, schedule: LinkedSchedule, begin: int) -> None:
    """Time the groups from a position of the order on, and work out the cost."""
    for position in range(begin, len(schedule.order)):
        time_group(problem, schedule, position)
    _sum_up(problem, schedule)


@kernel
def time_group(problem: LinkedProblem, schedule: LinkedSchedule, position: int) -> None:
    """Time the group at a position of the order."""
    base, last, end = problem.base, schedule.last, schedule.end
    group = schedule.order[position]
    schedule.rank[group] = position
    copy_row(last, position, position + 1)
    for task in problem.members[group]:
        if task == NOBODY:
            break
        start, there, way, comes_apart = released(base, end, task), 0, 0, False
        for seat in range(schedule.size[task]):
            robot = schedule.coalition[task, seat]
            place = last[position, robot]
            takes = base.ways[base.pace[robot], place, task]
            there, way = max(there, end[place] + takes), way + takes
            first = last[position, schedule.coalition[task, 0]]
            comes_apart |= base.site[place] != base.site[first]
            last[position + 1, robot] = task
        schedule.start[task] = max(start, there + base.forming[0] * comes_apart)
        schedule.way[task] = way
    keep_gaps(problem, schedule, group)
    for task in problem.members[group]:
        if task == NOBODY:
            break
        end[task] = schedule.start[task] + base.duration[task]


@kernel
def keep_gaps(problem: LinkedProblem, schedule: LinkedSchedule, group: int) -> None:
    """Start tasks of a group later until all gaps are kept; as often as there are tasks, at most.

    Gaps that contradict one another are refused before.
    """
    start, members = schedule.start, problem.members[group]
    is_changed = members[1] != NOBODY
    while is_changed:
        is_changed = False
        for task in members:
            if task == NOBODY:
                break
            for other in members:
                if other == NOBODY:
                    break
                gap = problem.gap[other, task]
                if gap > FREE and start[other] + gap > start[task]:
                    start[task] = start[other] + gap
                    is_changed = True


@kernel
def _sum_up(problem: LinkedProblem, schedule: LinkedSchedule) -> None:
    """Work out the cost of a plan that is timed."""
    base, part, groups = problem.base, schedule.part, len(schedule.order)
    for number in range(len(part)):
        part[number] = 0
    for robot in range(len(base.origin)):
        place = schedule.last[groups, robot]
        home = base.home[base.kind[robot], place]
        back = schedule.end[place] + home
        part[MAKESPAN] = max(part[MAKESPAN], back)
        part[HOME] += back
        part[TRAVEL] += home
    for task in range(len(schedule.start)):
        late = max(0, schedule.end[task] - base.due[task])
        part[TRAVEL] += schedule.way[task]
        weight = problem.task_weight[task]
        part[TARDINESS] += np.int64(weight * late)
        part[COMPLETION] += np.int64(weight * schedule.end[task])
        part[MAX_TARDINESS] = max(part[MAX_TARDINESS], late)
    schedule.cost[0] = 0.0
    for number in range(len(part)):
        schedule.cost[0] += problem.weight[number] * part[number]


@kernel
def copy_from(source: LinkedSchedule, into: LinkedSchedule, begin: int) -> None:
    """Overwrite a schedule with another that differs from it from a position of the order on."""
    groups, (tasks, robots) = len(source.order), source.coalition.shape
    for position in range(begin, groups):
        group = source.order[position]
        into.order[position] = group
        into.rank[group] = position
        for robot in range(robots):
            into.last[position + 1, robot] = source.last[position + 1, robot]
    for task in range(tasks):
        into.size[task] = source.size[task]
        for seat in range(source.size[task]):
            into.coalition[task, seat] = source.coalition[task, seat]
        into.start[task] = source.start[task]
        into.end[task] = source.end[task]
        into.way[task] = source.way[task]
    for number in range(len(source.part)):
        into.part[number] = source.part[number]
    into.cost[0] = source.cost[0]
