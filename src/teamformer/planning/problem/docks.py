"""Zones where loads are taken up or unloaded, in ticks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Int32s, Ints
from teamformer.world.rules.starts import RoomLeft


class Docks(NamedTuple):
    """Zones where loads are taken up or unloaded, in ticks; none where there are no such zones.

    No search counts with them: plans are carried out to be judged.
    """

    room: Ints  # (zones,)
    taken: Ints  # (taken, 2) zones where something goes on, and until when
    tasks: Int32s  # (zones, tasks) which take room in which from when they start
    loads: Int32s  # (zones, tasks) which are unloaded there
    lifting: Ints  # (tasks,) how long loads are taken up; -1 for tasks without one
    unloading: Ints  # (tasks,)


def no_docks() -> Docks:
    """Return what stands for docks where there are none."""
    flat, table = np.zeros((0, 0), np.int32), np.zeros((0, 2), np.int64)
    return Docks(table[:, 0].copy(), table, flat, flat, table[:, 0].copy(), table[:, 0].copy())


def have_docks(docks: Docks) -> bool:
    """Say whether loads are taken up or unloaded in zones."""
    return len(docks.room) > 0


def docks_of(
    rooms: Sequence[RoomLeft],
    lifting: Sequence[float],
    unloading: Sequence[float],
    ticks: Callable[[npt.ArrayLike], Ints],
    now: float,
) -> Docks:
    """Return the docks of a problem if any of its loads takes room in a zone.

    Both times are those of all tasks, the first less than 0 without a load; `ticks` counts them.
    """
    is_load = np.array(lifting) >= 0
    if not any(room.loads or is_load[sorted(room.tasks)].any() for room in rooms):
        return no_docks()
    taken = [(zone, int(ticks(until - now)))
             for zone, room in enumerate(rooms) for until in room.taken if until > now]  # fmt: skip

    def table(rows: Sequence[frozenset[int]]) -> Int32s:
        return np.array([[k in row for k in range(len(lifting))] for row in rows], np.int32)

    return Docks(
        np.array([room.room for room in rooms], np.int64),
        np.array(taken, np.int64).reshape(-1, 2),
        table([room.tasks for room in rooms]),
        table([room.loads for room in rooms]),
        np.where(is_load, ticks(lifting), -1),
        ticks(unloading),
    )


def rooms_of_docks(docks: Docks) -> list[RoomLeft]:
    """Return the rooms that docks are."""
    inside, brought = ([frozenset(np.flatnonzero(row).tolist()) for row in table]
                       for table in (docks.tasks, docks.loads))  # fmt: skip
    return [
        RoomLeft(
            inside[zone],
            int(room),
            tuple(docks.taken[docks.taken[:, 0] == zone, 1].tolist()),
            brought[zone],
        )
        for zone, room in enumerate(docks.room)
    ]
