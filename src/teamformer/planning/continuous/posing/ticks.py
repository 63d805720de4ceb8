"""How times become ticks, whole numbers, and by how much they are off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Floats, Ints
from teamformer.mission.parts.shifts import rotas_of
from teamformer.planning.continuous.posing.remaining import Remaining
from teamformer.planning.continuous.posing.tables import ticks_in_a_unit

WHOLE = 1e-6
"""By how much of a tick a time may be off that counts as whole."""

NO_WAY = 1000
"""Where no way is, it takes this many times longer than everything."""


@dataclass(frozen=True)
class Ticks:
    """So many ticks are in a unit of time; `never` stands for times that are infinite."""

    scale: float
    never: float

    def of(self, times: npt.ArrayLike) -> Ints:
        """Return times in ticks."""
        finite = np.where(np.isfinite(times), times, self.never)
        return np.rint(finite * self.scale).astype(np.int64)


def ticks_of(rest: Remaining) -> Ticks:
    """Return the ticks in which a problem is posed."""
    busy, waits = rest.busy, rest.longest_wait
    scale = ticks_in_a_unit(busy, waits, sum(task.weight for task in rest.own_tasks))
    return Ticks(scale, NO_WAY * (busy + waits))


def rounding_of(tasks: int) -> int:
    """Return by how many ticks a time may be off: what is rounded in a chain, half a tick each."""
    return tasks + 2


def rounding_in(rest: Remaining, scale: float) -> int:
    """Return by how many ticks times of a problem are off: by none if all are whole ticks."""
    parts = (*_times(rest), rest.mission.forming)
    is_exact = all(_are_whole(np.multiply(part, scale)) for part in parts)
    return 0 if is_exact and not rotas_of(rest.own_robots) else rounding_of(len(rest.tasks))


def grain_of(rest: Remaining, scale: float) -> int:
    """Return of how many ticks all times of a problem are multiples; 1 if some are rounded.

    So is the end of every plan, if nobody charges.
    """
    if rounding_in(rest, scale) or rest.mission.charging is not None:
        return 1
    starts = [length for gap in rest.gaps for length in (gap.least, gap.most)]
    rooms = [until - rest.known.now for room in rest.rooms for until in room.taken]
    times = (*_times(rest), rest.mission.forming, starts, rooms)
    ticks = np.concatenate([np.ravel(np.multiply(part, scale)) for part in times])
    return max(1, int(np.gcd.reduce(np.rint(ticks[np.isfinite(ticks)]).astype(np.int64))))


def _times(rest: Remaining) -> tuple[npt.ArrayLike, ...]:
    """Return the lengths of time of which plans are made up."""
    release = np.subtract(rest.release, rest.known.now)
    return rest.ways, rest.home, rest.carry, rest.takes, rest.ready, release


def _are_whole(ticks: Floats) -> bool:
    """Say whether times are whole ticks, but for what a product of two fractions is off by."""
    finite = ticks[np.isfinite(ticks)]
    return bool((np.abs(finite - np.rint(finite)) < WHOLE).all())
