"""A plan of teams with the steps in which it really happens: what is passed is done on the way."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from teamformer.base.array_types import Array
from teamformer.planning.problem.coalition_plan import CoalitionPlan, keep_order, without_tasks
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.relaxed_problem import Relaxed, has_prices
from teamformer.planning.step_times.groups import empty_groups
from teamformer.planning.step_times.passing import settle
from teamformer.planning.steps.situation import Situation


@dataclass(frozen=True)
class TimedPlan:
    """A plan whose tasks are given to those who do them, and when they are done.

    `cost` is what plans are judged by, and `lead` the same with what leads a search. `ends`
    (tasks,) are steps, FAR for tasks that are left out, and `has_prices` says that more than the
    makespan counts. `missed` is what is missed of the cost, None if nothing can be.
    """

    plan: CoalitionPlan
    cost: int
    lead: int
    ends: Array
    has_prices: bool = False
    missed: int | None = None

    @property
    def rank(self) -> tuple[int, int]:
        """Return what plans are compared by: what they cost, then what leads a search."""
        return self.cost, self.lead

    @property
    def makespan(self) -> int:
        """Return the step in which the last task is done that is."""
        return int(self.ends[self.plan.size > 0].max(initial=0))


def time_team_plan(situation: Situation, plan: CoalitionPlan) -> TimedPlan:
    """Return a plan with its times, its tasks in an order that keeps precedence.

    Optional tasks that would be missed are left out, and all that come after them. The given plan
    is not changed.
    """
    problem = situation.problem
    timed = _time(situation, plan)
    if not can_miss(problem.misses):
        return timed
    while late := _missed(problem, timed, is_planned=True):
        timed = _time(situation, without_tasks(problem.before, timed.plan, late))
    missed = int(problem.misses.judged[_missed(problem, timed)].sum())
    return replace(timed, missed=missed)


def _missed(problem: Relaxed, timed: TimedPlan, is_planned: bool = False) -> list[int]:
    """Return the tasks that a plan misses; if `is_planned`, those of the optional ones it has."""
    is_missed = timed.ends > problem.misses.until
    if is_planned:
        is_missed &= (timed.plan.size > 0) & (problem.misses.optional > 0)
    return [int(task) for task in np.flatnonzero(is_missed)]


def _time(situation: Situation, plan: CoalitionPlan) -> TimedPlan:
    problem = situation.problem
    groups = empty_groups(problem, situation.company, situation.forming_steps)
    own = CoalitionPlan(*(array.copy() for array in plan))
    own.order[:] = keep_order(problem.before, own.order.tolist())
    cost, lead = settle(problem, situation.crossings, own, groups)
    ends = groups.end[: len(problem.appears)].copy()
    return TimedPlan(own, int(cost), int(lead), ends, has_prices(problem))


def must_come_first(situation: Situation, timed: TimedPlan) -> TimedPlan:
    """Return the better one of a plan and of the same with optional tasks behind all others.

    For those who deal tasks out without a look at when the mission is over.
    """
    misses = situation.problem.misses
    if not can_miss(misses):
        return timed
    order = timed.plan.order[np.argsort(misses.optional[timed.plan.order], kind="stable")]
    other = time_team_plan(situation, timed.plan._replace(order=order))
    return min(timed, other, key=lambda one: one.rank)
