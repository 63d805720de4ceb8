"""One more task for a plan: the gap in the order and the coalition that cost least.

For a gap and a coalition the longest chain of steps through the new task is known exactly from
the starts before and the tails after it; the new makespan is that or the old one, whichever is
longer. So every gap is weighed without timing the plan again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.planning.problem.prices import SHARES, price_of_end
from teamformer.planning.problem.relaxed_problem import Relaxed, least_brought
from teamformer.planning.relaxation.relaxed_plan import (
    arrival_at,
    leg_from,
    leg_to,
    placed_in,
    recall_visit,
    serve,
)
from teamformer.world.rules.chance import draw, draw_below, first_state
from teamformer.world.rules.constants import FAR, NOBODY

if TYPE_CHECKING:
    from teamformer.planning.problem.coalition_plan import CoalitionPlan
    from teamformer.planning.relaxation.relaxed_plan import Timing

STEP = 10
"""A step of makespan weighs as much as ten steps of slack or of walking."""

BLINK = 0.1
"""Chance to overlook a gap, so that the search does not always see the same best (SISR, 2020)."""

MANY = 12
"""Of more robots than this with a capability, only so many are looked at for one task."""

NEIGHBOURS = 64
"""How many tasks around each are listed, nearest first."""

IMPOSSIBLE = 2**40
"""The cost of what cannot be."""

ASK = np.dtype([("cap", np.int32), ("count", np.int32), ("candidates", np.int32)])
"""A capability, how often it is needed, and how many robots are considered for it."""


class InsertionRoom(NamedTuple):
    """Room to work in while tasks are torn out and inserted."""

    scarce: Array  # (caps,) capabilities, those that few robots have first
    least: Array  # (caps,) the least that a robot brings of each
    near: Array  # (tasks, neighbours) other tasks by distance
    asked: Array  # (caps + 1,) ASK: what the task needs, closed by a count of 0
    candidates: Array  # (caps, robots) whom to consider for what is asked
    pick: Array  # (robots,) the coalition for the gap at hand
    best: Array  # (robots,) the best coalition so far
    spare: Array  # (caps,) what the coalition has beyond what is needed
    is_versatile: Array  # (1,) whether some robot brings more than one count of anything
    by_price: Array  # (1,) whether plans are judged by what they cost
    torn: Array  # (tasks,) the tasks that are to be inserted
    random: Array  # (1,) state of the random numbers


def insertion_room(problem: Relaxed, seed: int) -> InsertionRoom:
    """Return the room, with the random numbers seeded."""
    robots, (tasks, caps) = len(problem.pace), problem.needs.shape
    by_distance = np.argsort(problem.cells[:, :tasks], axis=1, kind="stable")  # (tasks, tasks)
    return InsertionRoom(
        scarce=_scarce_first(problem),
        least=least_brought(problem.counts),
        near=np.ascontiguousarray(by_distance[:, : min(NEIGHBOURS, tasks)]).astype(np.int32),
        asked=np.zeros(caps + 1, ASK).view(np.recarray),
        candidates=np.zeros((caps, robots), np.int32),
        pick=np.zeros(robots, np.int32),
        best=np.zeros(robots, np.int32),
        spare=np.zeros(caps, np.int32),
        is_versatile=np.array([problem.counts.sum(axis=1).max() > 1]),
        by_price=np.zeros(1, np.bool_),
        torn=np.zeros(tasks, np.int32),
        random=np.array([first_state(seed)]),
    )


def _scarce_first(problem: Relaxed) -> Array:
    """Return the capabilities, those that few robots have first.

    Of equally scarce ones it is decided by who has them and what needs them, not by their order in
    the mission, which means nothing.
    """
    scarcity = (problem.able != NOBODY).sum(axis=1)  # (caps,)
    return np.lexsort((*problem.needs, *problem.counts, scarcity)).astype(np.int32)


@allocating_kernel
def insert_task(
    problem: Relaxed,
    plan: CoalitionPlan,
    timing: Timing,
    room: InsertionRoom,
    task: int,
    makespan: int,
) -> None:
    """Put a task into a plan whose tails have just been hung, if a coalition can do it.

    `makespan` is the plan's without the task.
    """
    _gather_candidates(problem, plan, timing, room, task)
    best_cost, best_gap, best_size = np.int64(IMPOSSIBLE), NOBODY, 0
    is_new, placed = True, placed_in(plan)
    for gap in range(placed + 1):
        is_last_chance = best_gap == NOBODY and gap == placed
        if is_last_chance or (is_new and draw(room.random) >= BLINK):
            size = _pick_coalition(problem, timing, room, task)
            cost = _judge_coalition(problem, timing, room, size, task, makespan)
            if cost < best_cost:
                best_cost, best_gap, best_size = cost, gap, size
                for seat in range(size):
                    room.best[seat] = room.pick[seat]
        if gap < placed:
            is_new = _pass_task(problem, plan, timing, task, plan.order[gap])
    if best_gap != NOBODY:
        _place_task(plan, task, best_gap, room.best, best_size)


@kernel
def _judge_coalition(
    problem: Relaxed, timing: Timing, room: InsertionRoom, size: int, task: int, makespan: int
) -> Any:
    """Return what it costs that those who are picked do a task at the gap at hand.

    That goes by the longest chain through it, and by the steps more to walk.
    """
    robots, pick, prices = timing.robots, room.pick, problem.prices
    ready, remains, detour, lost = problem.appears[task] + 1, 0, 0, FAR
    for seat in range(size):
        ready = max(ready, robots[pick[seat]].arrival)
        remains = max(remains, robots[pick[seat]].beyond)
        detour += robots[pick[seat]].detour
        lost = min(lost, robots[pick[seat]].lost)
    end = ready + problem.duration[task]
    if size == 0 or end >= lost:
        return np.int64(IMPOSSIBLE)
    through = end + remains
    if not room.by_price[0]:
        return np.int64(STEP * max(through, makespan) + through + detour)
    price = prices.whole[0] * max(through, makespan) + price_of_end(prices, task, end)
    price += _price_of_delays(problem, timing, pick, size, task, end)
    return np.int64(STEP * price // SHARES + through + detour)


@kernel
def _price_of_delays(
    problem: Relaxed, timing: Timing, pick: Array, size: int, task: int, end: int
) -> Any:
    """Return about what it costs that who does a task is later at what it does next."""
    robots, prices, price = timing.robots, problem.prices, np.int64(0)
    for seat in range(size):
        robot = pick[seat]
        after = robots[robot].next
        if after == NOBODY:
            continue
        way = problem.steps[robots[robot].pace, problem.cells[after, task]]
        late, old = end + way - timing.start[after], timing.end[after]
        if late > 0:
            price += price_of_end(prices, after, old + late) - price_of_end(prices, after, old)
            price += timing.push[after] * late
    return price


@kernel
def _place_task(plan: CoalitionPlan, task: int, gap: int, coalition: Array, size: int) -> None:
    for position in range(placed_in(plan), gap, -1):
        plan.order[position] = plan.order[position - 1]
    plan.order[gap] = task
    plan.size[task] = size
    for seat in range(size):
        plan.coalition[task, seat] = coalition[seat]


@kernel
def _gather_candidates(
    problem: Relaxed, plan: CoalitionPlan, timing: Timing, room: InsertionRoom, task: int
) -> None:
    """Choose whom to consider, scarce capabilities first, and weigh each at the first gap."""
    robots, asked, able = timing.robots, room.asked, problem.able
    for robot in range(len(robots)):
        robots[robot].is_candidate = False
        robots[robot].is_picked = False
    kind = 0
    for rank in range(len(room.scarce)):
        cap = room.scarce[rank]
        need, least = problem.needs[task, cap], room.least[cap]
        if need > 0:
            asked[kind].cap, asked[kind].count, asked[kind].candidates = cap, need, 0
            many = max(MANY, 2 * ((need + least - 1) // least))
            if many < able.shape[1] and able[cap, many] != NOBODY:
                _consider_nearby(problem, plan, timing, room, kind, task, many // 2)
            _consider_able(problem, timing, room, kind, many)
            kind += 1
    asked[kind].count = 0
    for robot in range(len(robots)):
        if robots[robot].is_candidate:
            _weigh(problem, timing, robot, task)


@kernel
def _consider_nearby(
    problem: Relaxed,
    plan: CoalitionPlan,
    timing: Timing,
    room: InsertionRoom,
    kind: int,
    task: int,
    many: int,
) -> None:
    """Consider robots that serve tasks in the neighbourhood."""
    asked, coalition, cap = room.asked, plan.coalition, room.asked[kind].cap
    for nearby in range(room.near.shape[1]):
        other = room.near[task, nearby]
        for seat in range(plan.size[other]):
            robot = coalition[other, seat]
            if problem.counts[robot, cap] > 0 and asked[kind].candidates < many:
                _consider(timing, room, kind, robot)


@kernel
def _consider_able(
    problem: Relaxed, timing: Timing, room: InsertionRoom, kind: int, many: int
) -> None:
    """Consider all robots with a capability, or some more at random to make them many."""
    able, cap, count = problem.able, room.asked[kind].cap, 0
    while count < able.shape[1] and able[cap, count] != NOBODY:
        count += 1
    first = draw_below(room.random, count)
    for offset in range(count):
        if room.asked[kind].candidates < many:
            _consider(timing, room, kind, able[cap, (first + offset) % count])


@kernel
def _consider(timing: Timing, room: InsertionRoom, kind: int, robot: int) -> None:
    asked, candidates = room.asked, room.candidates
    for index in range(asked[kind].candidates):
        if candidates[kind, index] == robot:
            return
    candidates[kind, asked[kind].candidates] = robot
    asked[kind].candidates += 1
    timing.robots[robot].is_candidate = True


@kernel
def _weigh(problem: Relaxed, timing: Timing, robot: int, task: int) -> None:
    """Work out what the task would mean for a robot between what it has done and will do."""
    robots = timing.robots
    there, onward = leg_to(problem, timing, robot, task), leg_from(problem, timing, robot, task)
    straight = 0
    if robots[robot].next != NOBODY:
        straight = leg_to(problem, timing, robot, robots[robot].next)
    robots[robot].arrival = arrival_at(problem, timing, robot, task)
    robots[robot].beyond = robots[robot].out if onward == 0 else onward + robots[robot].here
    robots[robot].detour = there + onward - straight


@kernel
def _pass_task(
    problem: Relaxed, plan: CoalitionPlan, timing: Timing, task: int, passed: int
) -> bool:
    """Move the gap past a task with its coalition; say whether that changed a candidate's lot."""
    end, is_new = timing.start[passed] + problem.duration[passed], False
    for seat in range(plan.size[passed]):
        robot = plan.coalition[passed, seat]
        if timing.robots[robot].is_candidate:
            serve(problem, timing, robot, passed, end)
            recall_visit(timing, robot, passed, seat)
            _weigh(problem, timing, robot, task)
            is_new = True
    return is_new


@kernel
def _pick_coalition(problem: Relaxed, timing: Timing, room: InsertionRoom, task: int) -> int:
    """Pick a coalition for the gap at hand; return its size, 0 if there is none.

    Scarce capabilities come first; each robot is the one that lengthens the chain least.
    """
    robots, asked, counts, pick = timing.robots, room.asked, problem.counts, room.pick
    ready, duration = problem.appears[task] + 1, problem.duration[task]
    remains = size = kind = 0
    is_possible = True
    while is_possible and asked[kind].count > 0:
        short = asked[kind].count
        for seat in range(size):
            short -= counts[pick[seat], asked[kind].cap]
        while is_possible and short > 0:
            robot = _pick_robot(robots, room, kind, ready, remains, duration)
            is_possible = robot != NOBODY
            if is_possible:
                robots[robot].is_picked = True
                pick[size] = robot
                size += 1
                short -= counts[robot, asked[kind].cap]
                ready = max(ready, robots[robot].arrival)
                remains = max(remains, robots[robot].beyond)
        kind += 1
    for seat in range(size):
        robots[pick[seat]].is_picked = False
    if not is_possible:
        return 0
    return _without_spares(problem, room, size, task) if room.is_versatile[0] else size


@kernel
def _pick_robot(
    robots: Array, room: InsertionRoom, kind: int, ready: int, remains: int, duration: int
) -> int:
    best, best_cost = NOBODY, IMPOSSIBLE
    for index in range(room.asked[kind].candidates):
        robot = room.candidates[kind, index]
        start = max(ready, robots[robot].arrival)
        chain = start + max(remains, robots[robot].beyond)
        cost = STEP * chain + robots[robot].detour
        is_able = start + duration < robots[robot].lost and not robots[robot].is_picked
        if cost < best_cost and is_able:
            best, best_cost = robot, cost
    return best


@kernel
def _without_spares(problem: Relaxed, room: InsertionRoom, size: int, task: int) -> int:
    """Send away robots that a coalition can spare, the first picked first; return who is left.

    No more stay than counts are needed.
    """
    counts, pick, spare, kept = problem.counts, room.pick, room.spare, 0
    for cap in range(len(spare)):
        spare[cap] = -problem.needs[task, cap]
        for seat in range(size):
            spare[cap] += counts[pick[seat], cap]
    for seat in range(size):
        is_needed = False
        for cap in range(len(spare)):
            is_needed |= counts[pick[seat], cap] > spare[cap]
        if is_needed:
            pick[kept] = pick[seat]
            kept += 1
        else:
            for cap in range(len(spare)):
                spare[cap] -= counts[pick[seat], cap]
    return kept
