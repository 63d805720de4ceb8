"""Plans with forming counted: who does each task, in what order, and when that makes it done.

Robots that have done a task together are a group and stay one as long as they go the same way. A
group whose robots part pays one forming for each further way, the way of the earlier task first.
Groups that meet at a task pair up there, one joining a step, until they are one team. So robots
that travel along cost nothing, and any order with any able coalitions is a plan that cannot block.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from teamformer.jit import entry, kernel
from teamformer.planning.relaxation.plan import Array
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.rules.constants import NOBODY

LATE = 1e6
"""Steps of makespan that a robot lost before its task's end is worth."""

SPREAD = 0.15
"""Steps of makespan that a step of the mean of all ends is worth: it leads out of plateaus."""


class TeamPlan(NamedTuple):
    """Which tasks are done in what order, by whom."""

    order: Array  # (tasks,)
    coalition: Array  # (tasks, robots) the first `size` of them, travellers along included
    size: Array  # (tasks,)


class Groups(NamedTuple):
    """Room to time a plan in; a group has the number of its last task, or tasks + its leader."""

    company: Array  # (robots,) the lowest robot of its starting team
    forming: Array  # (1,) steps that a split costs
    of: Array  # (robots,) group
    left: Array  # (robots,) tasks that are still to come
    end: Array  # (groups,) the step in which its last task was done
    busy: Array  # (groups,) robots in it that still have tasks to come
    splits: Array  # (groups,)
    pace: Array  # (groups,) the slowest of those that leave together
    seen: Array  # (groups,) the last task that it took part in
    touched: Array  # (robots,) groups that take part in the task at hand
    arrive: Array  # (robots,) when they get there
    before: Array  # (tasks,) the task that its last group came from, or NOBODY


def empty_team_plan(problem: Relaxed) -> TeamPlan:
    """Return a plan in which nobody does anything."""
    tasks, robots = len(problem.appears), len(problem.pace)
    return TeamPlan(
        np.arange(tasks, dtype=np.int32),
        np.full((tasks, robots), NOBODY, np.int32),
        np.zeros(tasks, np.int32),
    )


def plan_teams(
    problem: Relaxed, order: Sequence[int], coalitions: Sequence[Sequence[int]]
) -> TeamPlan:
    """Return a plan as arrays; `coalitions` holds the robots of each task, by its number."""
    plan = empty_team_plan(problem)
    plan.order[:] = order
    for task, coalition in enumerate(coalitions):
        plan.size[task] = len(coalition)
        plan.coalition[task, : len(coalition)] = coalition
    return plan


def empty_groups(
    problem: Relaxed, starting_teams: Sequence[Sequence[int]], forming_steps: int
) -> Groups:
    """Return room to time plans of a fleet in."""
    tasks, robots = len(problem.appears), len(problem.pace)
    company = np.arange(robots, dtype=np.int32)
    for team in starting_teams:
        company[list(team)] = min(team)
    groups = tasks + robots
    return Groups(
        company=company,
        forming=np.array([forming_steps], np.int32),
        of=np.zeros(robots, np.int32),
        left=np.zeros(robots, np.int32),
        end=np.zeros(groups, np.int32),
        busy=np.zeros(groups, np.int32),
        splits=np.zeros(groups, np.int32),
        pace=np.zeros(groups, np.int32),
        seen=np.zeros(groups, np.int32),
        touched=np.zeros(robots, np.int32),
        arrive=np.zeros(robots, np.int32),
        before=np.zeros(tasks, np.int32),
    )


def routes_of(plan: TeamPlan, robots: int) -> list[list[int]]:
    """Return each robot's tasks in order."""
    routes: list[list[int]] = [[] for _ in range(robots)]
    for task in plan.order.tolist():
        for robot in plan.coalition[task, : plan.size[task]].tolist():
            routes[robot].append(task)
    return routes


def overwrite_team_plan(plan: TeamPlan, into: TeamPlan) -> None:
    """Overwrite a plan with another."""
    for array, kept in zip(plan, into, strict=True):
        kept[:] = array


@kernel
def copy_team_plan(plan: TeamPlan, into: TeamPlan) -> None:
    """Overwrite a plan with another, in kernels: loops compile sooner than whole arrays."""
    for place in range(len(plan.order)):
        into.order[place] = plan.order[place]
        into.size[place] = plan.size[place]
        for seat in range(plan.coalition.shape[1]):
            into.coalition[place, seat] = plan.coalition[place, seat]


@entry
def time_plan(problem, plan, groups):  # type: ignore[no-untyped-def]
    """Return the cost of a plan and the step in which its last task is done.

    Leaves each task's end in `groups.end` and the task it waited for in `groups.before`.
    """
    _gather_at_start(problem, plan, groups)
    tasks = len(plan.order)
    makespan, total, late = 0, 0, 0
    for position in range(tasks):
        task = plan.order[position]
        end = _meet(problem, plan, groups, task) + problem.duration[task]
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            late += end >= problem.lost[robot]
            groups.left[robot] -= 1
            groups.busy[task] += groups.left[robot] > 0
            groups.of[robot] = task
        groups.end[task] = end
        makespan = max(makespan, end)
        total += end
    return makespan + SPREAD * total / tasks + LATE * late, makespan


@kernel
def _gather_at_start(problem, plan, groups):  # type: ignore[no-untyped-def]
    tasks = len(plan.order)
    for group in range(len(groups.end)):
        groups.end[group] = groups.busy[group] = groups.splits[group] = 0
        groups.seen[group] = NOBODY
    for robot in range(len(groups.of)):
        groups.left[robot] = 0
        groups.of[robot] = tasks + groups.company[robot]
    for task in range(tasks):
        for seat in range(plan.size[task]):
            groups.left[plan.coalition[task, seat]] += 1
    for robot in range(len(groups.of)):
        groups.busy[groups.of[robot]] += groups.left[robot] > 0


@kernel
def _meet(problem, plan, groups, task):  # type: ignore[no-untyped-def]
    """Bring a task's coalition together; return the step in which it is one team there."""
    tasks, count = len(plan.order), 0
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        group = groups.of[robot]
        if groups.seen[group] != task:
            groups.seen[group] = task
            groups.pace[group] = problem.pace[robot]
            groups.touched[count] = group
            count += 1
        groups.pace[group] = min(groups.pace[group], problem.pace[robot])
        groups.busy[group] -= 1
    latest = -1
    for place in range(count):
        group = groups.touched[place]
        groups.splits[group] += groups.busy[group] > 0
        leave = groups.end[group] + groups.splits[group] * groups.forming[0]
        arrival = leave + problem.steps[groups.pace[group], problem.cells[task, group]]
        if arrival > latest:
            latest = arrival
            groups.before[task] = group if group < tasks else NOBODY
        gap = place
        while gap > 0 and groups.arrive[gap - 1] > arrival:
            groups.arrive[gap] = groups.arrive[gap - 1]
            gap -= 1
        groups.arrive[gap] = arrival
    return max(_pair_up(groups.arrive, count), problem.appears[task] + 1)


@kernel
def _pair_up(arrive, count):  # type: ignore[no-untyped-def]
    """Return when teams that arrive in turn are one: in each step all that are there pair up."""
    if count == 0:
        return 0
    step, here, come = arrive[0], 0, 0
    while True:
        while come < count and arrive[come] <= step:
            here += 1
            come += 1
        if here > 1:
            here = (here + 1) // 2
            step += 1
        elif come < count:
            step = arrive[come]
        else:
            return step
