"""Changes to a plan with forming counted: tasks move in the order, robots between coalitions."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.jit import kernel
from teamformer.planning.relaxation.plan import Array
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.teams.plan import TeamPlan
from teamformer.rules.chance import draw, draw_below
from teamformer.rules.constants import NOBODY

LONGEST_STRETCH = 4
"""How many tasks of a robot in a row are moved at once at most."""

LONGEST_TURN = 60
"""How many tasks of a robot in a row are reversed at most."""

NEIGHBOURS = 16
"""How many tasks around each are listed, nearest first."""


class Bench(NamedTuple):
    """Room to change a plan in, and to take the change back."""

    near: Array  # (tasks, neighbours) other tasks by distance
    order: Array  # (tasks,) as it was
    changed: Array  # (tasks,) tasks whose coalitions have changed
    changes: Array  # (1,) how many these are
    is_changed: Array  # (tasks,)
    coalition: Array  # (tasks, robots) as they were, in the order of `changed`
    size: Array  # (tasks,)
    rank: Array  # (tasks,) positions in the order
    moved: Array  # (tasks,) tasks at hand
    union: Array  # (robots,) a coalition at hand
    critical: Array  # (tasks,) the chain of tasks that the makespan hangs on
    length: Array  # (1,) of it
    random: Array  # (1,) state of the random numbers


def empty_bench(problem: Relaxed, seed: int) -> Bench:
    """Return room for the changes of one search."""
    tasks, robots = len(problem.appears), len(problem.pace)
    between = problem.cells[:, :tasks] + np.where(np.eye(tasks, dtype=bool), 2**28, 0)
    near = np.argsort(between, axis=1, kind="stable")[:, : max(1, min(NEIGHBOURS, tasks - 1))]
    return Bench(
        near=near.astype(np.int32),
        order=np.zeros(tasks, np.int32),
        changed=np.zeros(tasks, np.int32),
        changes=np.zeros(1, np.int32),
        is_changed=np.zeros(tasks, np.bool_),
        coalition=np.zeros((tasks, robots), np.int32),
        size=np.zeros(tasks, np.int32),
        rank=np.zeros(tasks, np.int32),
        moved=np.zeros(tasks, np.int32),
        union=np.zeros(robots, np.int32),
        critical=np.zeros(tasks, np.int32),
        length=np.zeros(1, np.int32),
        random=np.array([seed * 2654435761 + 88172645463325252], np.uint64),
    )


@kernel
def change_plan(problem: Relaxed, plan: TeamPlan, bench: Bench) -> bool:
    """Make a random change; say whether it came to anything. `undo` takes it back."""
    random = bench.random
    bench.changes[0] = 0
    for place in range(len(plan.order)):
        bench.order[place] = plan.order[place]
        bench.rank[plan.order[place]] = place
    task = _draw_task(bench)
    beside = bench.near[task, draw_below(random, bench.near.shape[1])]
    kind = draw(random)
    if kind < 0.3:
        return _move_stretch(problem, plan, bench, task, beside)
    if kind < 0.45:
        return _reorder(plan, bench, task, beside)
    if kind < 0.6:
        return _turn(plan, bench, task, beside)
    if kind < 0.7:
        return _exchange(problem, plan, bench, task)
    if kind < 0.8:
        return _send_along(plan, bench, task)
    if kind < 0.92:
        return _send_ahead(problem, plan, bench, task)
    return _replace(problem, plan, bench, task)


@kernel
def undo(plan: TeamPlan, bench: Bench) -> None:
    """Take the last change back."""
    for place in range(len(plan.order)):
        plan.order[place] = bench.order[place]
    for place in range(bench.changes[0]):
        task = bench.changed[place]
        plan.size[task] = bench.size[place]
        for seat in range(bench.size[place]):
            plan.coalition[task, seat] = bench.coalition[place, seat]
        bench.is_changed[task] = False
    bench.changes[0] = 0


@kernel
def keep(bench: Bench) -> None:
    """Forget how to take the last change back."""
    for place in range(bench.changes[0]):
        bench.is_changed[bench.changed[place]] = False
    bench.changes[0] = 0


@kernel
def _draw_task(bench: Bench) -> Any:
    """Draw a task, every other time one that the makespan hangs on."""
    if bench.length[0] > 0 and draw_below(bench.random, 2) == 0:
        return bench.critical[draw_below(bench.random, bench.length[0])]
    return np.int32(draw_below(bench.random, len(bench.rank)))


@kernel
def _remember(plan: TeamPlan, bench: Bench, task: int) -> None:
    """Note a task's coalition before it changes."""
    if bench.is_changed[task]:
        return
    place = bench.changes[0]
    bench.is_changed[task] = True
    bench.changed[place] = task
    bench.size[place] = plan.size[task]
    for seat in range(plan.size[task]):
        bench.coalition[place, seat] = plan.coalition[task, seat]
    bench.changes[0] += 1


@kernel
def seat_of(plan: TeamPlan, task: int, robot: int) -> int:
    """Return where a robot sits in a task's coalition; NOBODY if it does not."""
    for seat in range(plan.size[task]):
        if plan.coalition[task, seat] == robot:
            return seat
    return NOBODY


@kernel
def _add(plan: TeamPlan, bench: Bench, task: int, robot: int) -> None:
    _remember(plan, bench, task)
    plan.coalition[task, plan.size[task]] = robot
    plan.size[task] += 1


@kernel
def _drop(plan: TeamPlan, bench: Bench, task: int, seat: int) -> None:
    _remember(plan, bench, task)
    plan.size[task] -= 1
    plan.coalition[task, seat] = plan.coalition[task, plan.size[task]]


@kernel
def is_covered(problem: Relaxed, task: int, coalition: Array, size: int, without: int) -> bool:
    """Say whether robots, without the one in a seat, have all that a task needs."""
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[task, cap]
        if lacking > 0:
            for seat in range(size):
                if seat != without:
                    lacking -= problem.counts[coalition[seat], cap]
            if lacking > 0:
                return False
    return True


@kernel
def _draw_robot(plan: TeamPlan, bench: Bench, task: int) -> int:
    return plan.coalition[task, draw_below(bench.random, plan.size[task])]


@kernel
def _gather_route(
    plan: TeamPlan, bench: Bench, robot: int, begin: int, most: int, forward: bool
) -> int:
    """Write a robot's next tasks from a position on to `bench.moved`; return how many."""
    count, position = 0, begin
    while 0 <= position < len(plan.order) and count < most:
        if seat_of(plan, plan.order[position], robot) != NOBODY:
            bench.moved[count] = plan.order[position]
            count += 1
        position += 1 if forward else -1
    return count


@kernel
def _place_beside(
    plan: TeamPlan, bench: Bench, count: int, beside: int, after: bool, turned: bool
) -> bool:
    """Move the first tasks of `bench.moved` in the order to right before or after another."""
    for place in range(count):
        if bench.moved[place] == beside:
            return False
    filled = 0
    for position in range(len(plan.order)):
        task = bench.order[position]
        is_moved = False
        for place in range(count):
            is_moved |= bench.moved[place] == task
        if is_moved:
            continue
        if task == beside and after:
            plan.order[filled] = task
            filled += 1
        if task == beside:
            for place in range(count):
                plan.order[filled] = bench.moved[count - 1 - place if turned else place]
                filled += 1
        if task != beside or not after:
            plan.order[filled] = task
            filled += 1
    return True


@kernel
def _move_stretch(problem: Relaxed, plan: TeamPlan, bench: Bench, task: int, beside: int) -> bool:
    """Give a few tasks in a row to the coalition of another one, beside it."""
    random = bench.random
    robot = _draw_robot(plan, bench, task)
    most = 1 + draw_below(random, LONGEST_STRETCH) * draw_below(random, 2)
    count = _gather_route(plan, bench, robot, bench.rank[task], most, True)
    after, turned = draw_below(random, 2) == 0, draw_below(random, 2) == 0
    if not _place_beside(plan, bench, count, beside, after, turned):
        return False
    for place in range(count):
        moved = bench.moved[place]
        if not is_covered(problem, moved, plan.coalition[beside], plan.size[beside], NOBODY):
            continue  # these change their turn only
        _remember(plan, bench, moved)
        plan.size[moved] = plan.size[beside]
        for seat in range(plan.size[beside]):
            plan.coalition[moved, seat] = plan.coalition[beside, seat]
    return True


@kernel
def _reorder(plan: TeamPlan, bench: Bench, task: int, beside: int) -> bool:
    """Move a task in the order: beside one nearby, or beside one of the same robot."""
    random = bench.random
    if draw_below(random, 2) == 0:
        robot = _draw_robot(plan, bench, task)
        forward = draw_below(random, 2) == 0
        begin = bench.rank[task] + (1 if forward else -1)
        count = _gather_route(plan, bench, robot, begin, 1 + draw_below(random, 6), forward)
        if count == 0:
            return False
        beside = bench.moved[count - 1]
    bench.moved[0] = task
    return _place_beside(plan, bench, 1, beside, bench.rank[beside] > bench.rank[task], False)


@kernel
def _turn(plan: TeamPlan, bench: Bench, task: int, beside: int) -> bool:
    """Reverse what a robot does between two tasks (2-opt)."""
    robot = _draw_robot(plan, bench, task)
    if seat_of(plan, beside, robot) == NOBODY:
        return False
    begin = min(bench.rank[task], bench.rank[beside])
    end = max(bench.rank[task], bench.rank[beside])
    count = _gather_route(plan, bench, robot, begin, LONGEST_TURN, True)
    last = 0
    while last < count and bench.rank[bench.moved[last]] <= end:
        last += 1
    for place in range(last):
        plan.order[bench.rank[bench.moved[place]]] = bench.moved[last - 1 - place]
    return last > 1


@kernel
def _exchange(problem: Relaxed, plan: TeamPlan, bench: Bench, task: int) -> bool:
    """Let two robots exchange all that they do from a task on."""
    robot = _draw_robot(plan, bench, task)
    other = np.int32(draw_below(bench.random, len(problem.pace)))
    if other == robot:
        return False
    for position in range(bench.rank[task], len(plan.order)):
        doing = plan.order[position]
        seat, other_seat = seat_of(plan, doing, robot), seat_of(plan, doing, other)
        if (seat == NOBODY) == (other_seat == NOBODY):
            continue
        _remember(plan, bench, doing)
        if seat != NOBODY:
            plan.coalition[doing, seat] = other
        else:
            plan.coalition[doing, other_seat] = robot
        if not is_covered(problem, doing, plan.coalition[doing], plan.size[doing], NOBODY):
            return False
    return True


@kernel
def _send_along(plan: TeamPlan, bench: Bench, task: int) -> bool:
    """Let a robot travel along with its fellows of a task until they meet again."""
    robot = _draw_robot(plan, bench, task)
    guide = _draw_robot(plan, bench, task)
    if guide == robot:
        return False
    for position in range(bench.rank[task] + 1, len(plan.order)):
        doing = plan.order[position]
        does, leads = seat_of(plan, doing, robot), seat_of(plan, doing, guide)
        if does != NOBODY:
            break
        if leads != NOBODY:
            _add(plan, bench, doing, robot)
    return bench.changes[0] > 0


@kernel
def _send_ahead(problem: Relaxed, plan: TeamPlan, bench: Bench, task: int) -> bool:
    """Let a robot skip tasks, from one on, that can be done without it."""
    robot = _draw_robot(plan, bench, task)
    most = 1 + draw_below(bench.random, 8)
    for position in range(bench.rank[task], len(plan.order)):
        doing = plan.order[position]
        seat = seat_of(plan, doing, robot)
        if seat == NOBODY:
            continue
        is_spare = is_covered(problem, doing, plan.coalition[doing], plan.size[doing], seat)
        if not is_spare or bench.changes[0] == most:
            break
        _drop(plan, bench, doing, seat)
    return bench.changes[0] > 0


@kernel
def _replace(problem: Relaxed, plan: TeamPlan, bench: Bench, task: int) -> bool:
    """Put another robot into one seat of a task."""
    seat = draw_below(bench.random, plan.size[task])
    other = np.int32(draw_below(bench.random, len(problem.pace)))
    if seat_of(plan, task, other) != NOBODY:
        return False
    _remember(plan, bench, task)
    plan.coalition[task, seat] = other
    return is_covered(problem, task, plan.coalition[task], plan.size[task], NOBODY)
