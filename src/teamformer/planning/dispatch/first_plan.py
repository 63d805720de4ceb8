"""A first plan: tasks in a random order, each by whoever is there first."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.dispatch.coalition_choice import cover, empty_workspace, give_way
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.schedule import empty_schedule, time_one
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.dispatch.coalition_choice import Workspace
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.coalition_problem import CoalitionProblem
    from teamformer.planning.problem.schedule import Schedule


def draw_plan(problem: CoalitionProblem, seed: int) -> CoalitionPlan | None:
    """Return a plan in a random order; None if some task cannot be done by all robots together."""
    schedule = empty_schedule(problem)
    is_able = construct(problem, schedule, empty_workspace(problem, seed))
    return schedule.plan if is_able else None


@entry
def construct(problem: CoalitionProblem, schedule: Schedule, workspace: Workspace) -> bool:
    """Plan tasks in a random order that precedence allows, each by whoever is there first."""
    order, tasks = schedule.plan.order, len(schedule.plan.order)
    for task in range(tasks):
        schedule.rank[task] = tasks
        schedule.plan.size[task] = 0
    for robot in range(len(problem.origin)):
        schedule.last[0, robot] = problem.origin[robot]
    for position in range(tasks):
        task = _draw_ready(problem, schedule, workspace, tasks)
        order[position] = task
        schedule.rank[task] = position
        workspace.picks[0] = 0
        if not cover(problem, schedule, workspace, task, position):
            return False
        give_way(problem, schedule, workspace, task, position)
        schedule.plan.size[task] = workspace.picks[0]
        for seat in range(workspace.picks[0]):
            schedule.plan.coalition[task, seat] = workspace.pick[seat]
        time_one(problem, schedule, position)
    return True


@kernel
def _draw_ready(
    problem: CoalitionProblem, schedule: Schedule, workspace: Workspace, tasks: int
) -> int:
    """Draw a task that is not planned while all that come before it are."""
    task = draw_below(workspace.random, tasks)
    while not is_ready(problem, schedule, task):
        task = (task + 1) % tasks
    return task


@kernel
def is_ready(problem: CoalitionProblem, schedule: Schedule, task: int) -> bool:
    """Say whether a task is not planned while all that come before it are; others have no rank."""
    tasks = len(schedule.rank)
    if schedule.rank[task] < tasks:
        return False
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if schedule.rank[other] == tasks:
            return False
    return True
