"""Plans of teams: who does each task, in what order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.relaxation.relaxed_plan import Array
from teamformer.rules.constants import NOBODY


class TeamPlan(NamedTuple):
    """Which tasks are done in what order, by whom."""

    order: Array  # (tasks,)
    coalition: Array  # (tasks, robots) the first `size` of them, travellers along included
    size: Array  # (tasks,)


def empty_team_plan(problem: Relaxed) -> TeamPlan:
    """Return a plan in which nobody does anything."""
    tasks, robots = len(problem.appears), len(problem.pace)
    return TeamPlan(
        np.arange(tasks, dtype=np.int32),
        np.full((tasks, robots), NOBODY, np.int32),
        np.zeros(tasks, np.int32),
    )


def plan_teams(
    problem: Relaxed, order: Sequence[int], coalitions: Sequence[Sequence[int]]
) -> TeamPlan:
    """Return a plan as arrays; `coalitions` holds the robots of each task, by its number."""
    plan = empty_team_plan(problem)
    plan.order[:] = order
    for task, coalition in enumerate(coalitions):
        plan.size[task] = len(coalition)
        plan.coalition[task, : len(coalition)] = coalition
    return plan


def routes_of(plan: TeamPlan, robots: int) -> list[list[int]]:
    """Return each robot's tasks in order."""
    routes: list[list[int]] = [[] for _ in range(robots)]
    for task in plan.order.tolist():
        for robot in plan.coalition[task, : plan.size[task]].tolist():
            routes[robot].append(task)
    return routes
