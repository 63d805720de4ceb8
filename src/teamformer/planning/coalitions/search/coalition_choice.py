"""Picking a coalition for a task in its turn: who is there first, nobody earlier than needed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.jit import kernel
from teamformer.planning.coalitions.problem import NOBODY
from teamformer.planning.coalitions.search.schedule import leave
from teamformer.planning.relaxation.insertion import draw_below

if TYPE_CHECKING:
    from teamformer.planning.coalitions.problem import CoalitionProblem
    from teamformer.planning.coalitions.search.schedule import Schedule
    from teamformer.planning.coalitions.search.window import Desk

BLINK = 16
"""Every so many robots one is overlooked, so that the search does not always see the same."""


@kernel
def arrival(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, robot: int, task: int
) -> int:
    """Return when a robot can be at a task, after what it has done in the window so far."""
    if desk.seen[robot] == desk.clock[0]:
        place, free = desk.place[robot], desk.free[robot]
    else:
        place = schedule.last[desk.span[0], robot]
        free = schedule.end[place]
    return free + problem.ways[problem.pace[robot], place, task]


@kernel
def is_picked(desk: Desk, robot: int) -> bool:
    """Say whether a robot is in the coalition at hand."""
    for seat in range(desk.picks[0]):
        if desk.pick[seat] == robot:
            return True
    return False


@kernel
def count_short(problem: CoalitionProblem, desk: Desk, task: int) -> int:
    """Work out what the coalition at hand lacks; say whether it is anything."""
    is_short = False
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[task, cap]
        if lacking > 0:
            for seat in range(desk.picks[0]):
                lacking -= problem.counts[desk.pick[seat], cap]
        desk.short[cap] = lacking
        is_short |= lacking > 0
    return is_short


@kernel
def pick_earliest(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int, start: int
) -> bool:
    """Pick the coalition that can start earliest, going by one capability after another."""
    desk.picks[0] = 0
    return cover(problem, schedule, desk, task) and give_way(problem, schedule, desk, task, start)


@kernel
def give_way(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int, start: int
) -> bool:
    """Let members give their place to the like robot that comes last of those still in time."""
    for seat in range(desk.picks[0]):
        start = max(start, arrival(problem, schedule, desk, desk.pick[seat], task))
    for seat in range(desk.picks[0]):
        robot = desk.pick[seat]
        latest = arrival(problem, schedule, desk, robot, task)
        for other in problem.like[problem.kind[robot]]:
            if other == NOBODY:
                break
            comes = arrival(problem, schedule, desk, other, task)
            if latest < comes <= start and not is_picked(desk, other):
                desk.pick[seat], latest = other, comes
    return True


@kernel
def cover(problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int) -> bool:
    """Add the robots that come first for what the coalition at hand lacks; say if it is enough."""
    while count_short(problem, desk, task):
        best, earliest = NOBODY, 0
        for robot in problem.able[draw_short(problem, desk)]:
            if robot == NOBODY:
                break
            if is_picked(desk, robot):
                continue
            comes = arrival(problem, schedule, desk, robot, task)
            if best == NOBODY or (comes < earliest and draw_below(desk.random, BLINK) > 0):
                best, earliest = robot, comes
        if best == NOBODY:
            return False
        desk.pick[desk.picks[0]] = best
        desk.picks[0] += 1
    drop_spare(problem, desk, task)
    return True


@kernel
def pick_shortest_chain(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int, start: int
) -> bool:
    """Pick the coalition whose longest chain through the task is shortest, robot by robot.

    The chain goes on after the window: what a robot still has to do there is known.
    """
    desk.picks[0] = 0
    beyond, home = desk.span[1] + 1, 0
    while count_short(problem, desk, task):
        best, least, best_comes, best_leaves = NOBODY, 0, 0, 0
        for robot in problem.able[draw_short(problem, desk)]:
            if robot == NOBODY:
                break
            if is_picked(desk, robot):
                continue
            comes = max(start, arrival(problem, schedule, desk, robot, task))
            leaves = max(home, leave(problem, schedule, robot, task, beyond))
            is_shorter = comes + leaves < least and draw_below(desk.random, BLINK) > 0
            if best == NOBODY or is_shorter:
                best, least, best_comes, best_leaves = robot, comes + leaves, comes, leaves
        if best == NOBODY:
            return False
        desk.pick[desk.picks[0]] = best
        desk.picks[0] += 1
        start, home = best_comes, best_leaves
    drop_spare(problem, desk, task)
    return True


@kernel
def draw_short(problem: CoalitionProblem, desk: Desk) -> int:
    """Draw a capability that the coalition at hand lacks."""
    caps = problem.needs.shape[1]
    cap = draw_below(desk.random, caps)
    while desk.short[cap] <= 0:
        cap = (cap + 1) % caps
    return cap


@kernel
def drop_spare(problem: CoalitionProblem, desk: Desk, task: int) -> None:
    """Drop members that the coalition at hand does not need, earlier picks first."""
    seat = 0
    while seat < desk.picks[0]:
        if _is_spare(problem, desk, task, seat):
            desk.picks[0] -= 1
            for later in range(seat, desk.picks[0]):
                desk.pick[later] = desk.pick[later + 1]
        else:
            seat += 1


@kernel
def _is_spare(problem: CoalitionProblem, desk: Desk, task: int, seat: int) -> bool:
    robot = desk.pick[seat]
    for cap in range(problem.needs.shape[1]):
        if problem.needs[task, cap] > 0 and problem.counts[robot, cap] > 0:
            has = 0
            for other in range(desk.picks[0]):
                has += problem.counts[desk.pick[other], cap]
            if has - problem.counts[robot, cap] < problem.needs[task, cap]:
                return False
    return True
