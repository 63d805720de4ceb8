"""Schedules of the relaxed problem, and the list schedule that turns an order of tasks into one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry, kernel
from teamformer.planning.problem.relaxed_problem import Relaxed
from teamformer.planning.relaxation.insertion import drop_spares
from teamformer.planning.relaxation.relaxed_plan import (
    RelaxedPlan,
    arrival_at,
    empty_plan,
    empty_timing,
    send_home,
    serve,
    set_free,
    start_tasks,
)
from teamformer.world.rules.constants import FAR
from teamformer.world.rules.coverage import helps
from teamformer.world.rules.sorting import sort_indices

if TYPE_CHECKING:
    from teamformer.planning.relaxation.relaxed_plan import Timing


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
    plan = empty_plan(problem)
    decode(problem, np.asarray(ranking, np.int32), plan, empty_timing(problem, plan))
    return read_schedule(problem, plan)


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
        pick = np.array(coalition, np.int32)
        spare = problem.counts[pick].sum(axis=0, dtype=np.int32) - problem.needs[task]
        plan.size[task] = drop_spares(problem.counts, pick, len(pick), spare)
        plan.coalition[task, : plan.size[task]] = pick[: plan.size[task]]
    return plan


@entry
def decode(problem: Relaxed, ranking: Array, plan: RelaxedPlan, timing: Timing) -> Any:
    """Give each task in turn the coalition that can be there first; return the makespan.

    Of those that come until there are enough, the first are sent away again if they can be spared:
    they would wait longest. A task that nobody is left to do stays out of the plan.
    """
    robots, steps, cells = timing.robots, problem.steps, problem.cells
    pick, spare = np.empty(len(robots), np.int32), np.empty(problem.needs.shape[1], np.int32)
    send_home(robots, len(plan.size))
    set_free(robots, problem.ready)
    plan.placed[0] = makespan = 0
    for task in ranking:
        _sort_by_arrival(robots, steps, cells, task, pick)
        size = _take_first(robots, problem, pick, spare, task)
        plan.size[task] = drop_spares(problem.counts, pick, size, spare)
        start = problem.appears[task] + 1
        for seat in range(plan.size[task]):
            plan.coalition[task, seat] = pick[seat]
            start = max(start, robots[pick[seat]].arrival)
        for seat in range(plan.size[task]):
            serve(robots, steps, cells, pick[seat], task, start + problem.duration[task])
        if size > 0:
            plan.order[plan.placed[0]] = task
            plan.placed[0] += 1
            makespan = max(makespan, start + problem.duration[task])
    return makespan


@allocating_kernel
def _sort_by_arrival(robots: Array, steps: Array, cells: Array, task: int, pick: Array) -> None:
    arrival, room = np.empty(len(robots), np.int64), np.empty(len(robots), np.int32)
    for robot in range(len(robots)):
        arrival[robot] = arrival_at(robots, steps, cells, robot, task)
        robots[robot].arrival = arrival[robot]
    sort_indices(arrival, pick, room)


@allocating_kernel
def _take_first(robots: Array, problem: Relaxed, pick: Array, spare: Array, task: int) -> int:
    """Keep in `pick`, sorted by arrival, the first that cover a task; return how many, or 0.

    `spare` is left with what they have beyond what the task needs.
    """
    needs, counts = problem.needs, problem.counts
    earliest, duration = problem.appears[task] + 1, problem.duration[task]
    spare[:] = -needs[task]
    size = 0
    for robot in pick:
        if helps(counts[robot], needs[task]) and robots[robot].arrival < FAR:
            pick[size] = robot
            size += 1
            spare += counts[robot]
            if spare.min() >= 0:
                end = max(earliest, robots[robot].arrival) + duration
                size = _drop_lost(robots, counts, pick, size, spare, end)
                if spare.min() >= 0:
                    return size
    return 0


@kernel
def _drop_lost(robots: Array, counts: Array, pick: Array, size: int, spare: Array, end: int) -> int:
    """Send away robots that will be missing at the end; return how many are left."""
    kept = 0
    for seat in range(size):
        if end < robots[pick[seat]].lost:
            pick[kept] = pick[seat]
            kept += 1
        else:
            spare -= counts[pick[seat]]
    return kept
