"""A plan and its times: tasks in their order, each when its coalition is there."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Int32s, Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.mission.checks.costs import LATENESS
from teamformer.planning.problem.batteries import are_charged
from teamformer.planning.problem.charged_ways import go_charged, in_ticks
from teamformer.planning.problem.coalition_plan import CoalitionPlan, copy_plan, empty_plan
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem
from teamformer.planning.problem.constants import SPREAD
from teamformer.planning.problem.misses import LEFT_OUT
from teamformer.planning.problem.rotas import fits_all, walked, worked

if TYPE_CHECKING:
    from teamformer.base.array_types import Array

MAKESPAN, COST, BACK_SUM, LATE, MISSED = range(5)


class Schedule(NamedTuple):
    """A plan, timed."""

    plan: CoalitionPlan
    rank: Int32s  # (tasks,) positions in the order
    last: Int32s  # (tasks + 1, robots) where each robot is before a position of the order
    left: Ints  # (tasks + 1, robots) what it has in its battery then; empty if nobody has one
    start: Ints  # (tasks,)
    end: Ints  # (places,) for the places where robots are: when they can leave
    total: Ints  # (5,) makespan, cost, sum of the times at home, lateness, what is missed


def empty_schedule(problem: CoalitionProblem) -> Schedule:
    """Return room for a plan and its times."""
    tasks, robots = len(problem.needs), len(problem.counts)
    end = np.concatenate([np.zeros(tasks, np.int64), problem.ready])
    charged = (tasks + 1, robots) if are_charged(problem.batteries) else (0, 0)
    return Schedule(
        plan=empty_plan(problem),
        rank=np.arange(tasks, dtype=np.int32),
        last=np.zeros((tasks + 1, robots), np.int32),
        left=np.zeros(charged, np.int64),
        start=np.zeros(tasks, np.int64),
        end=end,
        total=np.zeros(5, np.int64),
    )


@entry
def time_plan(problem: CoalitionProblem, schedule: Schedule) -> None:
    """Work out the times of the plan that stands, and what it costs."""
    stand_at_start(problem, schedule)
    for position in range(len(schedule.rank)):
        time_one(problem, schedule, position)
    sum_up(problem, schedule)


@kernel
def stand_at_start(problem: CoalitionProblem, schedule: Schedule) -> None:
    """Have all robots where they start, with what they have left there."""
    for robot in range(len(problem.origin)):
        schedule.last[0, robot] = problem.origin[robot]
        if is_charged(problem):
            schedule.left[0, robot] = problem.batteries.left[robot]


def schedule_of(problem: CoalitionProblem, plan: CoalitionPlan) -> Schedule:
    """Return a plan with its times."""
    schedule = empty_schedule(problem)
    copy_plan(plan, schedule.plan)
    time_plan(problem, schedule)
    return schedule


@kernel
def time_one(problem: CoalitionProblem, schedule: Schedule, position: int) -> None:
    """Time the task at a position of the order."""
    task, last, end = schedule.plan.order[position], schedule.last, schedule.end
    start, there, comes_apart = released(problem, end, task), 0, False
    slower, room, first = 0, 0, NOBODY
    copy_row(last, position, position + 1)
    if is_charged(problem):
        copy_row(schedule.left, position, position + 1)
    for seat in range(schedule.plan.size[task]):
        robot = schedule.plan.coalition[task, seat]
        place = last[position, robot]
        last[position + 1, robot] = task
        if robot >= problem.bodies:
            room = max(room, end[place])
            continue
        there = max(there, arrival(problem, schedule, robot, task, position))
        first = place if first == NOBODY else first
        comes_apart |= problem.site[place] != problem.site[first]
        slower = max(slower, problem.slower[problem.pace[robot], task])
    crew, size = schedule.plan.coalition[task], schedule.plan.size[task]
    takes = problem.duration[task] + slower
    if comes_apart and problem.forming[0] > 0:
        there = fits_all(problem.rotas, problem.kind, crew, size, there, problem.forming[0])
        there += problem.forming[0]
    start = fits_all(problem.rotas, problem.kind, crew, size, max(start, there, room), takes)
    if size == 0:
        start = LEFT_OUT
    schedule.rank[task] = position
    schedule.start[task] = start
    end[task] = start + takes
    if is_charged(problem):
        for seat in range(size):
            _spend(problem, schedule, crew[seat], task, position)


@kernel
def is_charged(problem: CoalitionProblem) -> bool:
    """Say whether anybody has a battery."""
    return len(problem.batteries.lasts) > 0


@kernel
def _spend(
    problem: CoalitionProblem, schedule: Schedule, robot: int, task: int, position: int
) -> None:
    """Take from a battery what a task takes its robot that has been timed, with way and waiting."""
    batteries, kind, start = problem.batteries, problem.kind[robot], schedule.start[task]
    comes, left = _come_charged(problem, schedule, robot, task, position)
    waits = in_ticks(batteries.waiting[kind] * worked(problem.rotas, kind, comes, start))
    carried = schedule.end[task] - start - batteries.services[task]
    left -= waits + batteries.serves[kind, task] + max(0, carried)
    schedule.left[position + 1, robot] = left


@kernel
def _come_charged(
    problem: CoalitionProblem, schedule: Schedule, robot: int, task: int, position: int
) -> tuple[int, int]:
    """Return when a robot can be at a task, charged if it has to be, and what it has left then."""
    batteries, kind, pace = problem.batteries, problem.kind[robot], problem.pace[robot]
    place = schedule.last[position, robot]
    wanted = batteries.spends[kind, task] + batteries.nearest[pace, task]
    free, left = schedule.end[place], schedule.left[position, robot]
    way = problem.ways[pace, place, task]
    comes, left, _ = go_charged(
        batteries, problem.rotas, kind, pace, place, free, left, task, way, wanted
    )
    return comes, left


@kernel
def arrival(
    problem: CoalitionProblem, schedule: Schedule, robot: int, task: int, position: int
) -> int:
    """Return when a robot can be at a task that is done at a position of the order.

    It charges before if it has to.
    """
    if is_charged(problem):
        comes, _ = _come_charged(problem, schedule, robot, task, position)
        return comes
    place = schedule.last[position, robot]
    way = problem.ways[problem.pace[robot], place, task]
    return walked(problem.rotas, problem.kind[robot], schedule.end[place], way)


@kernel
def copy_row(table: Array, row: int, into: int) -> None:
    """Copy a row of a table over another; slices of one array would be copied twice."""
    for column in range(table.shape[1]):
        table[into, column] = table[row, column]


@kernel
def released(problem: CoalitionProblem, end: Array, task: int) -> int:
    """Return when a task may start, whoever is there."""
    start = problem.release[task]
    if problem.before[task, 0] != NOBODY:
        for other in problem.before[task]:
            if other == NOBODY:
                break
            start = max(start, end[other])
    return start


@kernel
def sum_up(problem: CoalitionProblem, schedule: Schedule) -> None:
    """Work out the makespan and the cost of a plan that is timed."""
    total, tasks, robots = schedule.total, len(schedule.rank), len(problem.origin)
    total[MAKESPAN] = total[BACK_SUM] = total[LATE] = total[MISSED] = 0
    leads = 0
    for robot in range(robots):
        back = _back_of(problem, schedule, robot)
        total[BACK_SUM] += back
        total[MAKESPAN] = max(total[MAKESPAN], back)
    for task in range(tasks):
        if len(problem.misses.until) > 0 and schedule.end[task] > problem.misses.until[0]:
            total[MISSED] += problem.misses.judged[task]
            leads += problem.misses.leads[task]
        else:
            total[LATE] += max(0, schedule.end[task] - problem.due[task])
    total[COST] = cost_of(total[MAKESPAN], total[BACK_SUM], total[LATE], robots) + leads


@kernel
def _back_of(problem: CoalitionProblem, schedule: Schedule, robot: int) -> int:
    """Return when a robot is home after all its tasks."""
    tasks, kind, pace = len(schedule.rank), problem.kind[robot], problem.pace[robot]
    place = schedule.last[tasks, robot]
    free, home = schedule.end[place], problem.home[kind, place]
    if is_charged(problem):
        back, _, _ = go_charged(
            problem.batteries, problem.rotas, kind, pace, place, free,
            schedule.left[tasks, robot], tasks, home, 0,
        )  # fmt: skip
        return back
    return walked(problem.rotas, kind, free, home)


@kernel
def cost_of(makespan: int, back_sum: int, late: int, robots: int) -> int:
    """Return what a plan costs, in ticks."""
    return makespan + back_sum // (SPREAD * robots) + LATENESS * late
