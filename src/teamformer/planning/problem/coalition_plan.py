"""Plans: who does each task, in what order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from teamformer.base.array_types import Array, Int32s
from teamformer.base.kernels.jit import entry
from teamformer.mission.precedence import keep_precedence
from teamformer.planning.problem.coalition_problem import NOBODY, CoalitionProblem


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


def plan_of_lists(
    order: Sequence[int], coalitions: Sequence[Sequence[int]], seats: int = 0
) -> CoalitionPlan:
    """Return a plan as arrays; `coalitions` holds the robots of each task, by its number.

    There is room for so many `seats` of each at least.
    """
    largest = max(map(len, coalitions), default=0)
    plan = CoalitionPlan(
        np.array(order, np.int32),
        np.full((len(coalitions), max(largest, seats)), NOBODY, np.int32),
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


def without_spares(counts: Int32s, need: Int32s, robots: Sequence[int], most: int = 0) -> list[int]:
    """Return robots that cover a need (caps,) without those to spare, dropped from the last on.

    Nobody more is dropped once they are `most`.
    """
    kept = list(robots)
    for robot in reversed(robots):
        rest = [other for other in kept if other != robot]
        if len(kept) > most and (counts[rest].sum(axis=0) >= need).all():
            kept = rest
    return kept


def with_seats(problem: CoalitionProblem, plan: CoalitionPlan, most: int) -> CoalitionPlan:
    """Return a plan in which no task has more than so many robots, but for those that it needs."""
    if (plan.size <= most).all():
        return plan
    seated = CoalitionPlan(plan.order, plan.coalition.copy(), plan.size.copy())
    for task in np.flatnonzero(plan.size > most).tolist():
        crew = plan.coalition[task, : plan.size[task]].tolist()
        kept = without_spares(problem.counts, problem.needs[task], crew, most)
        seated.size[task], seated.coalition[task, : len(kept)] = len(kept), kept
    return seated


def without_tasks(before: Int32s, plan: CoalitionPlan, tasks: Sequence[int]) -> CoalitionPlan:
    """Return a plan without some tasks, and without all that come after what it leaves out.

    `before` (tasks, most) has the tasks before each, then NOBODY.
    """
    size = plan.size.copy()
    size[list(tasks)] = 0
    while True:
        waits = ((before != NOBODY) & (size[before] == 0)).any(axis=1) & (size > 0)
        if not waits.any():
            return plan._replace(size=size)
        size[waits] = 0


class Judged(Protocol):
    """A plan and what it is compared by, the least first."""

    @property
    def plan(self) -> CoalitionPlan:
        """Return the plan."""

    @property
    def rank(self) -> tuple[float, ...]:
        """Return what it is compared by."""


Made = TypeVar("Made", bound=Judged)


def without_riders(
    counts: Int32s,
    needs: Int32s,
    made: Made,
    judged: Callable[[CoalitionPlan], Made],
    is_strict: bool = False,
) -> Made:
    """Return a plan without the robots that a task can be done without, where it is no worse then.

    If it `is_strict`, only where it is better.

    A search has some come along, as that may pay; others only trail along. What is judged may have
    its robots renamed. `counts` is (robots, caps), `needs` (tasks, caps).
    """
    for task in made.plan.order.tolist():
        seat = int(made.plan.size[task]) - 1
        while seat >= 0:
            crew = made.plan.coalition[task, : made.plan.size[task]]
            rest = np.delete(crew, seat)
            seat -= 1
            if (counts[rest].sum(axis=0) < needs[task]).any():
                continue
            fewer = CoalitionPlan(*(array.copy() for array in made.plan))
            fewer.size[task], fewer.coalition[task, : len(rest)] = len(rest), rest
            found = judged(fewer)
            if found.rank < made.rank or (found.rank == made.rank and not is_strict):
                made, seat = found, min(seat, int(found.plan.size[task]) - 1)
    return made
