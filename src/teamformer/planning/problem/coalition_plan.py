"""Plans: who does each task, in what order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array, Int32s
from teamformer.base.kernels.jit import entry
from teamformer.mission.precedence import keep_precedence
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem, without_spares


class CoalitionPlan(NamedTuple):
    """Which tasks are done in what order, by whom."""

    order: Int32s  # (tasks,)
    coalition: Int32s  # (tasks, most) the first `size` of each, who only comes along included
    size: Int32s  # (tasks,)


def empty_plan(problem: CoalitionProblem) -> CoalitionPlan:
    """Return a plan in which nobody does anything."""
    tasks, robots = len(problem.needs), len(problem.counts)
    return CoalitionPlan(
        np.arange(tasks, dtype=np.int32),
        np.full((tasks, robots), NOBODY, np.int32),
        np.zeros(tasks, np.int32),
    )


def plan_of_lists(order: Sequence[int], coalitions: Sequence[Sequence[int]]) -> CoalitionPlan:
    """Return a plan as arrays; `coalitions` holds the robots of each task, by its number."""
    largest = max(map(len, coalitions), default=0)
    plan = CoalitionPlan(
        np.array(order, np.int32),
        np.full((len(coalitions), largest), NOBODY, np.int32),
        np.zeros(len(coalitions), np.int32),
    )
    for task, coalition in enumerate(coalitions):
        plan.size[task] = len(coalition)
        plan.coalition[task, : len(coalition)] = coalition
    return plan


def keep_order(before: Array, order: list[int]) -> list[int]:
    """Return an order in which each task is behind those in its row of `before`."""
    listed = ([other for other in row if other != NOBODY] for row in before.tolist())
    rows = {task: others for task, others in enumerate(listed) if others}
    return keep_precedence(order, rows) if rows else order


def pairs_before(before: Array) -> list[tuple[int, int]]:
    """Return pairs of tasks, the earlier one first; `before` (tasks, most) ends with NOBODY."""
    return [(before[row, place], row) for row, place in np.argwhere(before != NOBODY).tolist()]


def routes_of(plan: CoalitionPlan, robots: int) -> list[list[int]]:
    """Return each robot's tasks in order."""
    routes: list[list[int]] = [[] for _ in range(robots)]
    for task in plan.order.tolist():
        for robot in plan.coalition[task, : plan.size[task]].tolist():
            routes[robot].append(task)
    return routes


@entry
def copy_plan(plan: CoalitionPlan, into: CoalitionPlan) -> None:
    """Overwrite a plan with another."""
    into.order[:] = plan.order
    into.coalition[:] = plan.coalition
    into.size[:] = plan.size


def with_seats(problem: CoalitionProblem, plan: CoalitionPlan, most: int) -> CoalitionPlan:
    """Return a plan in which no task has more than so many robots, but for those that it needs."""
    if (plan.size <= most).all():
        return plan
    seated = CoalitionPlan(plan.order, plan.coalition.copy(), plan.size.copy())
    for task in np.flatnonzero(plan.size > most).tolist():
        kept = without_spares(problem, task, plan.coalition[task, : plan.size[task]].tolist(), most)
        seated.size[task], seated.coalition[task, : len(kept)] = len(kept), kept
    return seated


def without_riders(
    problem: CoalitionProblem, plan: CoalitionPlan, cost_of: Callable[[CoalitionPlan], Any]
) -> CoalitionPlan:
    """Return a plan without the robots that a task can be done without, where it costs no more."""
    if problem.spares == 0:
        return plan
    cost = cost_of(plan)
    for task in plan.order.tolist():
        for robot in plan.coalition[task, : plan.size[task]][::-1].tolist():
            crew = plan.coalition[task, : plan.size[task]]
            rest = crew[crew != robot]
            if (problem.counts[rest].sum(axis=0) < problem.needs[task]).any():
                continue
            fewer = CoalitionPlan(plan.order, plan.coalition.copy(), plan.size.copy())
            fewer.size[task], fewer.coalition[task, : len(rest)] = len(rest), rest
            if cost_of(fewer) <= cost:
                plan, cost = fewer, cost_of(fewer)
    return plan
