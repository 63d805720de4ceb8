"""A relaxed plan as arrays: tasks in order, the coalition of each, and the steps that follow.

Times run forwards (when can a task start?) and backwards (how long does what hangs on it take?);
a task whose start and tail add up to the makespan is critical.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
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


class RelaxedPlan(NamedTuple):
    """Which tasks are placed in what order, and who does them."""

    order: Array  # (tasks,) a task comes after those that its robots do before it
    placed: Array  # (1,) how many of `order` count
    coalition: Array  # (tasks, width) robots, the first `size` of them
    size: Array  # (tasks,)


class Timing(NamedTuple):
    """When a plan's tasks start, and what its robots do around each."""

    start: Array  # (tasks,) steps
    end: Array  # (tasks,) the same
    tail: Array  # (tasks,) steps from its start to the last end that hangs on it
    push: Array  # (tasks,) what it costs by prices if it ends a step later, without its own price
    robots: Array  # (robots,) ROBOT
    visits: Array  # (tasks, width) VISIT: what each robot of the coalition does after the task


def empty_plan(problem: Relaxed) -> RelaxedPlan:
    """Return a plan without any task; `width` is the largest coalition without a spare robot."""
    tasks = len(problem.appears)
    width = int(most_in_coalitions(problem).max())
    return RelaxedPlan(
        np.full(tasks, NOBODY, np.int32),
        np.zeros(1, np.int32),
        np.zeros((tasks, width), np.int32),
        np.zeros(tasks, np.int32),
    )


def empty_timing(problem: Relaxed, plan: RelaxedPlan) -> Timing:
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


def overwrite_plan(plan: RelaxedPlan, into: RelaxedPlan) -> None:
    """Overwrite a plan with another."""
    for array, kept in zip(plan, into, strict=True):
        kept[:] = array


@kernel
def copy_plan(plan: RelaxedPlan, into: RelaxedPlan) -> None:
    """Overwrite a plan with another, in kernels: loops compile sooner than whole arrays."""
    into.placed[0] = plan.placed[0]
    for task in range(len(plan.size)):
        into.order[task] = plan.order[task]
        into.size[task] = plan.size[task]
        for seat in range(plan.coalition.shape[1]):
            into.coalition[task, seat] = plan.coalition[task, seat]


@kernel
def leg_to(robots: Array, steps: Array, cells: Array, robot: int, task: int) -> int:
    """Return the steps from where a robot is to a task; 0 in the same place only."""
    return steps[robots[robot].pace, cells[task, robots[robot].at]]


@kernel
def leg_from(robots: Array, steps: Array, cells: Array, robot: int, task: int) -> int:
    """Return the steps from a task to the robot's next; 0 if it has none."""
    if robots[robot].next == NOBODY:
        return 0
    return steps[robots[robot].pace, cells[robots[robot].next, task]]


@kernel
def arrival_at(robots: Array, steps: Array, cells: Array, robot: int, task: int) -> int:
    """Return the step a robot can be at a task; where it stands it has been since it came."""
    way = leg_to(robots, steps, cells, robot, task)
    return robots[robot].arrive if way == 0 else robots[robot].leave + way


@kernel
def serve(robots: Array, steps: Array, cells: Array, robot: int, task: int, end: int) -> int:
    """Let a robot go to a task and stay until its end; return the steps walked."""
    way = leg_to(robots, steps, cells, robot, task)
    if way > 0:
        robots[robot].arrive = robots[robot].leave + way
        robots[robot].leave = end
    else:
        robots[robot].leave = max(robots[robot].leave, end)
    robots[robot].at = task
    return way


@kernel
def send_home(robots: Array, tasks: int) -> None:
    """Put every robot back to its start, with nothing done and nothing to do."""
    for robot in range(len(robots)):
        robots[robot].at, robots[robot].arrive, robots[robot].leave = tasks + robot, 0, 0
        robots[robot].next, robots[robot].here, robots[robot].out = NOBODY, 0, 0


@kernel
def set_free(robots: Array, ready: Array) -> None:
    """Let every robot stay at its start until it is free."""
    for robot in range(len(robots)):
        robots[robot].arrive = robots[robot].leave = ready[robot]


@entry
def start_tasks(problem: Relaxed, plan: RelaxedPlan, timing: Timing) -> tuple[Any, Any, Any]:
    """Start every placed task as early as can be.

    Returns the makespan, the steps walked by all robots, and how many visits come too late
    because the robot is lost.
    """
    robots, steps, cells = timing.robots, problem.steps, problem.cells
    send_home(robots, len(plan.size))
    set_free(robots, problem.ready)
    makespan = walked = late = 0
    for position in range(plan.placed[0]):
        task = plan.order[position]
        start = problem.appears[task] + 1
        for seat in range(plan.size[task]):
            start = max(start, arrival_at(robots, steps, cells, plan.coalition[task, seat], task))
        end = start + problem.duration[task]
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            walked += serve(robots, steps, cells, robot, task, end)
            late += end >= problem.lost[robot]
        timing.start[task], timing.end[task] = start, end
        makespan = max(makespan, end)
    return makespan, walked, late


@entry
def hang_tasks(problem: Relaxed, plan: RelaxedPlan, timing: Timing) -> None:
    """Work out every tail, from the last task backwards.

    Leaves the robots at home with their first tasks before them.
    """
    robots, visits = timing.robots, timing.visits
    steps, cells = problem.steps, problem.cells
    send_home(robots, len(plan.size))
    for position in range(plan.placed[0] - 1, -1, -1):
        task = plan.order[position]
        longest = 0
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            remember_visit(robots, robot, visits, task, seat)
            longest = max(longest, _leave_backwards(robots, steps, cells, robot, task))
        timing.tail[task] = problem.duration[task] + longest
        if len(problem.prices.due) > 0:
            timing.push[task] = _price_pushed(problem, plan, timing, task)
        for seat in range(plan.size[task]):
            robot = plan.coalition[task, seat]
            robots[robot].here = max(robots[robot].here, timing.tail[task])


@kernel
def _price_pushed(problem: Relaxed, plan: RelaxedPlan, timing: Timing, task: int) -> Any:
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
def _leave_backwards(robots: Array, steps: Array, cells: Array, robot: int, task: int) -> int:
    """Make a task the robot's next; return the steps that remain when it leaves that place."""
    way = leg_from(robots, steps, cells, robot, task)
    if way > 0:
        robots[robot].out = way + robots[robot].here
        robots[robot].here = 0
    robots[robot].next = task
    return robots[robot].out


@kernel
def remember_visit(robots: Array, robot: int, visits: Array, task: int, seat: int) -> None:
    """Note what a robot does after a task."""
    visits[task, seat].next = robots[robot].next
    visits[task, seat].here = robots[robot].here
    visits[task, seat].out = robots[robot].out


@kernel
def recall_visit(robots: Array, robot: int, visits: Array, task: int, seat: int) -> None:
    """Put before a robot what it does after a task."""
    robots[robot].next = visits[task, seat].next
    robots[robot].here = visits[task, seat].here
    robots[robot].out = visits[task, seat].out
