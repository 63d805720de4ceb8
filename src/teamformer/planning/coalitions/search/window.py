"""Judging a change to a window of the order, mostly without playing what comes after it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.jit import kernel
from teamformer.planning.coalitions.problem import NEVER, NOBODY, CoalitionProblem, Ticks, Whole
from teamformer.planning.coalitions.search.coalition_choice import (
    pick_earliest,
    pick_shortest_chain,
)
from teamformer.planning.coalitions.search.schedule import cost_of, hang_tails, leave, time_from

if TYPE_CHECKING:
    from teamformer.planning.coalitions.search.schedule import Schedule
    from teamformer.rules.arrays import Array

Flags = npt.NDArray[np.bool_]
RandomState = npt.NDArray[np.uint64]

KEEP, GIVEN, EARLIEST_COALITION, SHORTEST_CHAIN = range(4)
"""What becomes of the coalition of a desk's task: as it is, as picked, or picked in its turn."""

REFUSED = NEVER


class Desk(NamedTuple):
    """A change at hand, and room to judge it in."""

    span: Whole  # (2,) first and last position of the window
    window: Whole  # (tasks,) the tasks there, in their new order
    subject: Whole  # (2,) the task whose coalition changes, or NOBODY, and how
    pick: Whole  # (robots,) its new coalition
    picks: Whole  # (1,) how many these are
    short: Whole  # (caps,) what it still lacks
    clock: Ticks  # (1,) number of the change
    seen: Ticks  # (robots,) the change that a robot was last loaded for
    place: Whole  # (robots,) where those robots are
    free: Ticks  # (robots,) since when
    timed: Ticks  # (tasks,) the change that a task was last timed for
    end: Ticks  # (tasks,) when those tasks end
    has_due: Flags  # (1,) whether any task has a due time
    random: RandomState  # (1,) state of the random numbers


def empty_desk(problem: CoalitionProblem, seed: int) -> Desk:
    """Return room to work in, with the random numbers seeded."""
    (tasks, caps), robots = problem.needs.shape, len(problem.counts)
    return Desk(
        span=np.zeros(2, np.int32),
        window=np.zeros(tasks, np.int32),
        subject=np.array([NOBODY, KEEP], np.int32),
        pick=np.zeros(robots, np.int32),
        picks=np.zeros(1, np.int32),
        short=np.zeros(caps, np.int32),
        clock=np.zeros(1, np.int64),
        seen=np.full(robots, -1, np.int64),
        place=np.zeros(robots, np.int32),
        free=np.zeros(robots, np.int64),
        timed=np.full(tasks, -1, np.int64),
        end=np.zeros(tasks, np.int64),
        has_due=np.array([(problem.due < NEVER).any()]),
        random=np.array([seed * 2654435761 + 88172645463325252], np.uint64),
    )


@kernel
def judge_window(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, limit: int, allowed: int
) -> int:
    """Return what the plan would cost, or REFUSED if more than `allowed`.

    Refuses at once if a chain through the window is longer than `limit`.
    """
    if not _play_window(problem, schedule, desk, limit):
        return REFUSED
    if not _can_leave(problem, schedule, desk, limit):
        return REFUSED
    return _play_on(problem, schedule, desk, limit, allowed)


@kernel
def _load(schedule: Schedule, desk: Desk, robot: int) -> None:
    """Have a robot stand where it is before the window."""
    if desk.seen[robot] != desk.clock[0]:
        desk.seen[robot] = desk.clock[0]
        place = schedule.last[desk.span[0], robot]
        desk.place[robot] = place
        desk.free[robot] = schedule.end[place]


@kernel
def _release(problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int) -> int:
    """Return when a task may start, whoever is there; REFUSED if one before it comes later."""
    start, (begin, finish) = problem.release[task], desk.span
    if problem.before[task, 0] != NOBODY:
        for other in problem.before[task]:
            if other == NOBODY:
                break
            if desk.timed[other] == desk.clock[0]:
                start = max(start, desk.end[other])
            elif begin <= schedule.rank[other] <= finish:
                return REFUSED
            else:
                start = max(start, schedule.end[other])
    return start


@kernel
def _serve(
    problem: CoalitionProblem, desk: Desk, task: int, coalition: Array, size: int, start: int
) -> int:
    """Let a coalition, loaded before, do a task; return when it starts."""
    there, comes_apart = 0, False
    for seat in range(size):
        robot = coalition[seat]
        way = problem.ways[problem.pace[robot], desk.place[robot], task]
        there = max(there, desk.free[robot] + way)
        comes_apart |= problem.site[desk.place[robot]] != problem.site[desk.place[coalition[0]]]
    start = max(start, there + problem.forming[0] * comes_apart)
    end = start + problem.duration[task]
    for seat in range(size):
        robot = coalition[seat]
        desk.place[robot] = task
        desk.free[robot] = end
    desk.end[task] = end
    desk.timed[task] = desk.clock[0]
    return start


@kernel
def _play_window(problem: CoalitionProblem, schedule: Schedule, desk: Desk, limit: int) -> bool:
    """Play the window; say whether it may be done so, and nothing in it ends after the limit."""
    plan = schedule.plan
    desk.clock[0] += 1
    begin, finish = desk.span
    for position in range(finish - begin + 1):
        task = desk.window[position]
        start = _release(problem, schedule, desk, task)
        if start >= REFUSED:
            return False
        if task == desk.subject[0] and desk.subject[1] != KEEP:
            for seat in range(plan.size[task]):
                _load(schedule, desk, plan.coalition[task, seat])
            if not _pick(problem, schedule, desk, task, start):
                return False
            for seat in range(desk.picks[0]):
                _load(schedule, desk, desk.pick[seat])
            _serve(problem, desk, task, desk.pick, desk.picks[0], start)
        else:
            for seat in range(plan.size[task]):
                _load(schedule, desk, plan.coalition[task, seat])
            _serve(problem, desk, task, plan.coalition[task], plan.size[task], start)
        if desk.end[task] > limit:
            return False
    return True


@kernel
def _pick(problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int, start: int) -> bool:
    """Pick the subject's coalition, if that is still to be done; say whether there is one."""
    if desk.subject[1] == EARLIEST_COALITION:
        return pick_earliest(problem, schedule, desk, task, start)
    if desk.subject[1] == SHORTEST_CHAIN:
        return pick_shortest_chain(problem, schedule, desk, task, start)
    return True


@kernel
def _can_leave(problem: CoalitionProblem, schedule: Schedule, desk: Desk, limit: int) -> bool:
    """Say whether no chain that leaves the window is longer than the limit."""
    begin, finish = desk.span
    for robot in range(len(desk.seen)):
        if desk.seen[robot] == desk.clock[0]:
            chain = leave(problem, schedule, robot, desk.place[robot], finish + 1)
            if desk.free[robot] + chain > limit:
                return False
    for position in range(finish - begin + 1):
        task = desk.window[position]
        if problem.after[task, 0] != NOBODY:
            for other in problem.after[task]:
                if other == NOBODY:
                    break
                is_beyond = schedule.rank[other] > finish
                if is_beyond and desk.end[task] + schedule.tail[other] > limit:
                    return False
    return True


@kernel
def _play_on(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, limit: int, allowed: int
) -> int:
    """Play what comes after the window, as far as it changes; return the cost of all."""
    order, coalition, size = schedule.plan
    tasks, robots, clock = len(order), len(desk.seen), desk.clock[0]
    for position in range(desk.span[1] + 1, tasks):
        task, is_touched = order[position], False
        for seat in range(size[task]):
            is_touched |= desk.seen[coalition[task, seat]] == clock
        if not is_touched and problem.before[task, 0] != NOBODY:
            for other in problem.before[task]:
                if other == NOBODY:
                    break
                is_touched |= desk.timed[other] == clock
        if not is_touched:
            continue
        for seat in range(size[task]):
            _load(schedule, desk, coalition[task, seat])
        release = _release(problem, schedule, desk, task)
        start = _serve(problem, desk, task, coalition[task], size[task], release)
        if start + schedule.tail[task] > limit:
            return REFUSED
    makespan, back_sum, late = 0, 0, 0
    for robot in range(robots):
        if desk.seen[robot] == clock:
            place, back = desk.place[robot], desk.free[robot]
        else:
            place = schedule.last[tasks, robot]
            back = schedule.end[place]
        back += problem.home[problem.kind[robot], place]
        back_sum += back
        makespan = max(makespan, back)
    if desk.has_due[0]:
        for task in range(tasks):
            end = desk.end[task] if desk.timed[task] == clock else schedule.end[task]
            late += max(0, end - problem.due[task])
    cost = cost_of(makespan, back_sum, late, robots)
    return cost if cost <= allowed else REFUSED


@kernel
def commit_window(problem: CoalitionProblem, schedule: Schedule, desk: Desk) -> None:
    """Make the change that was judged."""
    plan, (begin, finish) = schedule.plan, desk.span
    for position in range(finish - begin + 1):
        plan.order[begin + position] = desk.window[position]
    if desk.subject[1] != KEEP:
        task = desk.subject[0]
        plan.size[task] = desk.picks[0]
        for seat in range(desk.picks[0]):
            plan.coalition[task, seat] = desk.pick[seat]
    time_from(problem, schedule, begin)
    hang_tails(problem, schedule, finish)
