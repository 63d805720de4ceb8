"""Better lists: a local search that makes the slowest crews faster.

Annealing by thresholds (Dueck and Scheuer, "Threshold accepting", 1990), drawn at random: a change
is kept if it costs no more than a little, and less and less as the search goes on. All numbers are
whole and the number of changes is fixed, so that everybody who searches finds the same.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.planning.crews.evaluation import walk_list
from teamformer.planning.crews.moves import change_lists
from teamformer.planning.crews.routes import (
    gather_parties,
    replace_list,
    set_finish,
    slowest_of,
    way,
)
from teamformer.world.rules.chance import draw_below
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.planning.crews.evaluation import CrewRoom
    from teamformer.planning.crews.routes import CrewRoutes, Parties, Shared

HEAT = 5
"""A change may cost as much as so many tasks do on average; at the end nothing."""

NEIGHBOURS = 12
"""Tasks are put beside one of so many nearest ones."""

TRADES = 16
"""While robots may change crews, one change of so many is that."""

SCALE, LARGEST = 1024, 8191
"""Makespans are counted in 1024ths of the first one, to eight times that."""


class BestLists(NamedTuple):
    """The best lists and crews so far, and what has changed since these were written down."""

    tasks: Array  # (crews, tasks)
    length: Array  # (crews,)
    crew: Array  # (robots,)
    list_changes: Array  # (crews + 1,) how many lists have changed, then their crews
    is_list_changed: Array  # (crews,)
    crew_changes: Array  # (robots + 1,) how many robots have changed crews, then these
    is_crew_changed: Array  # (robots,)


@allocating_kernel
def improve_lists(
    shared: Shared,
    lists: CrewRoutes,
    parties: Parties,
    crew: Array,
    is_able: Array,
    room: CrewRoom,
    rounds: int,
) -> None:
    """Try so many changes and leave the best lists found.

    Robots that can do the same change crews too, which is written to `crew`.
    """
    for number in range(len(lists.length)):
        tasks, length = lists.tasks[number], lists.length[number]
        set_finish(lists, number, walk_list(shared, parties, number, tasks, length, room))
    near, is_alone = _nearest_tasks(shared), _who_starts_alone(shared)
    reference = np.int64(1)
    for number in range(len(lists.length)):
        reference = max(reference, lists.finish[number] - shared.now)
    cost = np.int64(0)
    for number in range(len(lists.length)):
        cost += _weigh(shared, lists.finish[number], reference)
    best, best_cost = _first_kept(lists, crew), cost
    for turn in range(rounds):
        limit = cost + _draw_threshold(cost, len(lists.crew), rounds - turn, rounds, room.random)
        if draw_below(room.random, TRADES) == 0:
            cost = _try_trade(
                shared, lists, parties, crew, is_alone, room, best, reference, cost, limit
            )
        else:
            cost = _try_change(
                shared, lists, parties, is_able, near, room, best, reference, cost, limit
            )
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
    room: CrewRoom,
    best: BestLists,
    reference: int,
    cost: int,
    limit: int,
) -> Any:
    """Make a change unless it costs too much; return what the lists cost then."""
    slowest = slowest_of(lists)
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
    set_finish(lists, one, finish)
    _note(best.list_changes, best.is_list_changed, one)
    if one != other:
        replace_list(lists, other, room.second, other_length)
        set_finish(lists, other, other_finish)
        _note(best.list_changes, best.is_list_changed, other)
    return new_cost


@kernel
def _try_trade(
    shared: Shared,
    lists: CrewRoutes,
    parties: Parties,
    crew: Array,
    is_alone: Array,
    room: CrewRoom,
    best: BestLists,
    reference: int,
    cost: int,
    limit: int,
) -> Any:
    """Swap two robots that can do the same, unless it costs too much; return the cost then."""
    robot, partner = draw_below(room.random, len(crew)), draw_below(room.random, len(crew))
    one, other = crew[robot], crew[partner]
    is_able = is_alone[robot] and is_alone[partner] and _are_alike(shared, robot, partner)
    if one == other or not is_able:
        return cost
    finish, other_finish = _trade(shared, lists, parties, crew, robot, partner, room)
    new_cost = cost - _weigh(shared, lists.finish[one], reference)
    new_cost += _weigh(shared, finish, reference)
    new_cost -= _weigh(shared, lists.finish[other], reference)
    new_cost += _weigh(shared, other_finish, reference)
    if new_cost > limit:
        _trade(shared, lists, parties, crew, robot, partner, room)
        return cost
    set_finish(lists, one, finish)
    set_finish(lists, other, other_finish)
    _note(best.crew_changes, best.is_crew_changed, robot)
    _note(best.crew_changes, best.is_crew_changed, partner)
    return new_cost


@kernel
def _are_alike(shared: Shared, robot: int, partner: int) -> bool:
    """Say whether two robots can do the same in the same part of the map."""
    if shared.robot_region[robot] != shared.robot_region[partner]:
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
    room: CrewRoom,
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
    near = np.full((count, NEIGHBOURS), NOBODY, dtype=np.int32)
    away = np.empty(NEIGHBOURS, dtype=np.int64)
    for task in range(count):
        found = 0
        for other in range(count):
            if other == task or shared.task_region[other] != shared.task_region[task]:
                continue
            cells = way(shared, task, other)
            if found == NEIGHBOURS and cells >= away[found - 1]:
                continue
            found = min(found + 1, NEIGHBOURS)
            gap = found - 1
            while gap > 0 and away[gap - 1] > cells:
                away[gap], near[task, gap] = away[gap - 1], near[task, gap - 1]
                gap -= 1
            away[gap], near[task, gap] = cells, other
    return near


@allocating_kernel
def _who_starts_alone(shared: Shared) -> Array:
    """Return which robots start in no team, (robots,)."""
    robots = len(shared.company)
    size, is_alone = np.zeros(robots, dtype=np.int64), np.empty(robots, dtype=np.bool_)
    for robot in range(robots):
        size[shared.company[robot]] += 1
    for robot in range(robots):
        is_alone[robot] = size[shared.company[robot]] == 1
    return is_alone


@allocating_kernel
def _first_kept(lists: CrewRoutes, crew: Array) -> BestLists:
    crews, robots = len(lists.length), len(crew)
    return BestLists(
        lists.tasks.copy(),
        lists.length.copy(),
        crew.copy(),
        np.zeros(crews + 1, dtype=np.int64),
        np.zeros(crews, dtype=np.bool_),
        np.zeros(robots + 1, dtype=np.int64),
        np.zeros(robots, dtype=np.bool_),
    )


@kernel
def _note(changes: Array, is_changed: Array, number: int) -> None:
    """Note that a list or a robot's crew is not what was written down."""
    if not is_changed[number]:
        is_changed[number] = True
        changes[0] += 1
        changes[changes[0]] = number


@kernel
def _keep(lists: CrewRoutes, crew: Array, best: BestLists) -> None:
    """Write down what has changed."""
    for index in range(1, best.list_changes[0] + 1):
        number = best.list_changes[index]
        best.is_list_changed[number] = False
        best.length[number] = lists.length[number]
        for position in range(lists.length[number]):
            best.tasks[number, position] = lists.tasks[number, position]
    for index in range(1, best.crew_changes[0] + 1):
        robot = best.crew_changes[index]
        best.is_crew_changed[robot] = False
        best.crew[robot] = crew[robot]
    best.list_changes[0] = best.crew_changes[0] = 0


@kernel
def _put_back(lists: CrewRoutes, crew: Array, best: BestLists) -> None:
    """Make the lists what was written down."""
    for number in range(len(lists.length)):
        replace_list(lists, number, best.tasks[number], best.length[number])
    for robot in range(len(crew)):
        crew[robot] = best.crew[robot]
