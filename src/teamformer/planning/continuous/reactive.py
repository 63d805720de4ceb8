"""The reactive rule: what to do next is said by the best of many futures, task after task.

Nothing is searched. How would a simple rule (what can begin soonest) go on from here, played out a
few times with some noise? The next task is the first of the best future that anybody has seen so
far (fortified rollouts, Bertsekas and others 1997). Everybody knows what all robots have promised.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import entry
from teamformer.planning.continuous.solve import Solution
from teamformer.planning.dispatch.futures import (
    begin_dispatch,
    do_not_put_back,
    empty_calls,
    first_plan,
    have_done_as_in,
    leg_of,
    play_out,
    put_back,
    take_back,
)
from teamformer.planning.problem.coalition_plan import copy_plan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, CoalitionProblem
from teamformer.planning.problem.schedule import (
    COST,
    MAKESPAN,
    empty_schedule,
    schedule_of,
    sum_up,
)

if TYPE_CHECKING:
    from teamformer.planning.dispatch.futures import Calls
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.schedule import Schedule

FUTURES = 200
"""How many futures are played for each decision."""

MANY_TASKS = 20
"""With more tasks than this fewer are played, once at the least: a future takes longer then."""


def react(problem: CoalitionProblem) -> Solution | None:
    """Return what comes of the rule; None if some task cannot be done by all robots together."""
    schedule, best, calls = empty_schedule(problem), empty_plan(problem), empty_calls(problem, 0)
    tasks = len(problem.needs)
    futures = max(1, min(FUTURES, FUTURES * MANY_TASKS**2 // max(1, tasks) ** 2))
    if not _react(problem, schedule, best, calls, futures, leg_of(problem)):
        return None
    return solution_of(problem, best)


def dispatch(problem: CoalitionProblem) -> Solution | None:
    """Return what the rule `soonest` itself comes to; None if some task cannot be done."""
    plan = first_plan(problem)
    return None if plan is None else solution_of(problem, plan)


def solution_of(problem: CoalitionProblem, plan: CoalitionPlan) -> Solution:
    """Return a plan with what it comes to."""
    total = schedule_of(problem, plan).total
    return Solution(plan, (int(total[MAKESPAN]), int(total[COST])))


@entry
def _react(
    problem: CoalitionProblem,
    schedule: Schedule,
    best: CoalitionPlan,
    calls: Calls,
    futures: int,
    leg: int,
) -> bool:
    """Decide task after task; say whether every task has found a coalition.

    `best` is the best future seen so far: its beginning is what was decided.
    """
    begin_dispatch(problem, schedule)
    least = NEVER
    for position in range(len(schedule.rank)):
        least = best_future(problem, schedule, best, calls, position, futures, leg, least)
        if least == NEVER:
            return False
        have_done_as_in(problem, schedule, best, position)
    return True


@entry
def best_future(
    problem: CoalitionProblem,
    schedule: Schedule,
    best: CoalitionPlan,
    calls: Calls,
    position: int,
    futures: int,
    leg: int,
    least: int,
) -> int:
    """Play futures from a position on; return what the best costs, NEVER if nobody can do a task.

    It is left in `best` if it costs less than `least`. Where nothing costs less yet, the first one
    is the rule's own.
    """
    do_not_put_back(calls)
    for turn in range(futures):
        if least < NEVER or turn > 0:
            put_back(calls, leg)
        if not play_out(problem, schedule, calls, position):
            take_back(schedule, position)
            return NEVER
        sum_up(problem, schedule)
        if schedule.total[COST] < least:
            copy_plan(schedule.plan, best)
            least = schedule.total[COST]
        take_back(schedule, position)
    return least


@entry
def mean_future(
    problem: CoalitionProblem,
    schedule: Schedule,
    calls: Calls,
    position: int,
    futures: int,
    leg: int,
) -> float:
    """Return what futures from a position on cost on average; NEVER if nobody can do a task."""
    total = 0.0
    for _ in range(futures):
        put_back(calls, leg)
        if not play_out(problem, schedule, calls, position):
            take_back(schedule, position)
            return float(NEVER)
        sum_up(problem, schedule)
        total += schedule.total[COST]
        take_back(schedule, position)
    return total / futures
