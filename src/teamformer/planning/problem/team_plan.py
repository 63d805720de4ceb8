"""Plans of teams: who does each task, in what order."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.precedence import keep_precedence
from teamformer.world.rules.constants import NOBODY


class TeamPlan(NamedTuple):
    """Which tasks are done in what order, by whom."""

    order: Array  # (tasks,)
    coalition: Array  # (tasks, largest) the first `size` of each, travellers along included
    size: Array  # (tasks,)


def plan_teams(order: Sequence[int], coalitions: Sequence[Sequence[int]]) -> TeamPlan:
    """Return a plan as arrays; `coalitions` holds the robots of each task, by its number."""
    largest = max(map(len, coalitions), default=0)
    plan = TeamPlan(
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


def routes_of(plan: TeamPlan, robots: int) -> list[list[int]]:
    """Return each robot's tasks in order."""
    routes: list[list[int]] = [[] for _ in range(robots)]
    for task in plan.order.tolist():
        for robot in plan.coalition[task, : plan.size[task]].tolist():
            routes[robot].append(task)
    return routes
