"""A plan of teams with the steps in which it really happens: what is passed is done on the way."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from teamformer.base.array_types import Array
from teamformer.planning.problem.coalition_plan import CoalitionPlan, keep_order
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.relaxed_problem import Relaxed, has_prices
from teamformer.planning.step_times.groups import empty_groups
from teamformer.planning.step_times.passing import settle
from teamformer.planning.steps.situation import Situation
from teamformer.world.rules.constants import FAR, NOBODY


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
        return int(self.ends[self.ends < FAR].max(initial=0))


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
        size = timed.plan.size.copy()
        size[late] = 0
        timed = _time(situation, timed.plan._replace(size=without_followers(problem.before, size)))
    missed = int(problem.misses.judged[_missed(problem, timed)].sum())
    return replace(timed, missed=missed)


def _missed(problem: Relaxed, timed: TimedPlan, is_planned: bool = False) -> list[int]:
    """Return the tasks that a plan misses; if `is_planned`, those of the optional ones it has."""
    is_missed = timed.ends > problem.misses.until
    if is_planned:
        is_missed &= (timed.plan.size > 0) & (problem.misses.optional > 0)
    return [int(task) for task in np.flatnonzero(is_missed)]


def without_followers(before: Array, size: Array) -> Array:
    """Return the sizes of coalitions (tasks,) with 0 for all that come after one that has 0."""
    left = size.copy()
    for _ in left:
        waits = [task for task, row in enumerate(before) for other in row
                 if other != NOBODY and left[other] == 0 and left[task] > 0]  # fmt: skip
        if not waits:
            break
        left[waits] = 0
    return left


def _time(situation: Situation, plan: CoalitionPlan) -> TimedPlan:
    problem = situation.problem
    groups = empty_groups(problem, situation.company, situation.forming_steps)
    own = CoalitionPlan(*(array.copy() for array in plan))
    own.order[:] = keep_order(problem.before, own.order.tolist())
    cost, lead = settle(problem, situation.crossings, own, groups)
    ends = groups.end[: len(problem.appears)].copy()
    return TimedPlan(own, int(cost), int(lead), ends, has_prices(problem))
