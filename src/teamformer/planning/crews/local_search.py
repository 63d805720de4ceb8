"""Better lists: a local search that makes the slowest crews faster.

Annealing by thresholds (Dueck and Scheuer, "Threshold accepting", 1990), drawn at random: a change
is kept if it costs no more than a little, and less and less as the search goes on. All numbers are
whole and the number of changes is fixed, so that everybody who searches finds the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.jit import allocating_kernel, kernel
from teamformer.planning.crews.evaluation import walk_list
from teamformer.planning.crews.moves import change_lists
from teamformer.planning.crews.routes import gather_parties, replace_list
from teamformer.rules.arrays import Array
from teamformer.rules.chance import draw_below
from teamformer.rules.constants import NOBODY
from teamformer.rules.sorting import sort_indices

if TYPE_CHECKING:
    from teamformer.planning.crews.evaluation import Room
    from teamformer.planning.crews.routes import CrewRoutes, Parties, Shared

HEAT = 5
"""A change may cost as much as so many tasks do on average; at the end nothing."""

NEIGHBOURS = 12
"""Tasks are put beside one of so many nearest ones."""

TRADES = 16
"""While robots may change crews, one change of so many is that."""

SCALE, LARGEST = 1024, 8191
"""Makespans are counted in 1024ths of the first one, to eight times that."""


@allocating_kernel
def improve_lists(
    shared: Shared,
    lists: CrewRoutes,
    parties: Parties,
    crew: Array,
    is_able: Array,
    room: Room,
    rounds: int,
) -> None:
    """Try so many changes and leave the best lists found.

    Robots that can do the same change crews too, which is written to `crew`.
    """
    for number in range(len(lists.length)):
        tasks, length = lists.tasks[number], lists.length[number]
        lists.finish[number] = walk_list(shared, parties, number, tasks, length, room)
    near = _nearest_tasks(shared)
    reference = np.int64(1)
    for number in range(len(lists.length)):
        reference = max(reference, lists.finish[number] - shared.now)
    cost = np.int64(0)
    for number in range(len(lists.length)):
        cost += _weigh(shared, lists.finish[number], reference)
    best, best_cost = (lists.tasks.copy(), lists.length.copy(), crew.copy()), cost
    for turn in range(rounds):
        limit = cost + _draw_threshold(cost, len(lists.crew), rounds - turn, rounds, room.random)
        if draw_below(room.random, TRADES) == 0:
            cost = _try_trade(shared, lists, parties, crew, room, reference, cost, limit)
        else:
            cost = _try_change(shared, lists, parties, is_able, near, room, reference, cost, limit)
        if cost < best_cost:
            best_cost = cost
            _keep(lists, crew, best)
    _put_back(lists, crew, best)
    for number in range(len(lists.length)):
        gather_parties(shared, parties, crew, number)


@kernel
def _weigh(shared: Shared, finish: Any, reference: Any) -> Any:
    """Return what a crew adds to the cost: its makespan to the power of four."""
    scaled = min(max(finish - shared.now, 0) * SCALE // reference, LARGEST)
    return scaled * scaled * scaled * scaled


@kernel
def _draw_threshold(cost: int, tasks: int, left: int, rounds: int, random: Array) -> int:
    """Return what the next change may cost, with so many changes left."""
    most = (HEAT * cost // tasks) >> 20
    return most * (1024 * left // rounds) * draw_below(random, 1024)


@kernel
def _try_change(
    shared: Shared,
    lists: CrewRoutes,
    parties: Parties,
    is_able: Array,
    near: Array,
    room: Room,
    reference: int,
    cost: int,
    limit: int,
) -> Any:
    """Make a change unless it costs too much; return what the lists cost then."""
    slowest = _slowest(lists)
    one, other, length, other_length = change_lists(lists, is_able, near, slowest, room)
    if one == NOBODY:
        return cost
    finish = walk_list(shared, parties, one, room.first, length, room)
    new_cost = cost - _weigh(shared, lists.finish[one], reference)
    new_cost += _weigh(shared, finish, reference)
    other_finish = finish
    if one != other:
        other_finish = walk_list(shared, parties, other, room.second, other_length, room)
        new_cost -= _weigh(shared, lists.finish[other], reference)
        new_cost += _weigh(shared, other_finish, reference)
    if new_cost > limit:
        return cost
    replace_list(lists, one, room.first, length)
    lists.finish[one] = finish
    if one != other:
        replace_list(lists, other, room.second, other_length)
        lists.finish[other] = other_finish
    return new_cost


@kernel
def _slowest(lists: CrewRoutes) -> int:
    slowest = 0
    for number in range(1, len(lists.length)):
        if lists.finish[number] > lists.finish[slowest]:
            slowest = number
    return slowest


@kernel
def _try_trade(
    shared: Shared,
    lists: CrewRoutes,
    parties: Parties,
    crew: Array,
    room: Room,
    reference: int,
    cost: int,
    limit: int,
) -> Any:
    """Swap two robots that can do the same, unless it costs too much; return the cost then."""
    robot, partner = draw_below(room.random, len(crew)), draw_below(room.random, len(crew))
    one, other = crew[robot], crew[partner]
    if one == other or not _are_alike(shared, robot, partner):
        return cost
    finish, other_finish = _trade(shared, lists, parties, crew, robot, partner, room)
    new_cost = cost - _weigh(shared, lists.finish[one], reference)
    new_cost += _weigh(shared, finish, reference)
    new_cost -= _weigh(shared, lists.finish[other], reference)
    new_cost += _weigh(shared, other_finish, reference)
    if new_cost > limit:
        _trade(shared, lists, parties, crew, robot, partner, room)
        return cost
    lists.finish[one], lists.finish[other] = finish, other_finish
    return new_cost


@kernel
def _are_alike(shared: Shared, robot: int, partner: int) -> bool:
    """Say whether two robots can do the same in the same part of the map, and start alone."""
    if shared.robot_region[robot] != shared.robot_region[partner]:
        return False
    for member in range(len(shared.company)):
        leader = shared.company[member]
        if member not in (robot, partner) and leader in (
            shared.company[robot],
            shared.company[partner],
        ):
            return False
    for cap in range(shared.counts.shape[1]):
        if shared.counts[robot, cap] != shared.counts[partner, cap]:
            return False
    return True


@kernel
def _trade(
    shared: Shared,
    lists: CrewRoutes,
    parties: Parties,
    crew: Array,
    robot: int,
    partner: int,
    room: Room,
) -> tuple[Any, Any]:
    """Swap the crews of two robots; return when the crew of the first and of the second was done,
    from then on."""
    one, other = crew[robot], crew[partner]
    crew[robot], crew[partner] = other, one
    gather_parties(shared, parties, crew, one)
    gather_parties(shared, parties, crew, other)
    finish = walk_list(shared, parties, one, lists.tasks[one], lists.length[one], room)
    tasks, length = lists.tasks[other], lists.length[other]
    return finish, walk_list(shared, parties, other, tasks, length, room)


@allocating_kernel
def _nearest_tasks(shared: Shared) -> Array:
    """Return the nearest other tasks of the same region, NOBODY where there are fewer."""
    count = len(shared.duration)
    near = np.empty((count, NEIGHBOURS), dtype=np.int32)
    order, spare = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    for task in range(count):
        found = 0
        sort_indices(shared.ways[task], order, spare)
        for rank in range(count):
            other = order[rank]
            is_near = shared.task_region[other] == shared.task_region[task]
            if other != task and is_near and found < NEIGHBOURS:
                near[task, found] = other
                found += 1
        for place in range(found, NEIGHBOURS):
            near[task, place] = NOBODY
    return near


@kernel
def _keep(lists: CrewRoutes, crew: Array, best: tuple[Array, ...]) -> None:
    """Write down the lists."""
    tasks, length, members = best
    for number in range(len(length)):
        length[number] = lists.length[number]
        for position in range(length[number]):
            tasks[number, position] = lists.tasks[number, position]
    for robot in range(len(crew)):
        members[robot] = crew[robot]


@kernel
def _put_back(lists: CrewRoutes, crew: Array, best: tuple[Array, ...]) -> None:
    """Make the lists what was written down."""
    tasks, length, members = best
    for number in range(len(length)):
        replace_list(lists, number, tasks[number], length[number])
    for robot in range(len(crew)):
        crew[robot] = members[robot]
