"""The reactive rule: what to do next is said by the best of many futures, task after task.

Nothing is searched. How would a simple rule (what can begin soonest) go on from here, played out a
few times with some noise? The next task is the first of the best future that anybody has seen so
far (fortified rollouts, Bertsekas and others 1997). Everybody knows what all robots have promised.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import entry, kernel
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
from teamformer.planning.dispatch.groups import are_linked, time_again
from teamformer.planning.dispatch.worth import worth
from teamformer.planning.problem.coalition_plan import copy_plan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, CoalitionProblem
from teamformer.planning.problem.links import have_weights
from teamformer.planning.problem.schedule import (
    COST,
    MAKESPAN,
    empty_schedule,
    schedule_of,
    sum_up,
)
from teamformer.planning.search.arc_search import ArcSearch

if TYPE_CHECKING:
    from teamformer.planning.dispatch.futures import Calls
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.schedule import Schedule

FUTURES = 200
"""How many futures are played for each decision."""

MANY_TASKS = 20
"""With more tasks than this fewer are played, once at the least: a future takes longer then."""


def react(problem: CoalitionProblem, start: CoalitionPlan | None = None) -> Solution | None:
    """Return what comes of the rule; None if some task cannot be done by all robots together.

    After news `start` is what is left of the plan before: it stays unless a future is better.
    """
    schedule, best, calls = empty_schedule(problem), empty_plan(problem), empty_calls(problem, 0)
    tasks = len(problem.needs)
    futures = max(1, min(FUTURES, FUTURES * MANY_TASKS**2 // max(1, tasks) ** 2))
    least = float(NEVER)
    if start is not None:
        copy_plan(start, best)
        least = worth_of(problem, schedule, best)
    if not _react(problem, schedule, best, calls, futures, leg_of(problem), least):
        return _where_linked(problem)
    return solution_of(problem, best)


def dispatch(problem: CoalitionProblem) -> Solution | None:
    """Return what the rule `soonest` itself comes to; None if some task cannot be done."""
    plan = first_plan(problem)
    return _where_linked(problem) if plan is None else solution_of(problem, plan)


def _where_linked(problem: CoalitionProblem) -> Solution | None:
    """Return a first plan where the rule leaves nobody for a linked task; None if there is none."""
    if not have_weights(problem.links):
        return None
    search = ArcSearch(problem, 0)
    return solution_of(problem, search.best) if search.begin_anew() else None


def solution_of(problem: CoalitionProblem, plan: CoalitionPlan) -> Solution:
    """Return a plan with what it comes to."""
    total = schedule_of(problem, plan).total
    return Solution(plan, (int(total[MAKESPAN]), int(total[COST])))


@entry
def worth_of(problem: CoalitionProblem, schedule: Schedule, plan: CoalitionPlan) -> float:
    """Return what a plan comes to; all tasks are open again afterwards."""
    begin_dispatch(problem, schedule)
    for position in range(len(schedule.rank)):
        have_done_as_in(problem, schedule, plan, position)
    found = worth(problem, schedule)
    take_back(schedule, 0)
    return found


@entry
def _react(
    problem: CoalitionProblem,
    schedule: Schedule,
    best: CoalitionPlan,
    calls: Calls,
    futures: int,
    leg: int,
    least: float,
) -> bool:
    """Decide task after task; say whether every task has found a coalition.

    `best` is the best future seen so far, which comes to `least`: its beginning is what was
    decided.
    """
    begin_dispatch(problem, schedule)
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
    least: float,
) -> float:
    """Play futures from a position on; return what the best comes to, NEVER if nobody can do a
    task and there is none.

    It is left in `best` if it comes to less than `least`. The first of all is the rule's own.
    """
    do_not_put_back(calls)
    for turn in range(futures):
        if position + turn > 0:
            put_back(calls, leg)
        if play_out(problem, schedule, calls, position):
            found = worth(problem, schedule)
            if found < least:
                copy_plan(schedule.plan, best)
                least = found
        _open_again(problem, schedule, position)
    return least


@kernel
def _open_again(problem: CoalitionProblem, schedule: Schedule, position: int) -> None:
    """Take back what was given out from a position on, and what it has held of linked tasks."""
    take_back(schedule, position)
    if are_linked(problem):
        time_again(problem, schedule, position)


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
