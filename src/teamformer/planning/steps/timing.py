"""When everything in a plan is done if it is played step by step, forming counted.

Robots that have done a task together are a group and stay one as long as they go the same way. A
group whose robots part pays one forming for each further way, the way of the earlier task first;
who has nothing to do on it, or nothing at all, stays behind. Groups that meet at a task pair up
there, one joining a step, until they are one team. A group that comes past a task that it can do
does it, and so does a team that can do more where it stands. So any order with any able
coalitions is a plan that cannot block.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.prices import SHARES, SMOOTH
from teamformer.planning.problem.relaxed_problem import Relaxed, pace_together, way_number
from teamformer.planning.steps.crossings import Crossings
from teamformer.world.rules.constants import FAR, NOBODY, ROUNDING
from teamformer.world.rules.pairing import pair_off

STEP = 200
"""What a step of makespan costs, for each task."""
STEP_OF_END = 30
"""What a step of the end of any task costs a search: it leads out of plateaus."""
STEP_WALKED = 1
"""What a step walked by a robot costs a search, so that nobody trails along without use."""
LATE = 10_000
"""Steps of makespan that a robot lost before its task's end is worth."""


class Groups(NamedTuple):
    """Room to time a plan in; a group has the number of its last task, or tasks + its leader."""

    company: Array  # (robots,) the lowest robot of the team it is in at the start
    forming: Array  # (1,) steps that a split costs
    losses: Array  # (1,) whether robots will be lost, and it is known when
    of: Array  # (robots,) group
    start: Array  # (tasks,) the step in which its service begins
    end: Array  # (groups,) the step in which its last task is done
    free: Array  # (groups,) the step in which all that it serves there is done
    size: Array  # (groups,) robots in it that have not gone on
    splits: Array  # (groups,)
    pace: Array  # (groups,) the slowest of those that leave together
    leaving: Array  # (groups,) how many these are
    until: Array  # (groups,) the step until which these are busy on the way
    seen: Array  # (groups,) the last task that it took part in
    touched: Array  # (robots,) groups that take part in the task at hand
    arrive: Array  # (robots,) when they get there
    is_done: Array  # (tasks,)
    passed_to: Array  # (tasks,) the task that a group headed for when it did this one, or NOBODY
    passed_from: Array  # (tasks,) that group
    passes: Array  # (1,) how many tasks are done on the way to others
    too_early: Array  # (4,) a task passed before it is done, where that leads, the group, the step
    spare: Array  # (2,) a task that can be done without some group that comes to it, and that group
    moved: Array  # (tasks,) the tasks in the order in which they are done, as it is worked out
    spares: Array  # (robots,) those of a coalition that it can do without


def empty_groups(problem: Relaxed, company: Array, forming_steps: int) -> Groups:
    """Return room to time plans of a fleet in; `company` is the lowest robot of each one's team."""
    tasks, robots = len(problem.appears), len(problem.pace)
    by_task, by_robot, by_group = tasks, robots, tasks + robots
    return Groups(
        company=company.astype(np.int32),
        forming=np.array([forming_steps], np.int32),
        losses=np.array([problem.lost.min() < FAR]),
        of=np.zeros(by_robot, np.int32),
        start=np.zeros(by_task, np.int32),
        end=np.zeros(by_group, np.int32),
        free=np.zeros(by_group, np.int32),
        size=np.zeros(by_group, np.int32),
        splits=np.zeros(by_group, np.int32),
        pace=np.zeros(by_group, np.int32),
        leaving=np.zeros(by_group, np.int32),
        until=np.zeros(by_group, np.int32),
        seen=np.zeros(by_group, np.int32),
        touched=np.zeros(by_robot, np.int32),
        arrive=np.zeros(by_robot, np.int32),
        is_done=np.zeros(by_task, np.bool_),
        passed_to=np.zeros(by_task, np.int32),
        passed_from=np.zeros(by_task, np.int32),
        passes=np.zeros(1, np.int32),
        too_early=np.zeros(4, np.int32),
        spare=np.zeros(2, np.int32),
        moved=np.zeros(by_task, np.int32),
        spares=np.zeros(by_robot, np.int32),
    )


@entry
def time_plan(
    problem: Relaxed, crossings: Crossings, plan: CoalitionPlan, groups: Groups
) -> tuple[Any, Any]:
    """Return what a plan costs, and the same with what leads a search; both are whole numbers.

    That is the makespan or, where a mission has prices, what these make of it. Leaves in `groups`
    each task's start and end, the task it waited for, and what was done on the way.
    """
    _gather_at_start(problem, groups)
    tasks, has_prices = len(plan.order), len(problem.prices.due) > 0
    step = problem.prices.whole[0] if has_prices else np.int64(STEP * tasks)
    makespan, total, walked = np.int64(0), np.int64(0), np.int64(0)
    for position in range(tasks):
        task = plan.order[position]
        if not groups.is_done[task]:
            walked += _meet(problem, crossings, plan, groups, task)
            makespan = max(makespan, groups.free[task])
        total += groups.end[task]
    cost, everything, smooth = step * makespan, np.int64(STEP * tasks), np.int64(STEP_OF_END)
    if has_prices:
        cost += _price_of_ends(problem, groups)
        everything, smooth = np.int64(SHARES * tasks), np.int64(SMOOTH)
    if groups.losses[0]:
        cost += LATE * everything * _count_late(problem, plan, groups)
    return cost, cost + smooth * total + STEP_WALKED * walked


@kernel
def _price_of_ends(problem: Relaxed, groups: Groups) -> int:
    """Return what it costs when tasks end, and by how much they are late."""
    prices, price, latest = problem.prices, np.int64(0), np.int64(0)
    for task in range(len(prices.due)):
        late = max(0, groups.end[task] - prices.due[task])
        price += prices.ends[task] * groups.end[task] + prices.late[task] * late
        latest = max(latest, late)
    return price + prices.whole[1] * latest


@kernel
def _count_late(problem: Relaxed, plan: CoalitionPlan, groups: Groups) -> int:
    """Return how many robots are lost before the end of a task that they are planned for."""
    late = 0
    for task in range(len(plan.order)):
        for seat in range(plan.size[task]):
            late += groups.end[task] >= problem.lost[plan.coalition[task, seat]]
    return late


@kernel
def _gather_at_start(problem: Relaxed, groups: Groups) -> None:
    tasks = len(problem.duration)
    for group in range(len(groups.end)):
        groups.size[group] = groups.splits[group] = 0
        groups.seen[group] = NOBODY
    for robot in range(len(groups.of)):
        group = tasks + groups.company[robot]
        groups.of[robot] = group
        groups.size[group] += 1
        groups.end[group] = groups.free[group] = problem.ready[robot]
    for task in range(tasks):
        groups.is_done[task] = False
        groups.passed_to[task] = NOBODY
    groups.passes[0] = 0
    groups.too_early[0] = groups.spare[0] = NOBODY


@kernel
def _meet(
    problem: Relaxed, crossings: Crossings, plan: CoalitionPlan, groups: Groups, task: int
) -> Any:
    """Bring a task's coalition together and let it do it; return the steps that robots walk."""
    count, walked = 0, np.int64(0)
    for seat in range(plan.size[task]):
        robot = plan.coalition[task, seat]
        group = groups.of[robot]
        if groups.seen[group] != task:
            groups.seen[group] = task
            groups.pace[group] = problem.pace[robot]
            groups.leaving[group] = 0
            groups.touched[count] = group
            count += 1
        groups.pace[group] = pace_together(problem, groups.pace[group], problem.pace[robot])
        groups.leaving[group] += 1
    until, pace = 0, groups.pace[groups.touched[0]]
    for place in range(count):
        group = groups.touched[place]
        pace = pace_together(problem, pace, groups.pace[group])
        groups.size[group] -= groups.leaving[group]
        groups.splits[group] += groups.size[group] > 0
        leave = groups.free[group] + groups.splits[group] * groups.forming[0]
        arrival = _walk(problem, crossings, plan, groups, group, task, leave)
        walked += (arrival - leave) * groups.leaving[group]
        until = max(until, groups.until[group])
        if count > 1:
            arrival = max(arrival, groups.until[group])
        gap = place
        while gap > 0 and groups.arrive[gap - 1] > arrival:
            groups.arrive[gap], groups.touched[gap] = (
                groups.arrive[gap - 1],
                groups.touched[gap - 1],
            )
            gap -= 1
        groups.arrive[gap], groups.touched[gap] = arrival, group
    if count > 1:
        _note_spare_group(problem, plan, groups, task, count)
    start = max(pair_off(groups.arrive, count), _opens(problem, groups, task))
    groups.start[task] = start
    groups.end[task] = start + problem.duration[task]
    if problem.carry[task] > 0:
        groups.end[task] += problem.steps[pace, problem.carry[task]] - problem.quickest[task]
    groups.free[task] = max(until, groups.end[task])
    groups.is_done[task] = True
    groups.size[task] = plan.size[task]
    for seat in range(plan.size[task]):
        groups.of[plan.coalition[task, seat]] = task
    if len(crossings.task) > 0:
        _do_what_is_here(problem, crossings, plan, groups, task)
    return walked


@kernel
def _opens(problem: Relaxed, groups: Groups, task: int) -> Any:
    """Return the first step in which a task may start; FAR if one before it is not done yet."""
    opens = problem.appears[task] + 1
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if not groups.is_done[other]:
            return FAR
        opens = max(opens, groups.end[other] + 1)
    return opens


@kernel
def _note_spare_group(
    problem: Relaxed, plan: CoalitionPlan, groups: Groups, task: int, count: int
) -> None:
    """Note the last to come of those groups without which a task can be done: it would be."""
    for place in range(count - 1, -1, -1):
        if _can_do(problem, plan, groups, groups.touched[place], task, task, is_with=False):
            groups.spare[0], groups.spare[1] = task, groups.touched[place]
            return


@kernel
def _can_do(
    problem: Relaxed,
    plan: CoalitionPlan,
    groups: Groups,
    group: int,
    task: int,
    other: int,
    is_with: bool = True,
) -> bool:
    """Say whether the robots of a group that go to a task can do another one.

    Or, if not `is_with`, those that go there and are not of the group.
    """
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[other, cap]
        if lacking > 0:
            for seat in range(plan.size[task]):
                robot = plan.coalition[task, seat]
                if (groups.of[robot] == group) == is_with:
                    lacking -= problem.counts[robot, cap]
            if lacking > 0:
                return False
    return True


@kernel
def is_settled(groups: Groups) -> bool:
    """Say whether everything in the plan timed last is done by those who are planned for it."""
    is_passed = groups.passes[0] > 0 or groups.too_early[0] != NOBODY
    return not is_passed and groups.spare[0] == NOBODY


@kernel
def _walk(
    problem: Relaxed,
    crossings: Crossings,
    plan: CoalitionPlan,
    groups: Groups,
    group: int,
    task: int,
    leave: int,
) -> Any:
    """Let the part of a group that leaves walk to a task; return when it is there.

    It does what it can do on the way. Leaves in `groups.until` when that is done too.
    """
    pace, cells, way = (
        groups.pace[group],
        way_number(problem, group, task),
        group * len(plan.order) + task,
    )
    rank = pace  # of its speed
    if len(problem.lengths) > 1:
        speeds = len(problem.steps) // 2
        if pace >= speeds:
            rank -= speeds
            way += len(plan.order) * len(groups.end)
        cells = problem.lengths[int(pace >= speeds), cells]
    since, passed = leave, 0  # it walks on from the cell after so many, since then
    here, came, until = NOBODY, leave, leave  # the cell where it does something, and until when
    if len(crossings.task) > 0:
        for index in range(crossings.first[way], crossings.first[way + 1]):
            other, away = crossings.task[index], crossings.cells[index]
            if away != here:
                came = since + _steps_of(problem, crossings, rank, away - passed)
            is_late = groups.is_done[other] and groups.start[other] <= came
            if is_late or came < _opens(problem, groups, other):
                continue
            if away != cells and not _is_stop(crossings.speeds[rank], away - passed):
                continue
            if not _can_do(problem, plan, groups, group, task, other):
                continue
            if groups.is_done[other]:
                _note_too_early(groups, group, task, other, came)
                continue
            _do_on_the_way(groups, group, task, other, came, came + problem.duration[other])
            is_planned = away == cells and _is_crew(plan, groups, group, task, other)
            groups.passes[0] += not is_planned
            if problem.duration[other] > 0:
                until = max(until, came + problem.duration[other])
                since, passed, here = until, away, away
    groups.until[group] = until
    if here == cells:
        return came
    if passed == 0 and len(problem.lengths) > 1:
        return since + problem.steps[pace, way_number(problem, group, task)]
    return since + _steps_of(problem, crossings, rank, cells - passed)


@kernel
def _steps_of(problem: Relaxed, crossings: Crossings, rank: int, cells: int) -> int:
    """Return the steps that some cells take, walked or flown, by the rank of the speed."""
    if len(problem.lengths) == 1:
        return problem.steps[rank, cells]
    return int(np.ceil(cells / crossings.speeds[rank] - ROUNDING))


@kernel
def _is_stop(speed: float, cells: int) -> bool:
    """Say whether a team that has left so many cells ago ends a step there."""
    steps = np.ceil(cells / speed - 1e-9)
    return np.floor(steps * speed + 1e-9) == cells


@kernel
def _do_on_the_way(groups: Groups, group: int, task: int, other: int, start: int, end: int) -> None:
    groups.is_done[other] = True
    groups.start[other], groups.end[other] = start, end
    groups.passed_to[other], groups.passed_from[other] = task, group


@kernel
def _note_too_early(groups: Groups, group: int, task: int, other: int, step: int) -> None:
    groups.too_early[0], groups.too_early[1] = other, task
    groups.too_early[2], groups.too_early[3] = group, step


@kernel
def _do_what_is_here(
    problem: Relaxed, crossings: Crossings, plan: CoalitionPlan, groups: Groups, task: int
) -> None:
    """Let the team that does a task do all else that it can do there, at the same time."""
    start = groups.start[task]
    way = task * len(plan.order) + task
    for index in range(crossings.first[way], crossings.first[way + 1]):
        other = crossings.task[index]
        is_late = groups.is_done[other] and groups.start[other] <= start
        if is_late or start < _opens(problem, groups, other):
            continue
        if not _can_do(problem, plan, groups, task, task, other):
            continue
        if groups.is_done[other]:
            _note_too_early(groups, task, task, other, start)
            continue
        groups.passes[0] += not _is_crew(plan, groups, task, task, other)
        end = start + problem.duration[other]
        _do_on_the_way(groups, task, task, other, start, end)
        groups.free[task] = max(groups.free[task], end)


@kernel
def _is_crew(plan: CoalitionPlan, groups: Groups, group: int, task: int, other: int) -> bool:
    """Say whether another task is planned for those who do one, all of them from one group."""
    if plan.size[task] != plan.size[other]:
        return False
    for seat in range(plan.size[task]):
        is_of_group = groups.of[plan.coalition[task, seat]] == group
        if not is_of_group or groups.of[plan.coalition[other, seat]] != group:
            return False
    return True
