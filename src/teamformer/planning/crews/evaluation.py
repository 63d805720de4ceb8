"""When is a crew's list done? Its robots go one by one until they meet, and as one from then on.

A task on the list is gone to by all parties of the crew that can do something for it. Those that
come first pair off while they wait; when all are one party it is done, and they go on as one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.planning.crews.routes import way
from teamformer.world.rules.constants import ROUNDING
from teamformer.world.rules.pairing import pair_off

if TYPE_CHECKING:
    from teamformer.planning.crews.routes import Parties, Shared


class CrewRoom(NamedTuple):
    """Room to work in."""

    place: Array  # (parties,) of the crew on its walk
    ready: Array  # (parties,)
    slowness: Array  # (parties,)
    can: Array  # (parties, words)
    helper: Array  # (parties,) who goes to a task
    arrival: Array  # (parties,) when they are there, sorted
    ends: Array  # (tasks,) when what is at each position of a list is done
    first: Array  # (tasks + 1,) a list to try
    second: Array  # (tasks + 1,) another
    random: Array  # (1,) state of the random numbers


@allocating_kernel
def empty_room(shared: Shared, parties: Parties) -> CrewRoom:
    """Return room for the walks of any crew."""
    most, tasks = parties.place.shape[1], len(shared.duration)
    return CrewRoom(
        np.zeros(most, dtype=np.int32),
        np.zeros(most, dtype=np.int64),
        np.zeros(most, dtype=np.float64),
        np.zeros((most, parties.can.shape[2]), dtype=np.uint64),
        np.zeros(most, dtype=np.int32),
        np.zeros(most, dtype=np.int64),
        np.zeros(tasks, dtype=np.int64),
        np.zeros(tasks + 1, dtype=np.int32),
        np.zeros(tasks + 1, dtype=np.int32),
        np.full(1, 88172645463325252, dtype=np.uint64),
    )


@kernel
def walk_list(
    shared: Shared, parties: Parties, number: int, tasks: Array, length: int, room: CrewRoom
) -> np.int64:
    """Return the step in which a crew is done with a list; `room.ends` has each task's."""
    count = _load(parties, number, room)
    finish = np.int64(0)
    position = 0
    while position < length and count > 1:
        end, count = _meet_at(shared, room, count, tasks[position])
        room.ends[position] = end
        finish = max(finish, end)
        position += 1
    if position < length:
        place, end = room.place[0], room.ready[0]
        slowness = room.slowness[0]
        while position < length:
            task = tasks[position]
            end += np.int64(np.ceil(way(shared, place, task) * slowness - ROUNDING))
            end = max(end, shared.opens[task] + 1) + _takes(shared, task, slowness)
            room.ends[position] = end
            place = task
            position += 1
        finish = max(finish, end)
    return finish


@kernel
def _load(parties: Parties, number: int, room: CrewRoom) -> int:
    count = parties.size[number]
    for party in range(count):
        room.place[party] = parties.place[number, party]
        room.ready[party] = parties.ready[number, party]
        room.slowness[party] = parties.slowness[number, party]
        for word in range(room.can.shape[1]):
            room.can[party, word] = parties.can[number, party, word]
    return count


@kernel
def _meet_at(shared: Shared, room: CrewRoom, count: int, task: int) -> tuple[Any, Any]:
    """Bring all that help with a task there and make them one; return when it is done, and
    how many parties there are from then on.

    One that is there already is given the task a step after its last, and joins only then.
    """
    helpers = 0
    for party in range(count):
        if _helps(shared, room, party, task):
            room.helper[helpers] = party
            helpers += 1
    for index in range(helpers):
        party = room.helper[index]
        cells = way(shared, room.place[party], task)
        steps = np.int64(np.ceil(cells * room.slowness[party] - ROUNDING))
        if helpers > 1 and steps == 0:
            steps += 1
        _insert(room.arrival, index, max(room.ready[party] + steps, shared.now + 1))
    start = max(pair_off(room.arrival, helpers), shared.opens[task] + 1)
    slowness = 0.0
    for index in range(helpers):
        slowness = max(slowness, room.slowness[room.helper[index]])
    end = start + _takes(shared, task, slowness)
    one = room.helper[0]
    room.place[one], room.ready[one] = task, end
    for index in range(helpers - 1, 0, -1):
        count -= 1
        _absorb(room, one, room.helper[index], count)
    return end, count


@kernel
def _takes(shared: Shared, task: int, slowness: float) -> np.int64:
    """Return the steps that a task takes; those who carry a load go as slowly as the slowest."""
    carried = np.int64(np.ceil(shared.carry[task] * slowness - ROUNDING))
    return shared.duration[task] + carried


@kernel
def _helps(shared: Shared, room: CrewRoom, party: int, task: int) -> bool:
    for word in range(room.can.shape[1]):
        if room.can[party, word] & shared.wants[task, word]:
            return True
    return False


@kernel
def _insert(arrival: Array, count: int, step: int) -> None:
    """Put a step among sorted ones."""
    place = count
    while place > 0 and arrival[place - 1] > step:
        arrival[place] = arrival[place - 1]
        place -= 1
    arrival[place] = step


@kernel
def _absorb(room: CrewRoom, one: int, other: int, last: int) -> None:
    """Add a party to another one; the last party takes its number."""
    room.slowness[one] = max(room.slowness[one], room.slowness[other])
    room.place[other], room.ready[other] = room.place[last], room.ready[last]
    room.slowness[other] = room.slowness[last]
    for word in range(room.can.shape[1]):
        room.can[one, word] |= room.can[other, word]
        room.can[other, word] = room.can[last, word]
