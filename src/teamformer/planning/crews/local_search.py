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


class CrewSearch(NamedTuple):
    """Where a search stands, and the best that it has found."""

    lists: CrewRoutes
    parties: Parties
    crew: Array  # (robots,)
    is_able: Array  # (crews, tasks)
    near: Array  # (tasks, neighbours)
    is_alone: Array  # (robots,)
    room: CrewRoom
    cost: Array  # (2,) of the lists as they are, and the makespan that others are measured by
    best_list: Array  # (tasks,) the list that each task is on in the best lists
    best_position: Array  # (tasks,) and where on it
    best_crew: Array  # (robots,)


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
        lists.finish[number] = walk_list(shared, parties, number, tasks, length, room)
    search = CrewSearch(
        lists,
        parties,
        crew,
        is_able,
        _nearest_tasks(shared),
        _who_starts_alone(shared),
        room,
        np.ones(2, dtype=np.int64),
        lists.crew.copy(),
        lists.position.copy(),
        crew.copy(),
    )
    cost = search.cost
    for number in range(len(lists.length)):
        cost[1] = max(cost[1], lists.finish[number] - shared.now)
    cost[0] = 0
    for number in range(len(lists.length)):
        cost[0] += _weigh(shared, search, lists.finish[number])
    best = cost[0]
    for turn in range(rounds):
        threshold = _draw_threshold(cost[0], len(lists.crew), rounds - turn, rounds, room.random)
        if draw_below(room.random, TRADES) == 0:
            _try_trade(shared, search, cost[0] + threshold)
        else:
            _try_change(shared, search, cost[0] + threshold)
        if cost[0] < best:
            best = cost[0]
            _keep(search)
    _put_back(search)
    for number in range(len(lists.length)):
        gather_parties(shared, parties, crew, number)


@kernel
def _weigh(shared: Shared, search: CrewSearch, finish: Any) -> Any:
    """Return what a crew adds to the cost: its makespan to the power of four."""
    scaled = min(max(finish - shared.now, 0) * SCALE // search.cost[1], LARGEST)
    return scaled * scaled * scaled * scaled


@kernel
def _draw_threshold(cost: int, tasks: int, left: int, rounds: int, random: Array) -> int:
    """Return what the next change may cost, with so many changes left."""
    most = (HEAT * cost // tasks) >> 20
    return most * (1024 * left // rounds) * draw_below(random, 1024)


@kernel
def _cost_with(
    shared: Shared, search: CrewSearch, one: int, finish: Any, other: int, other_finish: Any
) -> Any:
    """Return what the lists cost if two crews, or one named twice, are done at other times."""
    finishes = search.lists.finish
    cost = search.cost[0] + _weigh(shared, search, finish)
    cost -= _weigh(shared, search, finishes[one])
    if one != other:
        cost += _weigh(shared, search, other_finish)
        cost -= _weigh(shared, search, finishes[other])
    return cost


@kernel
def _try_change(shared: Shared, search: CrewSearch, limit: int) -> None:
    """Make a change unless it costs too much."""
    lists, room = search.lists, search.room
    one, other, length, other_length = change_lists(search)
    if one == NOBODY:
        return
    finish = walk_list(shared, search.parties, one, room.first, length, room)
    other_finish = finish
    if one != other:
        other_finish = walk_list(shared, search.parties, other, room.second, other_length, room)
    cost = _cost_with(shared, search, one, finish, other, other_finish)
    if cost > limit:
        return
    search.cost[0] = cost
    replace_list(lists, one, room.first, length)
    lists.finish[one] = finish
    if one != other:
        replace_list(lists, other, room.second, other_length)
        lists.finish[other] = other_finish


@kernel
def _try_trade(shared: Shared, search: CrewSearch, limit: int) -> None:
    """Swap two robots that can do the same, unless it costs too much."""
    crew, random = search.crew, search.room.random
    robot, partner = draw_below(random, len(crew)), draw_below(random, len(crew))
    one, other = crew[robot], crew[partner]
    is_able = search.is_alone[robot] and search.is_alone[partner]
    if one == other or not (is_able and _are_alike(shared, robot, partner)):
        return
    finish, other_finish = _trade(shared, search, robot, partner)
    cost = _cost_with(shared, search, one, finish, other, other_finish)
    if cost > limit:
        _trade(shared, search, robot, partner)
        return
    search.cost[0] = cost
    search.lists.finish[one], search.lists.finish[other] = finish, other_finish


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
def _trade(shared: Shared, search: CrewSearch, robot: int, partner: int) -> tuple[Any, Any]:
    """Swap the crews of two robots; return when both crews are done from then on."""
    lists, parties, crew, room = search.lists, search.parties, search.crew, search.room
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


@kernel
def _keep(search: CrewSearch) -> None:
    """Write down the best lists and crews."""
    for task in range(len(search.best_list)):
        search.best_list[task] = search.lists.crew[task]
        search.best_position[task] = search.lists.position[task]
    for robot in range(len(search.crew)):
        search.best_crew[robot] = search.crew[robot]


@kernel
def _put_back(search: CrewSearch) -> None:
    """Make the lists and crews what was written down."""
    lists = search.lists
    for number in range(len(lists.length)):
        lists.length[number] = 0
    for task in range(len(search.best_list)):
        number, position = search.best_list[task], search.best_position[task]
        lists.tasks[number, position] = task
        lists.crew[task], lists.position[task] = number, position
        lists.length[number] += 1
    for robot in range(len(search.crew)):
        search.crew[robot] = search.best_crew[robot]
