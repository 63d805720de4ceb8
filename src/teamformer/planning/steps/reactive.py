"""Plans without search: by the rule of the task that can begin soonest, and by its futures."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from teamformer.base.kernels.jit import entry, kernel
from teamformer.mission.coordination import Known, Plan
from teamformer.planning.dispatch.futures import (
    Calls,
    begin_dispatch,
    do_not_put_back,
    empty_calls,
    leg_of,
    play_out,
    put_back,
    take_back,
)
from teamformer.planning.problem.coalition_plan import copy_plan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, CoalitionProblem
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.schedule import Schedule, empty_schedule
from teamformer.planning.step_times.groups import empty_groups
from teamformer.planning.step_times.passing import settle
from teamformer.planning.steps.arc_search import pose_steps
from teamformer.planning.steps.shared_plan import kept_plan
from teamformer.planning.steps.situation import Situation, plan_of, situation_of
from teamformer.planning.steps.timed_plan import time_team_plan

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.relaxed_problem import Relaxed
    from teamformer.planning.step_times.crossings import Crossings
    from teamformer.planning.step_times.groups import Groups

FUTURES, FUTURES_AGAIN = 1000, 300
"""How many futures are played at the start, and after news."""

MANY_TASKS = 50
"""With more tasks left than this fewer are played, once at the least: a future takes longer."""


def soonest_plan(known: Known) -> Plan:
    """Return who does each task that is possible now: the task that can begin soonest comes next.

    It is done by whoever is there first, none of them spare.
    """
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    situation = _present(known)
    plan = soonest_in(situation)
    if can_miss(situation.problem.misses):
        plan = time_team_plan(situation, plan).plan
    return replace(plan_of(situation, plan), made_from="soonest")


def soonest_in(situation: Situation) -> CoalitionPlan:
    """Return the plan by that rule of what is left of a mission, a situation with a table of ways.

    It counts with shifts.
    """
    problem, schedule = pose_present(situation)
    play_out(problem, schedule, empty_calls(problem, 0), 0)
    return schedule.plan


def reactive_plan(known: Known, old: Plan | None) -> Plan:
    """Return the best of what is left of an old plan and of many futures by the rule `soonest`.

    They are judged by when everything is really done, forming counted. The random numbers come
    from the step, so all robots find the same plan.
    """
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    situation = _present(known)
    future = future_of_present(situation, known.step)
    problem = future.problem
    best, kept, futures = empty_plan(problem), (NEVER, NEVER), FUTURES
    if old is not None and old.order:
        timed = time_team_plan(situation, kept_plan(situation, old))
        best.order[:], best.size[:] = timed.plan.order, timed.plan.size
        best.coalition[:, : timed.plan.coalition.shape[1]] = timed.plan.coalition
        kept, futures = timed.rank, FUTURES_AGAIN
    few = min(1.0, (MANY_TASKS / len(situation.tasks)) ** 2)
    count = max(1, int(futures * few))
    found = best_future_in_steps(future, best, *kept, count, leg_of(problem))
    made_from = "futures" if found < kept else "kept"
    if can_miss(problem.misses):
        best = time_team_plan(situation, best).plan
    return replace(plan_of(situation, best), made_from=made_from)


def _present(known: Known) -> Situation:
    return situation_of(replace(known, open_tasks=known.possible_tasks))


def pose_present(situation: Situation) -> tuple[CoalitionProblem, Schedule]:
    """Return the present as a coalition problem, and a schedule in which nothing is done yet."""
    problem = pose_steps(situation, np.arange(len(situation.robots)), riders=0)
    problem = problem._replace(forming=problem.forming * TICKS)
    schedule = empty_schedule(problem)
    begin_dispatch(problem, schedule)
    return problem, schedule


class FutureInSteps(NamedTuple):
    """What is given out so far of a mission in steps, and what futures of it are timed in."""

    problem: CoalitionProblem
    schedule: Schedule
    calls: Calls
    relaxed: Relaxed
    crossings: Crossings
    groups: Groups
    timed: CoalitionPlan  # room for the plan of a future


def future_of_present(situation: Situation, seed: int) -> FutureInSteps:
    """Return a situation in which nothing is given out yet."""
    problem, schedule = pose_present(situation)
    return FutureInSteps(
        problem,
        schedule,
        empty_calls(problem, seed),
        situation.problem,
        situation.crossings,
        empty_groups(situation.problem, situation.company, situation.forming_steps),
        empty_plan(problem),
    )


@entry
def best_future_in_steps(
    future: FutureInSteps, best: CoalitionPlan, cost: int, lead: int, futures: int, leg: int
) -> tuple[int, int]:
    """Play futures; return what the best one is compared by.

    That is what it costs, and then what leads a search, as with `TimedPlan`. It is left in `best`
    if it is better than `cost` and `lead`. The first future is the rule's own.
    """
    do_not_put_back(future.calls)
    for turn in range(futures):
        if turn > 0:
            put_back(future.calls, leg)
        is_whole, found, leads = _play_and_time(future, 0)
        if is_whole and (found < cost or (found == cost and leads < lead)):
            copy_plan(future.timed, best)
            cost, lead = found, leads
    return cost, lead


@entry
def mean_future_in_steps(future: FutureInSteps, position: int, futures: int, leg: int) -> float:
    """Return what leads a search of futures from a position on, on average; NEVER if none ends."""
    total = 0.0
    for _ in range(futures):
        put_back(future.calls, leg)
        is_whole, _, lead = _play_and_time(future, position)
        if not is_whole:
            return float(NEVER)
        total += lead
    return total / futures


@kernel
def _play_and_time(future: FutureInSteps, position: int) -> tuple[bool, Any, Any]:
    """Play a future from a position on; say if all is done in it, what it costs and what leads."""
    schedule, found, leads = future.schedule, np.int64(0), np.int64(0)
    is_whole = play_out(future.problem, schedule, future.calls, position)
    if is_whole:
        copy_plan(schedule.plan, future.timed)
        found, leads = settle(future.relaxed, future.crossings, future.timed, future.groups)
    take_back(schedule, position)
    return is_whole, found, leads
