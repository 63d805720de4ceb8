"""Two robots of a kind exchange all that they do from a place of the order on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.jit import kernel
from teamformer.planning.coalitions.problem import NOBODY
from teamformer.planning.coalitions.search.schedule import (
    COST,
    hang_tails,
    leave,
    time_from,
)
from teamformer.planning.relaxation.insertion import draw_below

if TYPE_CHECKING:
    from teamformer.planning.coalitions.problem import CoalitionProblem
    from teamformer.planning.coalitions.search.schedule import CoalitionPlan, Schedule
    from teamformer.planning.coalitions.search.window import Desk


@kernel
def exchange_tails(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, limit: int, allowed: int
) -> bool:
    """Try it at a random place; say whether the plan has changed."""
    plan, last = schedule.plan, schedule.last
    task = plan.order[draw_below(desk.random, len(plan.order))]
    robot = plan.coalition[task, draw_below(desk.random, plan.size[task])]
    like, count = problem.like[problem.kind[robot]], 0
    while like[count] != NOBODY:
        count += 1
    other, position = like[draw_below(desk.random, count)], schedule.rank[task]
    if other == robot or schedule.next[position, other] == task:
        return False
    for one, two in ((robot, other), (other, robot)):
        place = last[position, one]
        if schedule.end[place] + leave(problem, schedule, two, place, position) > limit:
            return False
    _exchange(plan, position, robot, other)
    time_from(problem, schedule, position)
    if schedule.total[COST] > allowed:
        _exchange(plan, position, robot, other)
        time_from(problem, schedule, position)
        return False
    hang_tails(problem, schedule, len(plan.order) - 1)
    return True


@kernel
def _exchange(plan: CoalitionPlan, position: int, robot: int, other: int) -> None:
    for later in range(position, len(plan.order)):
        task = plan.order[later]
        for seat in range(plan.size[task]):
            if plan.coalition[task, seat] == robot:
                plan.coalition[task, seat] = other
            elif plan.coalition[task, seat] == other:
                plan.coalition[task, seat] = robot
