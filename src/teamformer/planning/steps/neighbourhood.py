"""Changes to a plan with forming counted: tasks move in the order, robots between coalitions."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.jit import kernel
from teamformer.planning.relaxation.problem import Relaxed
from teamformer.planning.relaxation.relaxed_plan import Array
from teamformer.planning.steps.team_plan import TeamPlan
from teamformer.rules.chance import draw, draw_below
from teamformer.rules.constants import NOBODY

LONGEST_STRETCH = 4
"""How many tasks of a robot in a row are moved at once at most."""

LONGEST_TURN = 60
"""How many tasks of a robot in a row are reversed at most."""

NEIGHBOURS = 16
"""How many tasks around each are listed, nearest first."""


class Workspace(NamedTuple):
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


def empty_workspace(problem: Relaxed, seed: int) -> Workspace:
    """Return room for the changes of one search."""
    tasks, robots = len(problem.appears), len(problem.pace)
    between = problem.cells[:, :tasks] + np.where(np.eye(tasks, dtype=bool), 2**28, 0)
    near = np.argsort(between, axis=1, kind="stable")[:, : max(1, min(NEIGHBOURS, tasks - 1))]
    return Workspace(
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
def change_plan(problem: Relaxed, plan: TeamPlan, workspace: Workspace) -> bool:
    """Make a random change; say whether it came to anything. `undo` takes it back."""
    random = workspace.random
    workspace.changes[0] = 0
    for place in range(len(plan.order)):
        workspace.order[place] = plan.order[place]
        workspace.rank[plan.order[place]] = place
    task = _draw_task(workspace)
    beside = workspace.near[task, draw_below(random, workspace.near.shape[1])]
    kind = draw(random)
    if kind < 0.3:
        return _move_stretch(problem, plan, workspace, task, beside)
    if kind < 0.45:
        return _reorder(plan, workspace, task, beside)
    if kind < 0.6:
        return _turn(plan, workspace, task, beside)
    if kind < 0.7:
        return _exchange(problem, plan, workspace, task)
    if kind < 0.8:
        return _send_along(plan, workspace, task)
    if kind < 0.92:
        return _send_ahead(problem, plan, workspace, task)
    return _replace(problem, plan, workspace, task)


@kernel
def undo(plan: TeamPlan, workspace: Workspace) -> None:
    """Take the last change back."""
    for place in range(len(plan.order)):
        plan.order[place] = workspace.order[place]
    for place in range(workspace.changes[0]):
        task = workspace.changed[place]
        plan.size[task] = workspace.size[place]
        for seat in range(workspace.size[place]):
            plan.coalition[task, seat] = workspace.coalition[place, seat]
        workspace.is_changed[task] = False
    workspace.changes[0] = 0


@kernel
def keep(workspace: Workspace) -> None:
    """Forget how to take the last change back."""
    for place in range(workspace.changes[0]):
        workspace.is_changed[workspace.changed[place]] = False
    workspace.changes[0] = 0


@kernel
def _draw_task(workspace: Workspace) -> Any:
    """Draw a task, every other time one that the makespan hangs on."""
    if workspace.length[0] > 0 and draw_below(workspace.random, 2) == 0:
        return workspace.critical[draw_below(workspace.random, workspace.length[0])]
    return np.int32(draw_below(workspace.random, len(workspace.rank)))


@kernel
def _remember(plan: TeamPlan, workspace: Workspace, task: int) -> None:
    """Note a task's coalition before it changes."""
    if workspace.is_changed[task]:
        return
    place = workspace.changes[0]
    workspace.is_changed[task] = True
    workspace.changed[place] = task
    workspace.size[place] = plan.size[task]
    for seat in range(plan.size[task]):
        workspace.coalition[place, seat] = plan.coalition[task, seat]
    workspace.changes[0] += 1


@kernel
def seat_of(plan: TeamPlan, task: int, robot: int) -> int:
    """Return where a robot sits in a task's coalition; NOBODY if it does not."""
    for seat in range(plan.size[task]):
        if plan.coalition[task, seat] == robot:
            return seat
    return NOBODY


@kernel
def _add(plan: TeamPlan, workspace: Workspace, task: int, robot: int) -> None:
    _remember(plan, workspace, task)
    plan.coalition[task, plan.size[task]] = robot
    plan.size[task] += 1


@kernel
def _drop(plan: TeamPlan, workspace: Workspace, task: int, seat: int) -> None:
    _remember(plan, workspace, task)
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
def _draw_robot(plan: TeamPlan, workspace: Workspace, task: int) -> int:
    return plan.coalition[task, draw_below(workspace.random, plan.size[task])]


@kernel
def _gather_route(
    plan: TeamPlan, workspace: Workspace, robot: int, begin: int, most: int, forward: bool
) -> int:
    """Write a robot's next tasks from a position on to `workspace.moved`; return how many."""
    count, position = 0, begin
    while 0 <= position < len(plan.order) and count < most:
        if seat_of(plan, plan.order[position], robot) != NOBODY:
            workspace.moved[count] = plan.order[position]
            count += 1
        position += 1 if forward else -1
    return count


@kernel
def _place_beside(
    plan: TeamPlan, workspace: Workspace, count: int, beside: int, after: bool, turned: bool
) -> bool:
    """Move the first tasks of `workspace.moved` in the order to right before or after another."""
    for place in range(count):
        if workspace.moved[place] == beside:
            return False
    filled = 0
    for position in range(len(plan.order)):
        task = workspace.order[position]
        is_moved = False
        for place in range(count):
            is_moved |= workspace.moved[place] == task
        if is_moved:
            continue
        if task == beside and after:
            plan.order[filled] = task
            filled += 1
        if task == beside:
            for place in range(count):
                plan.order[filled] = workspace.moved[count - 1 - place if turned else place]
                filled += 1
        if task != beside or not after:
            plan.order[filled] = task
            filled += 1
    return True


@kernel
def _move_stretch(
    problem: Relaxed, plan: TeamPlan, workspace: Workspace, task: int, beside: int
) -> bool:
    """Give a few tasks in a row to the coalition of another one, beside it."""
    random = workspace.random
    robot = _draw_robot(plan, workspace, task)
    most = 1 + draw_below(random, LONGEST_STRETCH) * draw_below(random, 2)
    count = _gather_route(plan, workspace, robot, workspace.rank[task], most, True)
    after, turned = draw_below(random, 2) == 0, draw_below(random, 2) == 0
    if not _place_beside(plan, workspace, count, beside, after, turned):
        return False
    for place in range(count):
        moved = workspace.moved[place]
        if not is_covered(problem, moved, plan.coalition[beside], plan.size[beside], NOBODY):
            continue  # these change their turn only
        _remember(plan, workspace, moved)
        plan.size[moved] = plan.size[beside]
        for seat in range(plan.size[beside]):
            plan.coalition[moved, seat] = plan.coalition[beside, seat]
    return True


@kernel
def _reorder(plan: TeamPlan, workspace: Workspace, task: int, beside: int) -> bool:
    """Move a task in the order: beside one nearby, or beside one of the same robot."""
    random = workspace.random
    if draw_below(random, 2) == 0:
        robot = _draw_robot(plan, workspace, task)
        forward = draw_below(random, 2) == 0
        begin = workspace.rank[task] + (1 if forward else -1)
        count = _gather_route(plan, workspace, robot, begin, 1 + draw_below(random, 6), forward)
        if count == 0:
            return False
        beside = workspace.moved[count - 1]
    workspace.moved[0] = task
    return _place_beside(
        plan, workspace, 1, beside, workspace.rank[beside] > workspace.rank[task], False
    )


@kernel
def _turn(plan: TeamPlan, workspace: Workspace, task: int, beside: int) -> bool:
    """Reverse what a robot does between two tasks (2-opt)."""
    robot = _draw_robot(plan, workspace, task)
    if seat_of(plan, beside, robot) == NOBODY:
        return False
    begin = min(workspace.rank[task], workspace.rank[beside])
    end = max(workspace.rank[task], workspace.rank[beside])
    count = _gather_route(plan, workspace, robot, begin, LONGEST_TURN, True)
    last = 0
    while last < count and workspace.rank[workspace.moved[last]] <= end:
        last += 1
    for place in range(last):
        plan.order[workspace.rank[workspace.moved[place]]] = workspace.moved[last - 1 - place]
    return last > 1


@kernel
def _exchange(problem: Relaxed, plan: TeamPlan, workspace: Workspace, task: int) -> bool:
    """Let two robots exchange all that they do from a task on."""
    robot = _draw_robot(plan, workspace, task)
    other = np.int32(draw_below(workspace.random, len(problem.pace)))
    if other == robot:
        return False
    for position in range(workspace.rank[task], len(plan.order)):
        doing = plan.order[position]
        seat, other_seat = seat_of(plan, doing, robot), seat_of(plan, doing, other)
        if (seat == NOBODY) == (other_seat == NOBODY):
            continue
        _remember(plan, workspace, doing)
        if seat != NOBODY:
            plan.coalition[doing, seat] = other
        else:
            plan.coalition[doing, other_seat] = robot
        if not is_covered(problem, doing, plan.coalition[doing], plan.size[doing], NOBODY):
            return False
    return True


@kernel
def _send_along(plan: TeamPlan, workspace: Workspace, task: int) -> bool:
    """Let a robot travel along with its fellows of a task until they meet again."""
    robot = _draw_robot(plan, workspace, task)
    guide = _draw_robot(plan, workspace, task)
    if guide == robot:
        return False
    for position in range(workspace.rank[task] + 1, len(plan.order)):
        doing = plan.order[position]
        does, leads = seat_of(plan, doing, robot), seat_of(plan, doing, guide)
        if does != NOBODY:
            break
        if leads != NOBODY:
            _add(plan, workspace, doing, robot)
    return workspace.changes[0] > 0


@kernel
def _send_ahead(problem: Relaxed, plan: TeamPlan, workspace: Workspace, task: int) -> bool:
    """Let a robot skip tasks, from one on, that can be done without it."""
    robot = _draw_robot(plan, workspace, task)
    most = 1 + draw_below(workspace.random, 8)
    for position in range(workspace.rank[task], len(plan.order)):
        doing = plan.order[position]
        seat = seat_of(plan, doing, robot)
        if seat == NOBODY:
            continue
        is_spare = is_covered(problem, doing, plan.coalition[doing], plan.size[doing], seat)
        if not is_spare or workspace.changes[0] == most:
            break
        _drop(plan, workspace, doing, seat)
    return workspace.changes[0] > 0


@kernel
def _replace(problem: Relaxed, plan: TeamPlan, workspace: Workspace, task: int) -> bool:
    """Put another robot into one seat of a task."""
    seat = draw_below(workspace.random, plan.size[task])
    other = np.int32(draw_below(workspace.random, len(problem.pace)))
    if seat_of(plan, task, other) != NOBODY:
        return False
    _remember(plan, workspace, task)
    plan.coalition[task, seat] = other
    return is_covered(problem, task, plan.coalition[task], plan.size[task], NOBODY)
