"""The reactive rule: whoever is free first decides what to do next, and calls a coalition for it.

Nothing is searched. A robot that is free looks at each task that it can help with: how would a
simple rule (what can start first) go on from there, played out a few times with some noise? It
takes the task of the best future that anybody has seen so far (fortified rollouts, Bertsekas and
others 1997). It knows what all robots have promised, and binds nobody beyond its own task.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.dispatch.coalition_choice import arrival, cover, empty_workspace, give_way
from teamformer.planning.dispatch.first_plan import is_ready
from teamformer.planning.problem.coalition_plan import copy_plan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.schedule import (
    COST,
    MAKESPAN,
    empty_schedule,
    schedule_of,
    sum_up,
    time_one,
)
from teamformer.world.rules.chance import draw_below
from teamformer.world.rules.coverage import helps

if TYPE_CHECKING:
    from teamformer.planning.dispatch.coalition_choice import Workspace
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.schedule import Schedule

FUTURES = 20
"""How often the rest is played out for each task that a robot may take."""

MANY_OPEN = 20
"""With more tasks open than this each is played out less often, once at the least: a future takes
longer then, and there are more of them."""

FARTHEST = 10**11
"""Ticks that no way takes; where there is none, it takes longer (`continuous_mission`)."""


def react(problem: CoalitionProblem) -> Solution | None:
    """Return what comes of the rule; None if some task cannot be done by all robots together."""
    schedule, best, workspace = (
        empty_schedule(problem),
        empty_plan(problem),
        empty_workspace(problem, seed=0),
    )
    leg = int(problem.duration.mean() + np.median(problem.ways))
    if not _react(problem, schedule, best, workspace, FUTURES, leg // 4):
        return None
    total = schedule_of(problem, schedule.plan).total
    return Solution(schedule.plan, (int(total[MAKESPAN]), int(total[COST])))


@entry
def _react(
    problem: CoalitionProblem,
    schedule: Schedule,
    best: CoalitionPlan,
    workspace: Workspace,
    futures: int,
    noise: int,
) -> bool:
    """Decide task after task; say whether every task has found a coalition.

    `best` is the best future seen so far: its beginning is what was decided.
    """
    tasks, least = len(schedule.rank), NEVER
    for robot in range(len(problem.origin)):
        schedule.last[0, robot] = problem.origin[robot]
    _take_back(schedule, 0)
    for position in range(tasks):
        robot = _first_free(problem, schedule, position)
        if robot == NOBODY:
            return False
        most = max(1, min(futures, futures * MANY_OPEN**2 // (tasks - position) ** 2))
        for task in range(tasks):
            if not _helps(problem, schedule, robot, task):
                continue
            for _ in range(most):
                if _call(problem, schedule, workspace, robot, task, position) == NEVER:
                    return False
                _do(problem, schedule, workspace, task, position)
                cost = _play_out(problem, schedule, workspace, position + 1, noise)
                if cost < least:
                    least = cost
                    copy_plan(schedule.plan, best)
                _take_back(schedule, position)
        _do_as_in(problem, schedule, best, position)
    return True


@kernel
def _first_free(problem: CoalitionProblem, schedule: Schedule, position: int) -> int:
    """Return the robot that is free first of those that can help with an open task."""
    best = NOBODY
    for robot in range(len(problem.origin)):
        free = schedule.end[schedule.last[position, robot]]
        if best == NOBODY or free < schedule.end[schedule.last[position, best]]:
            for task in range(len(schedule.rank)):
                if _helps(problem, schedule, robot, task):
                    best = robot
                    break
    return best


@kernel
def _helps(problem: CoalitionProblem, schedule: Schedule, robot: int, task: int) -> bool:
    """Say whether a task is open, all before it are promised, and a robot brings some of it there.

    Who has no way to a task must not call others to it.
    """
    if not is_ready(problem, schedule, task):
        return False
    if problem.ways[problem.pace[robot], problem.origin[robot], task] > FARTHEST:
        return False
    return helps(problem.counts[robot], problem.needs[task])


@kernel
def _call(
    problem: CoalitionProblem,
    schedule: Schedule,
    workspace: Workspace,
    robot: int,
    task: int,
    position: int,
) -> int:
    """Pick a coalition around a robot; return when it is there, NEVER if there is none.

    What a load takes longer with it is added. Who would slow the load down need not be in it.
    """
    workspace.pick[0] = robot
    workspace.picks[0] = problem.slower[problem.pace[robot], task] == 0
    if not cover(problem, schedule, workspace, task, position):
        return NEVER
    give_way(problem, schedule, workspace, task, position)
    start, slower = 0, 0
    for seat in range(workspace.picks[0]):
        picked = workspace.pick[seat]
        start = max(start, arrival(problem, schedule, picked, task, position))
        slower = max(slower, problem.slower[problem.pace[picked], task])
    return start + slower


@kernel
def _do(
    problem: CoalitionProblem, schedule: Schedule, workspace: Workspace, task: int, position: int
) -> None:
    """Have the coalition at hand do a task next."""
    plan = schedule.plan
    plan.order[position] = task
    plan.size[task] = workspace.picks[0]
    for seat in range(workspace.picks[0]):
        plan.coalition[task, seat] = workspace.pick[seat]
    time_one(problem, schedule, position)


@kernel
def _do_as_in(
    problem: CoalitionProblem, schedule: Schedule, best: CoalitionPlan, position: int
) -> None:
    """Have a task done as in the best future seen."""
    plan, task = schedule.plan, best.order[position]
    plan.order[position] = task
    plan.size[task] = best.size[task]
    for seat in range(best.size[task]):
        plan.coalition[task, seat] = best.coalition[task, seat]
    time_one(problem, schedule, position)


@kernel
def _play_out(
    problem: CoalitionProblem, schedule: Schedule, workspace: Workspace, begin: int, noise: int
) -> int:
    """Let robots take what can start first, more or less; return what the plan costs then."""
    tasks = len(schedule.rank)
    for position in range(begin, tasks):
        robot = _first_free(problem, schedule, position)
        if robot == NOBODY:
            return NEVER
        best, least = NOBODY, NEVER
        for task in range(tasks):
            if _helps(problem, schedule, robot, task):
                start = _call(problem, schedule, workspace, robot, task, position)
                start += draw_below(workspace.random, noise + 1)
                if start < least:
                    best, least = task, start
        if best == NOBODY:
            return NEVER
        _call(problem, schedule, workspace, robot, best, position)
        _do(problem, schedule, workspace, best, position)
    sum_up(problem, schedule)
    return schedule.total[COST]


@kernel
def _take_back(schedule: Schedule, position: int) -> None:
    """Open the tasks again that were done from a position on."""
    tasks = len(schedule.rank)
    for task in range(tasks):
        if schedule.rank[task] >= position:
            schedule.rank[task] = tasks
