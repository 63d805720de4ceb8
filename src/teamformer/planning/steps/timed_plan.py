"""A plan of teams with the steps in which it really happens: what is passed is done on the way."""

from __future__ import annotations

from dataclasses import dataclass

from teamformer.base.array_types import Array
from teamformer.planning.problem.coalition_plan import CoalitionPlan, keep_order
from teamformer.planning.problem.relaxed_problem import has_prices
from teamformer.planning.step_times.groups import empty_groups
from teamformer.planning.step_times.passing import settle
from teamformer.planning.steps.situation import Situation


@dataclass(frozen=True)
class TimedPlan:
    """A plan whose tasks are given to those who do them, and when they are done.

    `cost` is what plans are judged by, and `lead` the same with what leads a search. `ends`
    (tasks,) are steps, and `has_prices` says that more than the makespan counts.
    """

    plan: CoalitionPlan
    cost: int
    lead: int
    ends: Array
    has_prices: bool = False

    @property
    def rank(self) -> tuple[int, int]:
        """Return what plans are compared by: what they cost, then what leads a search."""
        return self.cost, self.lead

    @property
    def makespan(self) -> int:
        """Return the step in which the last task is done."""
        return int(self.ends.max())


def time_team_plan(situation: Situation, plan: CoalitionPlan) -> TimedPlan:
    """Return a plan with its times, its tasks in an order that keeps precedence.

    The given plan is not changed.
    """
    problem = situation.problem
    groups = empty_groups(problem, situation.company, situation.forming_steps)
    own = CoalitionPlan(*(array.copy() for array in plan))
    own.order[:] = keep_order(problem.before, own.order.tolist())
    cost, lead = settle(problem, situation.crossings, own, groups)
    ends = groups.end[: len(problem.appears)].copy()
    return TimedPlan(own, int(cost), int(lead), ends, has_prices(problem))
