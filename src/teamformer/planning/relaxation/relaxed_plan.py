"""A relaxed plan as arrays: tasks in order, the coalition of each, and the steps that follow.

Times run forwards (when can a task start?) and backwards (how long does what hangs on it take?);
a task whose start and tail add up to the makespan is critical.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.problem.coalition_plan import (
    CoalitionPlan,
    plan_of_lists,
    without_spares,
)
from teamformer.planning.problem.prices import slope_of_price
from teamformer.planning.problem.relaxed_problem import Relaxed, most_in_coalitions
from teamformer.world.rules.constants import NOBODY

ROBOT = np.dtype(
    [
        # What it has done: its last task, and its stay in that place so far.
        ("at", np.int32),  # place: a task, or its own start
        ("arrive", np.int32),  # step it came there
        ("leave", np.int32),  # step all it serves there is done
        # What it will do: its next task, and its stay in that place from then on.
        ("next", np.int32),  # task, or NOBODY
        ("here", np.int32),  # steps from the start of that stay to the last end that hangs on it
        ("out", np.int32),  # steps that remain when it leaves that place
        # What one more task in between would mean, see insertion.
        ("arrival", np.int32),  # step it could be there
        ("beyond", np.int32),  # steps that would remain after its end
        ("detour", np.int32),  # steps more to walk
        # What it is.
        ("pace", np.int32),
        ("lost", np.int32),  # step it is missing from
        ("is_candidate", np.bool_),
        ("is_picked", np.bool_),
    ],
    align=True,
)
VISIT = np.dtype([("next", np.int32), ("here", np.int32), ("out", np.int32)])


class Timing(NamedTuple):
    """When a plan's tasks start, and what its robots do around each."""

    start: Array  # (tasks,) steps
    end: Array  # (tasks,) the same
    tail: Array  # (tasks,) steps from its start to the last end that hangs on it
    push: Array  # (tasks,) what it costs by prices if it ends a step later, without its own price
    robots: Array  # (robots,) ROBOT
    visits: Array  # (tasks, width) VISIT: what each robot of the coalition does after the task


def empty_plan(problem: Relaxed) -> CoalitionPlan:
    """Return a plan without any task, with seats for the largest coalition without a spare robot.

    While it is made, its order has the tasks with a coalition; what is behind these says nothing.
    """
    return plan_of_lists(
        range(len(problem.appears)),
        [[] for _ in problem.appears],
        int(most_in_coalitions(problem).max()),
    )


def plan_without_spares(
    problem: Relaxed, order: Sequence[int], coalitions: Sequence[Sequence[int]]
) -> CoalitionPlan:
    """Return a plan; robots that a coalition can spare are sent away, the first of them first."""
    plan = empty_plan(problem)
    plan.order[:] = order
    for task, coalition in enumerate(coalitions):
        kept = without_spares(problem.counts, problem.needs[task], coalition[::-1])[::-1]
        plan.size[task], plan.coalition[task, : len(kept)] = len(kept), kept
    return plan


def makespan_of(problem: Relaxed, plan: CoalitionPlan) -> int | None:
    """Return when the last task of a plan ends; None if a task or a robot is lost in it."""
    makespan, _, late = start_tasks(problem, plan, empty_timing(problem, plan))
    return None if late or (plan.size == 0).any() else int(makespan)


@kernel
def placed_in(plan: CoalitionPlan) -> int:
    """Return how many tasks are placed: the first ones of the order."""
    placed = 0
    for task in range(len(plan.size)):
        placed += plan.size[task] > 0
    return placed


def empty_timing(problem: Relaxed, plan: CoalitionPlan) -> Timing:
    """Return room for the times of a plan, which plain Python can use as well as kernels."""
    robots, tasks = len(problem.pace), len(problem.appears)
    timing = Timing(
        np.zeros(tasks, np.int32),
        np.zeros(tasks, np.int32),
        np.zeros(tasks, np.int32),
        np.zeros(tasks, np.int64),
        np.zeros(robots, ROBOT).view(np.recarray),
        np.zeros(plan.coalition.shape, VISIT).view(np.recarray),
    )
    timing.robots["pace"], timing.robots["lost"] = problem.pace, problem.lost
    return timing


@kernel
def leg_to(problem: Relaxed, timing: Timing, robot: int, task: int) -> int:
    """Return the steps from where a robot is to a task; 0 in the same place only."""
    one = timing.robots[robot]
    return problem.steps[one.pace, problem.cells[task, one.at]]


@kernel
def leg_from(problem: Relaxed, timing: Timing, robot: int, task: int) -> int:
    """Return the steps from a task to the robot's next; 0 if it has none."""
    one = timing.robots[robot]
    if one.next == NOBODY:
        return 0
    return problem.steps[one.pace, problem.cells[one.next, task]]


@kernel
def arrival_at(problem: Relaxed, timing: Timing, robot: int, task: int) -> int:
    """Return the step a robot can be at a task; where it stands it has been since it came."""
    way = leg_to(problem, timing, robot, task)
    return timing.robots[robot].arrive if way == 0 else timing.robots[robot].leave + way


@kernel
def serve(problem: Relaxed, timing: Timing, robot: int, task: int, end: int) -> int:
    """Let a robot go to a task and stay until its end; return the steps walked."""
    way, robots = leg_to(problem, timing, robot, task), timing.robots
    if way > 0:
        robots[robot].arrive = robots[robot].leave + way
        robots[robot].leave = end
    else:
        robots[robot].leave = max(robots[robot].leave, end)
    robots[robot].at = task
    return way


@kernel
def _send_home(problem: Relaxed, timing: Timing) -> None:
    """Put every robot back to its start, with nothing done and nothing to do."""
    robots, tasks = timing.robots, len(problem.appears)
    for robot in range(len(robots)):
        robots[robot].at, robots[robot].arrive, robots[robot].leave = tasks + robot, 0, 0
        robots[robot].next, robots[robot].here, robots[robot].out = NOBODY, 0, 0


@entry
def start_tasks(problem: Relaxed, plan: CoalitionPlan, timing: Timing) -> tuple[Any, Any, Any]:
    """Start every placed task as early as can be.

    Returns the makespan, the steps walked by all robots, and how many visits come too late
    because the robot is lost.
    """
    robots = timing.robots
    _send_home(problem, timing)
    for robot in range(len(robots)):  # each stays at its start until it is free
        robots[robot].arrive = robots[robot].leave = problem.ready[robot]
    makespan = walked = late = 0
    for position in range(placed_in(plan)):
        task = plan.order[position]
        start = problem.appears[task] + 1
        for seat in range(plan.size[task]):
            start = max(start, arrival_at(problem, timing, plan.coalition[task, seat], task))
        end = start + problem.duration[task]
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            walked += serve(problem, timing, robot, task, end)
            late += end >= problem.lost[robot]
        timing.start[task], timing.end[task] = start, end
        makespan = max(makespan, end)
    return makespan, walked, late


@entry
def hang_tasks(problem: Relaxed, plan: CoalitionPlan, timing: Timing) -> None:
    """Work out every tail, from the last task backwards.

    Leaves the robots at home with their first tasks before them.
    """
    robots = timing.robots
    _send_home(problem, timing)
    for position in range(placed_in(plan) - 1, -1, -1):
        task = plan.order[position]
        longest = 0
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            _remember_visit(timing, robot, task, seat)
            longest = max(longest, _leave_backwards(problem, timing, robot, task))
        timing.tail[task] = problem.duration[task] + longest
        if len(problem.prices.due) > 0:
            timing.push[task] = _price_pushed(problem, plan, timing, task)
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            robots[robot].here = max(robots[robot].here, timing.tail[task])


@kernel
def _price_pushed(problem: Relaxed, plan: CoalitionPlan, timing: Timing, task: int) -> Any:
    """Return what a step more of a task costs by prices: of all that has to wait for its robots.

    What each of them does after it has been noted.
    """
    price, prices, visits = np.int64(0), problem.prices, timing.visits
    for seat in range(plan.size[task]):
        after, is_new = visits[task, seat].next, True
        if after == NOBODY:
            continue
        for other in range(seat):
            is_new &= visits[task, other].next != after
        pace = timing.robots[plan.coalition[task, seat]].pace
        there = timing.end[task] + problem.steps[pace, problem.cells[after, task]]
        if is_new and there >= timing.start[after]:
            price += timing.push[after] + slope_of_price(prices, after, timing.end[after])
    return price


@kernel
def _leave_backwards(problem: Relaxed, timing: Timing, robot: int, task: int) -> int:
    """Make a task the robot's next; return the steps that remain when it leaves that place."""
    way, robots = leg_from(problem, timing, robot, task), timing.robots
    if way > 0:
        robots[robot].out = way + robots[robot].here
        robots[robot].here = 0
    robots[robot].next = task
    return robots[robot].out


@kernel
def _remember_visit(timing: Timing, robot: int, task: int, seat: int) -> None:
    """Note what a robot does after a task."""
    timing.visits[task, seat].next = timing.robots[robot].next
    timing.visits[task, seat].here = timing.robots[robot].here
    timing.visits[task, seat].out = timing.robots[robot].out


@kernel
def recall_visit(timing: Timing, robot: int, task: int, seat: int) -> None:
    """Put before a robot what it does after a task."""
    timing.robots[robot].next = timing.visits[task, seat].next
    timing.robots[robot].here = timing.visits[task, seat].here
    timing.robots[robot].out = timing.visits[task, seat].out
