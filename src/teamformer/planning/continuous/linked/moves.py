"""Changes to a plan of linked tasks: groups move in the order, robots between coalitions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.jit import kernel
from teamformer.planning.continuous.coalition_choice import (
    count_short,
    draw_short,
    drop_spare,
    is_picked,
)
from teamformer.planning.continuous.problem import NOBODY
from teamformer.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.continuous.coalition_choice import Workspace
    from teamformer.planning.continuous.linked.problem import LinkedProblem
    from teamformer.planning.continuous.linked.schedule import LinkedSchedule
    from teamformer.planning.continuous.problem import CoalitionProblem

RELOCATIONS, MOVES, REPLACEMENTS, EXCHANGES = 40, 60, 75, 85  # percent, one upon the other
"""How many changes move a group and replace a member of it, move a group, replace a member, or
exchange two groups; the others exchange all that two robots do from a place on."""

NEAR = 4
"""Half of the moves go no farther than so many positions."""

ANYBODY = 3
"""Every so many robots is picked at random; the others are those that come first."""

ALL_ANEW = 5
"""Every so many replacements drop all members of a group."""

NO_CHANGE = -1


@kernel
def change(problem: LinkedProblem, schedule: LinkedSchedule, workspace: Workspace) -> int:
    """Make a random change; return the first position that it touches, or NO_CHANGE if it fails.

    Times are left as they were, and a change that fails may leave the plan half changed.
    """
    groups = len(schedule.order)
    position, kind = draw_below(workspace.random, groups), draw_below(workspace.random, 100)
    group = schedule.order[position]
    if kind >= EXCHANGES:
        return _exchange_rests(problem, schedule, workspace, position)
    if kind >= REPLACEMENTS:
        return _exchange(problem, schedule, position, draw_below(workspace.random, groups))
    begin = position
    if kind < MOVES:
        begin = _move(problem, schedule, position, _draw_position(schedule, workspace, position))
        if begin == NO_CHANGE:
            return NO_CHANGE
    if kind < RELOCATIONS or kind >= MOVES:
        if not _replace(problem, schedule, workspace, group):
            return NO_CHANGE
    elif begin == position == schedule.rank[group]:
        return NO_CHANGE
    return begin


@kernel
def _draw_position(schedule: LinkedSchedule, workspace: Workspace, position: int) -> int:
    """Draw where a group may go: half of the time near where it is."""
    groups = len(schedule.order)
    if draw_below(workspace.random, 2) == 0:
        return draw_below(workspace.random, groups)
    to = position - NEAR + draw_below(workspace.random, 2 * NEAR + 1)
    return min(max(to, 0), groups - 1)


@kernel
def _move(problem: LinkedProblem, schedule: LinkedSchedule, position: int, to: int) -> int:
    """Move a group to another position; return the first that is touched, or NO_CHANGE."""
    order = schedule.order
    group, step = order[position], 1 if to > position else -1
    for at in range(position, to, step):
        order[at] = order[at + step]
    order[to] = group
    return _rank_anew(problem, schedule, min(position, to), max(position, to))


@kernel
def _exchange(problem: LinkedProblem, schedule: LinkedSchedule, one: int, two: int) -> int:
    """Exchange the groups at two positions."""
    order = schedule.order
    if one == two:
        return NO_CHANGE
    order[one], order[two] = order[two], order[one]
    return _rank_anew(problem, schedule, min(one, two), max(one, two))


@kernel
def _rank_anew(problem: LinkedProblem, schedule: LinkedSchedule, begin: int, finish: int) -> int:
    """Number the positions of a window; return its begin, NO_CHANGE if precedence forbids it."""
    for position in range(begin, finish + 1):
        schedule.rank[schedule.order[position]] = position
    for position in range(begin, finish + 1):
        for task in problem.members[schedule.order[position]]:
            if task == NOBODY:
                break
            for other in problem.base.before[task]:
                if other == NOBODY:
                    break
                if schedule.rank[problem.group[other]] > position:
                    return NO_CHANGE
    return begin


@kernel
def _replace(
    problem: LinkedProblem, schedule: LinkedSchedule, workspace: Workspace, group: int
) -> bool:
    """Drop a member of a coalition of the group, and let others bring what is then missing.

    Every so often all members of the group are dropped: robots of linked tasks cannot change
    places one after the other.
    """
    members, count = problem.members[group], 0
    while members[count] != NOBODY:
        count += 1
    first = draw_below(workspace.random, count)
    if draw_below(workspace.random, ALL_ANEW) == 0:
        return gather(problem, schedule, workspace, group, first, count)
    task = members[first]
    mark_others(problem, schedule, workspace, group, task)
    size = schedule.size[task]
    out = draw_below(workspace.random, size)
    workspace.picks[0] = 0
    for seat in range(size):
        if seat != out:
            workspace.pick[workspace.picks[0]] = schedule.coalition[task, seat]
            workspace.picks[0] += 1
    gone = schedule.coalition[task, out]
    if not cover(problem, schedule, workspace, task, schedule.rank[group], gone):
        return False
    seat_picks(schedule, workspace, task)
    return True


@kernel
def gather(
    problem: LinkedProblem,
    schedule: LinkedSchedule,
    workspace: Workspace,
    group: int,
    first: int,
    count: int,
) -> bool:
    """Give the tasks of a group new coalitions, one after the other; say if there are any."""
    members = problem.members[group]
    for number in range(count):
        schedule.size[members[number]] = 0
    for number in range(first, first + count):
        task = members[number % count]
        mark_others(problem, schedule, workspace, group, task)
        workspace.picks[0] = 0
        if not cover(problem, schedule, workspace, task, schedule.rank[group], NOBODY):
            return False
        seat_picks(schedule, workspace, task)
    return True


@kernel
def mark_others(
    problem: LinkedProblem, schedule: LinkedSchedule, workspace: Workspace, group: int, task: int
) -> None:
    """Note who does the other tasks of a group: linked tasks are done by different robots."""
    workspace.clock[0] += 1
    for other in problem.members[group]:
        if other == NOBODY:
            break
        if other != task:
            for seat in range(schedule.size[other]):
                workspace.seen[schedule.coalition[other, seat]] = workspace.clock[0]


@kernel
def cover(
    problem: LinkedProblem,
    schedule: LinkedSchedule,
    workspace: Workspace,
    task: int,
    position: int,
    gone: int,
) -> bool:
    """Add robots for what the coalition at hand lacks; say if it is enough. `gone` stays away."""
    base = problem.base
    while count_short(base, workspace, task):
        best, least, seen = NOBODY, 0, 0
        is_random = draw_below(workspace.random, ANYBODY) == 0
        for robot in base.able[draw_short(base, workspace)]:
            if robot == NOBODY:
                break
            if (
                robot == gone
                or workspace.seen[robot] == workspace.clock[0]
                or is_picked(workspace, robot)
            ):
                continue
            seen += 1
            place = schedule.last[position, robot]
            comes = schedule.end[place] + base.ways[base.pace[robot], place, task]
            is_better = draw_below(workspace.random, seen) == 0 if is_random else comes < least
            if best == NOBODY or is_better:
                best, least = robot, comes
        if best == NOBODY:
            return False
        workspace.pick[workspace.picks[0]] = best
        workspace.picks[0] += 1
    drop_spare(base, workspace, task)
    return True


@kernel
def seat_picks(schedule: LinkedSchedule, workspace: Workspace, task: int) -> None:
    """Make the coalition at hand a task's."""
    schedule.size[task] = workspace.picks[0]
    for seat in range(workspace.picks[0]):
        schedule.coalition[task, seat] = workspace.pick[seat]


@kernel
def _exchange_rests(
    problem: LinkedProblem, schedule: LinkedSchedule, workspace: Workspace, position: int
) -> int:
    """Let two robots exchange all that they do from a position on, if both can."""
    robots = len(problem.base.origin)
    one, two = draw_below(workspace.random, robots), draw_below(workspace.random, robots)
    if one == two:
        return NO_CHANGE
    begin = NO_CHANGE
    for later in range(position, len(schedule.order)):
        for task in problem.members[schedule.order[later]]:
            if task == NOBODY:
                break
            if _exchange_seats(schedule, task, one, two):
                if begin == NO_CHANGE:
                    begin = later
                if not _is_covered(problem.base, schedule, task):
                    return NO_CHANGE
    return begin


@kernel
def _exchange_seats(schedule: LinkedSchedule, task: int, one: int, two: int) -> bool:
    """Exchange two robots in a coalition; say whether one of them is in it."""
    is_changed = False
    for seat in range(schedule.size[task]):
        robot = schedule.coalition[task, seat]
        if robot == one:
            schedule.coalition[task, seat] = two
            is_changed = True
        elif robot == two:
            schedule.coalition[task, seat] = one
            is_changed = True
    return is_changed


@kernel
def _is_covered(base: CoalitionProblem, schedule: LinkedSchedule, task: int) -> bool:
    """Say whether a coalition brings what its task needs."""
    for cap in range(base.needs.shape[1]):
        lacking = base.needs[task, cap]
        for seat in range(schedule.size[task]):
            lacking -= base.counts[schedule.coalition[task, seat], cap]
        if lacking > 0:
            return False
    return True
