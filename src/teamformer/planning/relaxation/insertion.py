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
    recall_visit,
    serve,
)
from teamformer.world.rules.chance import draw, draw_below, first_state
from teamformer.world.rules.constants import FAR, NOBODY

if TYPE_CHECKING:
    from teamformer.planning.relaxation.relaxed_plan import RelaxedPlan, Timing

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
    """Room to work in while a task is inserted."""

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
    random: Array  # (1,) state of the random numbers


def empty_workspace(problem: Relaxed, seed: int) -> InsertionRoom:
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
    plan: RelaxedPlan,
    timing: Timing,
    workspace: InsertionRoom,
    task: int,
    makespan: int,
) -> None:
    """Put a task into a plan whose tails have just been hung, if a coalition can do it.

    `makespan` is the plan's without the task.
    """
    _gather_candidates(problem, plan, timing, workspace, task)
    robots, asked, candidates = timing.robots, workspace.asked, workspace.candidates
    counts, pick, random = problem.counts, workspace.pick, workspace.random
    steps, cells, visits, coalition = problem.steps, problem.cells, timing.visits, plan.coalition
    earliest, duration, prices = problem.appears[task] + 1, problem.duration[task], problem.prices
    best_cost, best_gap, best_size = np.int64(IMPOSSIBLE), NOBODY, 0
    is_new = True
    for gap in range(plan.placed[0] + 1):
        is_last_chance = best_gap == NOBODY and gap == plan.placed[0]
        if is_last_chance or (is_new and draw(random) >= BLINK):
            size = _pick_coalition(robots, asked, candidates, counts, pick, earliest, duration)
            if workspace.is_versatile[0]:
                count_spares(problem.needs, counts, pick, size, task, workspace.spare)
                size = _drop_spares(counts, pick, size, workspace.spare)
            through, detour, own = _judge_coalition(robots, pick, size, earliest, duration)
            cost = STEP * max(through, makespan) + through + detour
            if workspace.by_price[0]:
                price = prices.whole[0] * max(through, makespan) + price_of_end(prices, task, own)
                price += _price_of_delays(problem, timing, pick, size, task, own)
                cost = STEP * price // SHARES + through + detour
            if cost < best_cost:
                best_cost, best_gap, best_size = cost, gap, size
                for seat in range(size):
                    workspace.best[seat] = pick[seat]
        if gap < plan.placed[0]:
            passed = plan.order[gap]
            end = timing.start[passed] + problem.duration[passed]
            size = plan.size[passed]
            is_new = _pass_task(robots, visits, coalition, steps, cells, task, passed, size, end)
    if best_gap != NOBODY:
        _place_task(plan, task, best_gap, workspace.best, best_size)


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
def _place_task(plan: RelaxedPlan, task: int, gap: int, coalition: Array, size: int) -> None:
    for position in range(plan.placed[0], gap, -1):
        plan.order[position] = plan.order[position - 1]
    plan.order[gap] = task
    plan.placed[0] += 1
    plan.size[task] = size
    for seat in range(size):
        plan.coalition[task, seat] = coalition[seat]


@kernel
def _gather_candidates(
    problem: Relaxed, plan: RelaxedPlan, timing: Timing, workspace: InsertionRoom, task: int
) -> None:
    """Choose whom to consider, scarce capabilities first, and weigh each at the first gap."""
    robots, asked, candidates = timing.robots, workspace.asked, workspace.candidates
    needs, scarce, able = problem.needs, workspace.scarce, problem.able
    steps, cells = problem.steps, problem.cells
    for robot in range(len(robots)):
        robots[robot].is_candidate = False
        robots[robot].is_picked = False
    kind = 0
    for rank in range(len(scarce)):
        cap = scarce[rank]
        if needs[task, cap] > 0:
            asked[kind].cap, asked[kind].count = cap, needs[task, cap]
            asked[kind].candidates = 0
            robots_needed = (needs[task, cap] + workspace.least[cap] - 1) // workspace.least[cap]
            many = max(MANY, 2 * robots_needed)
            if many < able.shape[1] and able[cap, many] != NOBODY:
                _consider_nearby(problem, plan, robots, workspace, kind, task, many // 2)
            _consider_able(robots, asked, candidates, kind, able, many, workspace.random)
            kind += 1
    asked[kind].count = 0
    for robot in range(len(robots)):
        if robots[robot].is_candidate:
            _weigh(robots, steps, cells, robot, task)


@kernel
def _consider_nearby(
    problem: Relaxed,
    plan: RelaxedPlan,
    robots: Array,
    workspace: InsertionRoom,
    kind: int,
    task: int,
    many: int,
) -> None:
    """Consider robots that serve tasks in the neighbourhood."""
    asked, candidates, coalition = workspace.asked, workspace.candidates, plan.coalition
    counts, cap = problem.counts, workspace.asked[kind].cap
    for nearby in range(workspace.near.shape[1]):
        other = workspace.near[task, nearby]
        for seat in range(plan.size[other]):
            if counts[coalition[other, seat], cap] > 0 and asked[kind].candidates < many:
                _consider(robots, asked, candidates, kind, coalition[other, seat])


@kernel
def _consider_able(
    robots: Array, asked: Array, candidates: Array, kind: int, able: Array, many: int, random: Array
) -> None:
    """Consider all robots with a capability, or some more at random to make them many."""
    cap, count = asked[kind].cap, 0
    while count < able.shape[1] and able[cap, count] != NOBODY:
        count += 1
    first = draw_below(random, count)
    for offset in range(count):
        if asked[kind].candidates < many:
            _consider(robots, asked, candidates, kind, able[cap, (first + offset) % count])


@kernel
def _consider(robots: Array, asked: Array, candidates: Array, kind: int, robot: int) -> None:
    for index in range(asked[kind].candidates):
        if candidates[kind, index] == robot:
            return
    candidates[kind, asked[kind].candidates] = robot
    asked[kind].candidates += 1
    robots[robot].is_candidate = True


@kernel
def _weigh(robots: Array, steps: Array, cells: Array, robot: int, task: int) -> None:
    """Work out what the task would mean for a robot between what it has done and will do."""
    there = leg_to(robots, steps, cells, robot, task)
    onward = leg_from(robots, steps, cells, robot, task)
    robots[robot].arrival = arrival_at(robots, steps, cells, robot, task)
    robots[robot].beyond = robots[robot].out if onward == 0 else onward + robots[robot].here
    robots[robot].detour = there + onward - _leg_without(robots, steps, cells, robot)


@kernel
def _leg_without(robots: Array, steps: Array, cells: Array, robot: int) -> int:
    if robots[robot].next == NOBODY:
        return 0
    return leg_to(robots, steps, cells, robot, robots[robot].next)


@kernel
def _pass_task(
    robots: Array,
    visits: Array,
    coalition: Array,
    steps: Array,
    cells: Array,
    task: int,
    passed: int,
    size: int,
    end: int,
) -> bool:
    """Move the gap past a task with its coalition; say whether that changed a candidate's lot."""
    is_new = False
    for seat in range(size):
        robot = coalition[passed, seat]
        if robots[robot].is_candidate:
            serve(robots, steps, cells, robot, passed, end)
            recall_visit(robots, robot, visits, passed, seat)
            _weigh(robots, steps, cells, robot, task)
            is_new = True
    return is_new


@kernel
def _pick_coalition(
    robots: Array,
    asked: Array,
    candidates: Array,
    counts: Array,
    pick: Array,
    ready: Array,
    duration: int,
) -> int:
    """Pick a coalition for the gap at hand; return its size, 0 if there is none.

    Scarce capabilities come first; each robot is the one that lengthens the chain least.
    """
    remains = size = kind = 0
    is_possible = True
    while is_possible and asked[kind].count > 0:
        short = asked[kind].count
        for seat in range(size):
            short -= counts[pick[seat], asked[kind].cap]
        while is_possible and short > 0:
            robot = _pick_robot(robots, asked, candidates, kind, ready, remains, duration)
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
    return size if is_possible else 0


@kernel
def _pick_robot(
    robots: Array,
    asked: Array,
    candidates: Array,
    kind: int,
    ready: Array,
    remains: int,
    duration: int,
) -> int:
    best, best_cost = NOBODY, IMPOSSIBLE
    for index in range(asked[kind].candidates):
        robot = candidates[kind, index]
        start = max(ready, robots[robot].arrival)
        chain = start + max(remains, robots[robot].beyond)
        cost = STEP * chain + robots[robot].detour
        is_able = start + duration < robots[robot].lost and not robots[robot].is_picked
        if cost < best_cost and is_able:
            best, best_cost = robot, cost
    return best


@kernel
def _judge_coalition(robots: Array, pick: Array, size: int, earliest: int, duration: int) -> Any:
    """Return the steps of the longest chain through the task, those more to walk, and its end."""
    ready, remains, detour, lost = earliest, 0, 0, FAR
    for seat in range(size):
        ready = max(ready, robots[pick[seat]].arrival)
        remains = max(remains, robots[pick[seat]].beyond)
        detour += robots[pick[seat]].detour
        lost = min(lost, robots[pick[seat]].lost)
    if size == 0 or ready + duration >= lost:
        return IMPOSSIBLE, 0, 0
    return ready + duration + remains, detour, ready + duration


@kernel
def _drop_spares(counts: Array, pick: Array, size: int, spare: Array) -> int:
    """Send away robots that a coalition can spare, the first picked first; return who is left.

    `spare` is what the coalition has beyond what is needed. No more stay than counts are needed.
    """
    kept = 0
    for seat in range(size):
        if _is_needed(counts, pick[seat], spare):
            pick[kept] = pick[seat]
            kept += 1
        else:
            for cap in range(len(spare)):
                spare[cap] -= counts[pick[seat], cap]
    return kept


@kernel
def _is_needed(counts: Array, robot: int, spare: Array) -> bool:
    for cap in range(len(spare)):
        if counts[robot, cap] > spare[cap]:
            return True
    return False


@kernel
def count_spares(
    needs: Array, counts: Array, pick: Array, size: int, task: int, spare: Array
) -> None:
    """Work out what a coalition has beyond what a task needs."""
    for cap in range(len(spare)):
        spare[cap] = -needs[task, cap]
        for seat in range(size):
            spare[cap] += counts[pick[seat], cap]
