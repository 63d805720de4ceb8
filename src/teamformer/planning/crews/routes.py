"""What crews are planned from and with: what everybody knows, the lists, and who stands where."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry, kernel
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.distances import way_between

WORD = 64
"""Capabilities are kept as bits of words so long."""


class Shared(NamedTuple):
    """What everybody knows; lost robots and tasks that are done or unknown are left out.

    Ways are in any unit. A place is a task's, by number, or a start: its lowest robot's number
    after all tasks.
    """

    now: np.int64  # steps made, or those until the first task may begin
    opens: Array  # (tasks,) steps made when each may begin
    table: Array  # (tasks, places) ways from places to tasks; (0, 0) where these are straight:
    spots: Array  # (places, 2) then where the places are
    goals: Array  # (tasks, 2) and the tasks
    slowness: Array  # (robots,) float64, steps for one unit of way
    counts: Array  # (robots, caps)
    needs: Array  # (tasks, caps)
    wants: Array  # (tasks, words) uint64, a bit for each capability needed
    duration: Array  # (tasks,) steps, without those in which a load is carried
    carry: Array  # (tasks,) how far a load is carried, in the unit of ways; 0 for other tasks
    robot_region: Array  # (robots,) the connected part of the map
    task_region: Array  # (tasks,)
    place: Array  # (robots,) the last place known
    ready: Array  # (robots,) the step in which the robot left it
    company: Array  # (robots,) robots with the same number are known to be together


class CrewRoutes(NamedTuple):
    """Each crew's list of tasks."""

    tasks: Array  # (crews, tasks)
    length: Array  # (crews,)
    crew: Array  # (tasks,) whose list a task is on
    position: Array  # (tasks,) where on it
    finish: Array  # (crews,) the step in which the last of the list is done


class Parties(NamedTuple):
    """The crews as they stand: each party is robots that are together."""

    size: Array  # (crews,) how many
    place: Array  # (crews, parties)
    ready: Array  # (crews, parties) the step from which they walk
    slowness: Array  # (crews, parties)
    can: Array  # (crews, parties, words) what they can do, in bits


@entry
def bits_of(counts: Array) -> Array:
    """Return what counts (rows, caps) are not zero, as bits (rows, words)."""
    rows, caps = counts.shape
    bits = np.zeros((rows, (caps + WORD - 1) // WORD), dtype=np.uint64)
    for row in range(rows):
        for cap in range(caps):
            if counts[row, cap] > 0:
                bits[row, cap // WORD] |= np.uint64(1) << np.uint64(cap % WORD)
    return bits


@kernel
def count_crews(crew: Array) -> int:
    """Return how many crews there are; 0 before robots are dealt out."""
    crews = 0
    for robot in range(len(crew)):
        crews = max(crews, crew[robot] + 1)
    return crews


@allocating_kernel
def empty_lists(crews: int, tasks: Array) -> CrewRoutes:
    """Return lists with nothing on them."""
    return CrewRoutes(
        np.full((crews, tasks), NOBODY, dtype=np.int32),
        np.zeros(crews, dtype=np.int32),
        np.full(tasks, NOBODY, dtype=np.int32),
        np.full(tasks, NOBODY, dtype=np.int32),
        np.zeros(crews, dtype=np.int64),
    )


@kernel
def slowest_of(lists: CrewRoutes) -> int:
    """Return the crew that is done last, the lowest of equals."""
    slowest = 0
    for number in range(len(lists.finish)):
        if lists.finish[number] > lists.finish[slowest]:
            slowest = number
    return slowest


@kernel
def way(shared: Shared, place: int, task: int) -> int:
    """Return how far it is from a place to a task."""
    return way_between(shared.table, shared.spots, shared.goals, place, task)


@kernel
def append_task(lists: CrewRoutes, number: int, task: int) -> None:
    """Put a task at the end of a crew's list."""
    lists.crew[task], lists.position[task] = number, lists.length[number]
    lists.tasks[number, lists.length[number]] = task
    lists.length[number] += 1


@kernel
def replace_list(lists: CrewRoutes, number: int, tasks: Array, length: int) -> None:
    """Give a crew another list."""
    lists.length[number] = length
    for position in range(length):
        task = tasks[position]
        lists.tasks[number, position] = task
        lists.crew[task], lists.position[task] = number, position


@allocating_kernel
def empty_parties(shared: Shared, crew: Array) -> Parties:
    """Return room for the parties of all crews."""
    crews = count_crews(crew)
    sizes, largest = np.zeros(crews, dtype=np.int64), np.int64(0)
    for robot in range(len(crew)):
        sizes[crew[robot]] += 1
        largest = max(largest, sizes[crew[robot]])
    shape = (crews, largest)
    return Parties(
        np.zeros(crews, dtype=np.int32),
        np.zeros(shape, dtype=np.int32),
        np.zeros(shape, dtype=np.int64),
        np.zeros(shape, dtype=np.float64),
        np.zeros((crews, largest, shared.wants.shape[1]), dtype=np.uint64),
    )


@kernel
def gather_parties(shared: Shared, parties: Parties, crew: Array, number: int) -> None:
    """Write the parties of one crew, which are companies."""
    count = 0
    for leader in range(len(crew)):
        if crew[leader] != number or shared.company[leader] != leader:
            continue
        parties.place[number, count] = shared.place[leader]
        parties.ready[number, count] = shared.ready[leader]
        parties.slowness[number, count] = 0.0
        for word in range(parties.can.shape[2]):
            parties.can[number, count, word] = 0
        for robot in range(leader, len(crew)):
            if shared.company[robot] == leader:
                _add_robot(shared, parties, number, count, robot)
        count += 1
    parties.size[number] = count


@kernel
def _add_robot(shared: Shared, parties: Parties, number: int, party: int, robot: int) -> None:
    slowness = max(parties.slowness[number, party], shared.slowness[robot])
    parties.slowness[number, party] = slowness
    for cap in range(shared.counts.shape[1]):
        if shared.counts[robot, cap] > 0:
            bit = np.uint64(1) << np.uint64(cap % WORD)
            parties.can[number, party, cap // WORD] |= bit
