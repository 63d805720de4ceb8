"""Changes to a plan: tasks move in the order, robots between coalitions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.jit import kernel
from teamformer.planning.coalitions.problem import NOBODY
from teamformer.planning.coalitions.search.coalition_choice import (
    count_short,
    cover,
    draw_short,
    is_picked,
)
from teamformer.planning.coalitions.search.window import (
    EARLIEST_COALITION,
    GIVEN,
    KEEP,
    SHORTEST_CHAIN,
)
from teamformer.planning.relaxation.insertion import draw_below

if TYPE_CHECKING:
    from teamformer.planning.coalitions.problem import CoalitionProblem
    from teamformer.planning.coalitions.search.schedule import Schedule
    from teamformer.planning.coalitions.search.window import Desk

MOVES, EXCHANGES, REPLACEMENTS, EARLIEST = 30, 40, 60, 80  # percent, one upon the other
"""How many changes move a task, exchange two, replace a member, or move a task to a coalition
that is there earliest; the others move one to the coalition with the shortest chain through it."""


@kernel
def propose(problem: CoalitionProblem, schedule: Schedule, desk: Desk) -> bool:
    """Write a random change to the desk; say whether it comes to anything."""
    task = _draw_task(schedule, desk)
    desk.subject[0], desk.subject[1] = task, KEEP
    kind = draw_below(desk.random, 100)
    if kind < MOVES:
        return _move(schedule, desk, task, _draw_position(schedule, desk, task))
    if kind < EXCHANGES:
        return _exchange(schedule, desk, task, draw_below(desk.random, len(schedule.rank)))
    if kind < REPLACEMENTS:
        return _replace(problem, schedule, desk, task)
    desk.subject[1] = EARLIEST_COALITION if kind < EARLIEST else SHORTEST_CHAIN
    return _move(schedule, desk, task, _draw_position(schedule, desk, task), True)


@kernel
def _draw_task(schedule: Schedule, desk: Desk) -> int:
    """Draw a task, every other time one that the makespan hangs on."""
    count = schedule.criticals[0]
    if count > 0 and draw_below(desk.random, 2) == 0:
        return schedule.critical[draw_below(desk.random, count)]
    return schedule.plan.order[draw_below(desk.random, len(schedule.rank))]


@kernel
def _draw_position(schedule: Schedule, desk: Desk, task: int) -> int:
    """Draw where a task may go: half of the time past a neighbour in a route of its robots."""
    tasks, rank = len(schedule.rank), schedule.rank[task]
    if draw_below(desk.random, 2) == 0:
        return draw_below(desk.random, tasks)
    seat = draw_below(desk.random, schedule.plan.size[task])
    robot = schedule.plan.coalition[task, seat]
    if draw_below(desk.random, 2) == 0:
        beside = schedule.last[rank, robot]
    else:
        beside = schedule.next[rank + 1, robot]
    if beside == NOBODY or beside >= tasks:
        return rank
    return schedule.rank[beside]


@kernel
def _move(schedule: Schedule, desk: Desk, task: int, to: int, may_stay: bool = False) -> bool:
    """Move a task to a position of the order."""
    order, rank = schedule.plan.order, schedule.rank[task]
    if to == rank and not may_stay:
        return False
    desk.span[0], desk.span[1] = min(rank, to), max(rank, to)
    count = 0
    if to <= rank:
        desk.window[0] = task
        count = 1
    for position in range(desk.span[0], desk.span[1] + 1):
        if order[position] != task:
            desk.window[count] = order[position]
            count += 1
    if to > rank:
        desk.window[count] = task
    return True


@kernel
def _exchange(schedule: Schedule, desk: Desk, task: int, to: int) -> bool:
    """Exchange a task with the one at a position of the order."""
    order, rank = schedule.plan.order, schedule.rank[task]
    if to == rank:
        return False
    begin, finish = min(rank, to), max(rank, to)
    desk.span[0], desk.span[1] = begin, finish
    for position in range(begin, finish + 1):
        desk.window[position - begin] = order[position]
    desk.window[0], desk.window[finish - begin] = order[finish], order[begin]
    return True


@kernel
def _replace(problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int) -> bool:
    """Put a robot of the same kind, or whoever comes first, in the place of a member."""
    coalition, size = schedule.plan.coalition[task], schedule.plan.size[task]
    seat = draw_below(desk.random, size)
    robot = coalition[seat]
    _move(schedule, desk, task, schedule.rank[task], True)
    desk.subject[1] = GIVEN
    desk.picks[0] = size
    for other in range(size):
        desk.pick[other] = coalition[other]
    like = problem.like[problem.kind[robot]]
    count = 0
    while like[count] != NOBODY:
        count += 1
    if count > 1:
        desk.pick[seat] = like[draw_below(desk.random, count)]
        for other in range(size):
            if other != seat and desk.pick[other] == desk.pick[seat]:
                return False
        return desk.pick[seat] != robot
    return _drop_and_cover(problem, schedule, desk, task, seat)


@kernel
def _drop_and_cover(
    problem: CoalitionProblem, schedule: Schedule, desk: Desk, task: int, seat: int
) -> bool:
    """Drop a member, and let somebody else bring what is then missing."""
    robot = desk.pick[seat]
    desk.picks[0] -= 1
    desk.pick[seat] = desk.pick[desk.picks[0]]
    if not count_short(problem, desk, task):
        return True
    able, count = problem.able[draw_short(problem, desk)], 0
    while able[count] != NOBODY:
        count += 1
    other = able[draw_below(desk.random, count)]
    if other == robot or is_picked(desk, other):
        return False
    desk.pick[desk.picks[0]] = other
    desk.picks[0] += 1
    desk.clock[0] += 1  # nobody is loaded yet
    return cover(problem, schedule, desk, task)
