"""Schedules of the relaxed problem, and the list schedule that turns an order of tasks into one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from teamformer.base.array_types import Array
from teamformer.planning.problem.coalition_plan import without_spares
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.relaxation.relaxed_plan import (
    RelaxedPlan,
    empty_plan,
    empty_timing,
    start_tasks,
)
from teamformer.world.rules.constants import FAR


@dataclass(frozen=True)
class RelaxedSchedule:
    """Who does what when if joining is free; times in steps, per task.

    `order` is one in which every robot can do its tasks; `routes` are the tasks of each robot in
    that order. Tasks in one place may overlap.
    """

    order: tuple[int, ...]
    coalitions: tuple[tuple[int, ...], ...]
    start: tuple[int, ...]
    end: tuple[int, ...]
    routes: tuple[tuple[int, ...], ...]

    @property
    def makespan(self) -> int:
        """Return the step in which the last task ends."""
        return max(self.end)


def schedule_tasks(problem: Relaxed, ranking: Sequence[int]) -> RelaxedSchedule | None:
    """Return the list schedule of an order of all tasks.

    Each task in turn gets the coalition that can be there first. None if robots that will be lost
    leave a task without a coalition.
    """
    at = len(problem.appears) + np.arange(len(problem.pace))  # (robots,) places
    arrive, leave = problem.ready.astype(np.int64), problem.ready.astype(np.int64)
    coalitions: list[list[int]] = [[] for _ in problem.appears]
    for task in ranking:
        ways = problem.steps[problem.pace, problem.cells[task, at]]
        arrival = np.where(ways == 0, arrive, leave + ways)
        crew = coalitions[task] = _first_to_come(problem, task, arrival)
        if not crew:
            return None
        end = max(problem.appears[task] + 1, arrival[crew].max()) + problem.duration[task]
        stays = ways[crew] == 0
        arrive[crew] = arrival[crew]
        leave[crew] = np.where(stays, np.maximum(leave[crew], end), end)
        at[crew] = task
    return read_schedule(problem, make_plan(problem, ranking, coalitions))


def _first_to_come(problem: Relaxed, task: int, arrival: Array) -> list[int]:
    """Return who can be there first and is there at the end; nobody if that is not enough.

    Of those that come until there are enough, the first are sent away again if they can be spared:
    they would wait longest.
    """
    counts, needs, crew = problem.counts, problem.needs[task], list[int]()
    is_useful = (np.minimum(counts, needs) > 0).any(axis=1) & (arrival < FAR)  # (robots,)
    for robot in np.argsort(arrival, kind="stable").tolist():
        if not is_useful[robot]:
            continue
        crew.append(robot)
        if (counts[crew].sum(axis=0) >= needs).all():
            end = max(problem.appears[task] + 1, arrival[robot]) + problem.duration[task]
            crew = [one for one in crew if end < problem.lost[one]]
            if (counts[crew].sum(axis=0) >= needs).all():
                return without_spares(counts, needs, crew[::-1])[::-1]
    return []


def read_schedule(problem: Relaxed, plan: RelaxedPlan) -> RelaxedSchedule | None:
    """Return a plan with its times; None if a task or a robot is lost in it."""
    tasks = len(plan.size)
    timing = empty_timing(problem, plan)
    _, _, late = start_tasks(problem, plan, timing)
    if late or plan.placed[0] < tasks:
        return None
    coalitions = [plan.coalition[task, : plan.size[task]].tolist() for task in range(tasks)]
    order = plan.order.tolist()
    return RelaxedSchedule(
        order=tuple(order),
        coalitions=tuple(tuple(sorted(coalition)) for coalition in coalitions),
        start=tuple(timing.start.tolist()),
        end=tuple((timing.start + problem.duration).tolist()),
        routes=_routes(order, coalitions, len(problem.pace)),
    )


def _routes(
    order: list[int], coalitions: list[list[int]], robots: int
) -> tuple[tuple[int, ...], ...]:
    routes: list[list[int]] = [[] for _ in range(robots)]
    for task in order:
        for robot in coalitions[task]:
            routes[robot].append(task)
    return tuple(map(tuple, routes))


def make_plan(
    problem: Relaxed, order: Sequence[int], coalitions: Sequence[Sequence[int]]
) -> RelaxedPlan:
    """Return a plan as arrays; robots that a coalition can spare are sent away."""
    plan = empty_plan(problem)
    plan.order[:] = order
    plan.placed[0] = len(order)
    for task, coalition in enumerate(coalitions):
        kept = without_spares(problem.counts, problem.needs[task], coalition[::-1])[::-1]
        plan.size[task], plan.coalition[task, : len(kept)] = len(kept), kept
    return plan
