"""Crews: a fleet in parts that share out the tasks, worked out alike by everybody.

A crew is a set of robots with a list of tasks that they do together, one after the other. This
plans all lists at once: it deals the robots out, shares out the tasks, and then moves tasks between
the lists and along them so that the slowest crew gets done early. It rests on what everybody
knows, on whole numbers and on a fixed sequence of random ones, never on a clock.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry
from teamformer.planning.crews.evaluation import empty_room, walk_list
from teamformer.planning.crews.local_search import improve_lists
from teamformer.planning.crews.membership import deal_robots, merge_where_needed
from teamformer.planning.crews.routes import (
    append_task,
    count_crews,
    empty_lists,
    empty_parties,
    gather_parties,
    way,
)
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.sorting import sort_indices
from teamformer.world.rules.tour import plan_tour

if TYPE_CHECKING:
    from teamformer.planning.crews.evaluation import CrewRoom
    from teamformer.planning.crews.routes import CrewRoutes, Parties, Shared


LARGEST_TOUR = 2000
"""Through more tasks than this the tour goes to the nearest one each time, and is not improved."""


@entry
def deal_crews(shared: Shared, crew: Array, task_crew: Array, rounds: int) -> Array:
    """Write the crew of each robot and task; return the tasks in the order they will be done in.

    `crew` (robots,) and `task_crew` (tasks,) are written; `rounds` is how many changes are tried.
    """
    deal_robots(shared, crew)
    is_able = merge_where_needed(shared, crew)  # (crews, tasks)
    parties = _gather_all(shared, crew)
    lists = empty_lists(len(is_able), len(task_crew))
    room = empty_room(shared, parties)
    _cut_tour(shared, lists, is_able)
    improve_lists(shared, lists, parties, crew, is_able, room, rounds)
    return _merge_lists(shared, lists, parties, task_crew, room)


@allocating_kernel
def _gather_all(shared: Shared, crew: Array) -> Parties:
    parties = empty_parties(shared, crew)
    for number in range(count_crews(crew)):
        gather_parties(shared, parties, crew, number)
    return parties


@allocating_kernel
def _merge_lists(
    shared: Shared, lists: CrewRoutes, parties: Parties, task_crew: Array, room: CrewRoom
) -> Array:
    """Write whose list each task is on; return all in one order, by the steps they are done in."""
    sequence = np.empty(len(task_crew), dtype=np.int64)
    end = np.empty(len(task_crew), dtype=np.int64)
    count = 0
    for number in range(len(lists.length)):
        walk_list(shared, parties, number, lists.tasks[number], lists.length[number], room)
        for position in range(lists.length[number]):
            sequence[count], end[count] = lists.tasks[number, position], room.ends[position]
            task_crew[sequence[count]] = number
            count += 1
    order, spare = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    sort_indices(end, order, spare)
    for rank in range(count):
        order[rank] = sequence[order[rank]]
    return order


@allocating_kernel
def _cut_tour(shared: Shared, lists: CrewRoutes, is_able: Array) -> None:
    """Give each crew a stretch of a tour through all tasks, and what its crew cannot do to others.

    A task that the crew whose turn it is cannot do goes to one that can and has least to do.
    """
    count = len(shared.duration)
    start = np.zeros(count, dtype=np.int64)
    for task in range(count):
        for robot in range(len(shared.place)):
            start[task] += way(shared, shared.place[robot], task) // len(shared.place)
    share = np.zeros(len(is_able), dtype=np.int64)  # how many tasks each crew should have
    for number in range(len(is_able)):
        share[number] = (count + len(is_able) - 1) // len(is_able)
    turn = 0
    tour = _short_tour(shared, start) if count <= LARGEST_TOUR else _quick_tour(shared, start)
    for task in tour:
        while turn < len(is_able) - 1 and lists.length[turn] >= share[turn]:
            turn += 1
        chosen = turn
        if not is_able[turn, task]:
            chosen = NOBODY
            for number in range(len(is_able)):
                if is_able[number, task] and (
                    chosen == NOBODY or lists.length[number] < lists.length[chosen]
                ):
                    chosen = number
        append_task(lists, chosen, task)


@allocating_kernel
def _short_tour(shared: Shared, start: Array) -> Array:
    """Return a tour through all tasks that small changes do not shorten."""
    count = len(start)
    between = np.zeros((count, count), dtype=np.int64)
    for task in range(count):
        for other in range(count):
            between[task, other] = min(way(shared, task, other), way(shared, other, task))
    return plan_tour(between, start)


@allocating_kernel
def _quick_tour(shared: Shared, start: Array) -> Array:
    """Return a tour that goes to the nearest task each time, the lowest of equals."""
    count = len(start)
    left, tour = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    first = 0
    for task in range(count):
        left[task] = task
        if start[task] < start[first]:
            first = task
    place = first
    for position in range(count):
        tour[position] = left[place]
        for gap in range(place, count - position - 1):
            left[gap] = left[gap + 1]
        place, least = 0, np.int64(-1)
        for rank in range(count - position - 1):
            away = min(
                way(shared, tour[position], left[rank]), way(shared, left[rank], tour[position])
            )
            if least < 0 or away < least:
                place, least = rank, away
    return tour
