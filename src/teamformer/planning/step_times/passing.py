"""Writes what is done on the way into a plan, so that nobody is sent to it in vain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.step_times.timing import is_settled, time_plan
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.relaxed_problem import Relaxed
    from teamformer.planning.step_times.crossings import Crossings
    from teamformer.planning.step_times.groups import Groups

ROUNDS = 20
"""How often a plan is timed anew until nothing in it is done by others than planned."""


@entry
def settle(
    problem: Relaxed, crossings: Crossings, plan: CoalitionPlan, groups: Groups
) -> tuple[Any, Any]:
    """Time a plan and give all tasks to those who do them; return what `time_plan` does."""
    cost, lead = time_plan(problem, crossings, plan, groups)
    for _ in range(ROUNDS):
        if is_settled(groups):
            break
        _hand_over(plan, groups)
        cost, lead = time_plan(problem, crossings, plan, groups)
    return cost, lead


@kernel
def _hand_over(plan: CoalitionPlan, groups: Groups) -> None:
    """Put every task that was passed before the one that its doers went to, or after if there.

    Groups are followed as they were when the plan was timed, whoever is handed a task.
    """
    tasks, stolen = len(plan.order), groups.too_early[0]
    was_visited = stolen != NOBODY and groups.passed_to[stolen] == NOBODY
    if stolen != NOBODY:
        groups.passed_to[stolen] = groups.too_early[1]
        groups.passed_from[stolen] = groups.too_early[2]
        groups.start[stolen] = groups.too_early[3]
    for robot in range(len(groups.of)):
        groups.of[robot] = tasks + groups.company[robot]
    filled = 0
    for position in range(tasks):
        task = plan.order[position]
        passed_to = groups.passed_to[task]
        if task == stolen:
            if was_visited:
                _follow(plan, groups, task)
        elif passed_to == NOBODY:
            spares = _list_spares(plan, groups, task)
            filled = _place_passed(plan, groups, task, filled, False)
            groups.moved[filled] = task
            filled += 1
            _follow(plan, groups, task)
            filled = _place_passed(plan, groups, task, filled, True)
            _leave_out(plan, groups, task, spares)
        elif passed_to == stolen:  # nobody is on the way to that any more
            groups.moved[filled] = task
            filled += 1
    _sort_by_start(plan, groups)


@kernel
def _follow(plan: CoalitionPlan, groups: Groups, task: int) -> None:
    for seat in range(plan.size[task]):
        groups.of[plan.coalition[task, seat]] = task


@kernel
def _sort_by_start(plan: CoalitionPlan, groups: Groups) -> None:
    """Order the tasks in `groups.moved` by their starts, of equals as they are."""
    for position in range(len(plan.order)):
        task, gap = groups.moved[position], position
        while gap > 0 and groups.start[plan.order[gap - 1]] > groups.start[task]:
            plan.order[gap] = plan.order[gap - 1]
            gap -= 1
        plan.order[gap] = task


@kernel
def _list_spares(plan: CoalitionPlan, groups: Groups, task: int) -> int:
    """List in `groups.spares` the robots that a group can spare; return how many."""
    count = 0
    if task == groups.spare[0]:
        for seat in range(plan.size[task]):
            if groups.of[plan.coalition[task, seat]] == groups.spare[1]:
                groups.spares[count] = plan.coalition[task, seat]
                count += 1
    return count


@kernel
def _leave_out(plan: CoalitionPlan, groups: Groups, task: int, spares: int) -> None:
    """Take the robots in `groups.spares` out of a coalition."""
    kept = 0
    for seat in range(plan.size[task]):
        robot, is_spare = plan.coalition[task, seat], False
        for place in range(spares):
            is_spare |= groups.spares[place] == robot
        if not is_spare:
            plan.coalition[task, kept] = robot
            kept += 1
    plan.size[task] = kept


@kernel
def _place_passed(
    plan: CoalitionPlan, groups: Groups, task: int, filled: int, is_there: bool
) -> int:
    """Place what was passed on the way to a task, or what is where it is; return the next place."""
    begin = filled
    for other in range(len(plan.order)):
        if groups.passed_to[other] != task or (groups.passed_from[other] == task) != is_there:
            continue
        gap = filled
        while gap > begin and groups.start[groups.moved[gap - 1]] > groups.start[other]:
            groups.moved[gap] = groups.moved[gap - 1]
            gap -= 1
        groups.moved[gap] = other
        filled += 1
        plan.size[other] = 0
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            if groups.of[robot] == groups.passed_from[other]:
                plan.coalition[other, plan.size[other]] = robot
                plan.size[other] += 1
    return filled
