"""Futures by a rule without search: next comes the task that can begin soonest, by whom.

What is left of a mission is played out by this rule, from any state. Tasks can be put back, each by
its own handicap, so that futures differ. Robots that are there first do a task, none of them spare.
"""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Int32s, Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.dispatch.groups import (
    are_linked,
    begun_group,
    is_taken,
    may_begin,
    opens,
    time_next,
)
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.rotas import fits, fits_all, have_shifts
from teamformer.planning.problem.schedule import arrival, empty_schedule, stand_at_start
from teamformer.world.rules.chance import draw

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.problem.schedule import Schedule

NOISE = 2
"""A task is put back by up to what a task takes a robot, divided by this."""

SCARCE = 2
"""What needs the scarcest capability comes sooner, by up to so many times what a task takes."""


SHY = 1
"""A robot counts as coming later by up to so many times what a task takes it."""


TOO_LATE = 2
"""When tasks have their turn that end too late, after those that must be done and optional ones."""

FEW = 4
"""Where the rule finds no plan, it is tried again with everything put back by up to so many tasks
at random."""


class Calls(NamedTuple):
    """Who would do each open task next, and when; and by how much each is put back."""

    begin: Ints  # (tasks,) when it can begin; NEVER if it lacks something
    team: Int32s  # (tasks, robots) who does it then
    size: Int32s  # (tasks,) how many these are
    is_stale: npt.NDArray[np.bool_]  # (tasks,) worked out before somebody of the team went on
    handicap: Ints  # (tasks,) ticks that it is put back by; less than 0 if it comes sooner
    scarcity: Ints  # (tasks,) of the scarcest capability that it needs, in 1024ths of the most
    reserve: Ints  # (robots,) ticks that each counts as coming later, as it is wanted elsewhere
    short: Int32s  # (caps,) room to work in: what a team still lacks
    random: npt.NDArray[np.uint64]  # (1,) state of the random numbers


def empty_calls(problem: CoalitionProblem, seed: int) -> Calls:
    """Return room to play futures in, with the random numbers seeded and nobody put back."""
    robots, caps = problem.counts.shape
    tasks = len(problem.needs)
    load = problem.needs.sum(axis=0) / np.maximum(1, problem.counts.sum(axis=0))  # (caps,)
    scarcest = np.where(problem.needs > 0, load, 0.0).max(axis=1, initial=0.0)  # (tasks,)
    return Calls(
        begin=np.zeros(tasks, np.int64),
        team=np.full((tasks, robots), NOBODY, np.int32),
        size=np.zeros(tasks, np.int32),
        is_stale=np.ones(tasks, np.bool_),
        handicap=np.zeros(tasks, np.int64),
        scarcity=(1024 * scarcest / max(1e-9, load.max(initial=0.0))).astype(np.int64),
        reserve=np.zeros(robots, np.int64),
        short=np.zeros(caps, np.int32),
        random=np.array([seed * 2654435761 + 88172645463325252], np.uint64),
    )


def first_plan(problem: CoalitionProblem, draws: Random | None = None) -> CoalitionPlan | None:
    """Return the plan of the rule alone; None if nobody is left for some task.

    With `draws` tasks and robots are put back by what a few tasks take at most.
    """
    schedule, calls = empty_schedule(problem), empty_calls(problem, 0)
    if draws is not None:
        most = FEW * leg_of(problem)
        calls.handicap[:] = [int(draws.random() * most) for _ in calls.handicap]
        calls.reserve[:] = [int(draws.random() * most) for _ in calls.reserve]
    begin_dispatch(problem, schedule)
    return schedule.plan if play_out(problem, schedule, calls, 0) else None


def leg_of(problem: CoalitionProblem) -> int:
    """Return the ticks that a task takes a robot, with the way there."""
    paces = 1 + problem.pace[: problem.bodies].max()
    return int(problem.duration.mean() + np.median(problem.ways[:paces]))


@entry
def begin_dispatch(problem: CoalitionProblem, schedule: Schedule) -> None:
    """Open all tasks, with all robots where they start."""
    stand_at_start(problem, schedule)
    take_back(schedule, 0)


@entry
def play_out(problem: CoalitionProblem, schedule: Schedule, calls: Calls, begin: int) -> bool:
    """Give out the tasks from a position on; say whether all have found robots that can do them."""
    for task in range(len(schedule.rank)):
        calls.is_stale[task] = True
    for position in range(begin, len(schedule.rank)):
        task = soonest(problem, schedule, calls, position)
        if task == NOBODY:
            return False
        have_done(problem, schedule, calls, task, position)
    return True


@kernel
def do_not_put_back(calls: Calls) -> None:
    """Have the rule played out as it is."""
    for task in range(len(calls.handicap)):
        calls.handicap[task] = 0
    for robot in range(len(calls.reserve)):
        calls.reserve[robot] = 0


@kernel
def put_back(calls: Calls, leg: int) -> None:
    """Draw by how much each task is put back in a future, and each robot held back."""
    haste = draw(calls.random) * SCARCE * leg / 1024
    shyness = max(0.0, 2 * draw(calls.random) - 1) * leg * SHY  # in every other future
    for robot in range(len(calls.reserve)):
        calls.reserve[robot] = int(shyness * draw(calls.random))
    for task in range(len(calls.handicap)):
        noise = draw(calls.random) * leg / NOISE
        calls.handicap[task] = int(noise - haste * calls.scarcity[task])


@kernel
def soonest(problem: CoalitionProblem, schedule: Schedule, calls: Calls, position: int) -> int:
    """Return the task that comes next at a position of the order; NOBODY if none can be done.

    Where tasks can be missed, first come those that must be done and can be in time, then others
    that can be.
    """
    best, least, first = NOBODY, NEVER, TOO_LATE
    linked = are_linked(problem)
    group = begun_group(problem, schedule) if linked else NOBODY
    for task in range(len(schedule.rank)):
        if not is_ready(problem, schedule, task):
            continue
        if linked and group != NOBODY and problem.links.group[task] != group:
            continue
        if linked and group == NOBODY and not may_begin(problem, schedule, task):
            continue
        if calls.is_stale[task]:
            call(problem, schedule, calls, task, position)
        turn, begin = _turn(problem, calls, task), calls.begin[task] + calls.handicap[task]
        if calls.begin[task] < NEVER and (turn < first or (turn == first and begin < least)):
            best, least, first = task, begin, turn
    return best


@kernel
def _turn(problem: CoalitionProblem, calls: Calls, task: int) -> int:
    """Return when a task has its turn if it begins as soon as it can: the least first."""
    if len(problem.misses.until) == 0:
        return TOO_LATE
    if calls.begin[task] + problem.duration[task] > problem.misses.until[0]:
        return TOO_LATE
    return int(problem.misses.optional[task])


@kernel
def is_ready(problem: CoalitionProblem, schedule: Schedule, task: int) -> bool:
    """Say whether a task is not planned while all that come before it are; others have no rank."""
    tasks = len(schedule.rank)
    if schedule.rank[task] < tasks:
        return False
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if schedule.rank[other] == tasks:
            return False
    return True


@kernel
def call(
    problem: CoalitionProblem, schedule: Schedule, calls: Calls, task: int, position: int
) -> None:
    """Find who would do a task next: those who are there first, none of them spare; and when.

    Who carries a load more slowly counts as coming so much later, and so does who is held back. Who
    works in shifts is there once the task fits into one.
    """
    calls.is_stale[task], calls.size[task], calls.begin[task] = False, 0, NEVER
    begin = opens(problem, schedule, task)
    for cap in range(problem.needs.shape[1]):
        calls.short[cap] = problem.needs[task, cap]
    while True:
        best, earliest = NOBODY, NEVER
        for cap in range(problem.needs.shape[1]):
            if calls.short[cap] <= 0:
                continue
            for robot in problem.able[cap]:
                if robot == NOBODY:
                    break
                comes = arrival(problem, schedule, robot, task, position)
                if have_shifts(problem.rotas):
                    takes = problem.duration[task] + problem.slower[problem.pace[robot], task]
                    comes = fits(problem.rotas, problem.kind[robot], comes, takes)
                comes += problem.slower[problem.pace[robot], task] + calls.reserve[robot]
                is_first = comes < earliest or (comes == earliest and robot < best)
                if not is_first or _is_called(calls, task, robot):
                    continue
                if not is_taken(problem, schedule, task, robot):
                    best, earliest = robot, comes
        if best == NOBODY:
            break
        calls.team[task, calls.size[task]] = best
        calls.size[task] += 1
        begin = max(begin, earliest - calls.reserve[best])
        for cap in range(problem.needs.shape[1]):
            calls.short[cap] -= problem.counts[best, cap]
    for cap in range(problem.needs.shape[1]):
        if calls.short[cap] > 0:
            return
    _drop_spare(problem, calls, task)
    team, size = calls.team[task], calls.size[task]
    takes = problem.duration[task]
    calls.begin[task] = fits_all(problem.rotas, problem.kind, team, size, begin, takes)


@kernel
def _is_called(calls: Calls, task: int, robot: int) -> bool:
    for seat in range(calls.size[task]):
        if calls.team[task, seat] == robot:
            return True
    return False


@kernel
def _drop_spare(problem: CoalitionProblem, calls: Calls, task: int) -> None:
    """Drop those whom a task does not need, the last to come first; `calls.short` is below 0."""
    for seat in range(calls.size[task] - 1, -1, -1):
        robot, is_spare = calls.team[task, seat], True
        for cap in range(problem.needs.shape[1]):
            is_spare &= calls.short[cap] + problem.counts[robot, cap] <= 0 or (
                problem.needs[task, cap] == 0
            )
        if is_spare:
            for cap in range(problem.needs.shape[1]):
                calls.short[cap] += problem.counts[robot, cap]
            calls.size[task] -= 1
            for later in range(seat, calls.size[task]):
                calls.team[task, later] = calls.team[task, later + 1]


@kernel
def have_done(
    problem: CoalitionProblem, schedule: Schedule, calls: Calls, task: int, position: int
) -> None:
    """Have a task done next by those who are called for it; others may have to call anew."""
    plan, tasks = schedule.plan, len(schedule.rank)
    plan.order[position], plan.size[task] = task, calls.size[task]
    for seat in range(calls.size[task]):
        plan.coalition[task, seat] = calls.team[task, seat]
    time_next(problem, schedule, position)
    for other in range(tasks):
        if schedule.rank[other] < tasks or calls.is_stale[other]:
            continue
        if are_linked(problem):  # other robots do it, and it may be held
            calls.is_stale[other] |= problem.links.group[other] == problem.links.group[task]
        for seat in range(calls.size[task]):
            calls.is_stale[other] |= _is_called(calls, other, calls.team[task, seat])
        for before in problem.before[other]:
            if before == NOBODY:
                break
            calls.is_stale[other] |= before == task


@kernel
def have_done_as_in(
    problem: CoalitionProblem, schedule: Schedule, best: CoalitionPlan, position: int
) -> None:
    """Have a task done as in a plan."""
    plan, task = schedule.plan, best.order[position]
    plan.order[position], plan.size[task] = task, best.size[task]
    for seat in range(best.size[task]):
        plan.coalition[task, seat] = best.coalition[task, seat]
    time_next(problem, schedule, position)


@kernel
def take_back(schedule: Schedule, position: int) -> None:
    """Open the tasks again that were given out from a position on."""
    tasks = len(schedule.rank)
    for task in range(tasks):
        if schedule.rank[task] >= position:
            schedule.rank[task] = tasks


@entry
def take_back_from(schedule: Schedule, position: int) -> None:
    """Open the tasks again that were given out from a position on."""
    take_back(schedule, position)
