"""Named places and the time that each way between them takes, instead of a map."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

GROUND, AIR = "ground", "air"
"""How robots move: on the ground if they do not say how."""

LONGEST_WAY = 1e9
"""In the mission's unit of time."""

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class Roads:
    """Named places, and the time of the way from each place to each other one.

    `times[mover][a][b]` is the time from place number a to place number b at speed 1, in the
    mission's unit, or infinite where no way leads there directly. Then a robot goes by other
    places, as quickly as can be; `ways` has how long it takes. The way back may take a different
    time. There is a matrix for each kind of mover, and a robot's `moves` chooses its matrix. A
    robot or task at place number a is `at` (a, 0); the method `at` turns a name into that. A world
    of roads has no coordinates and no steps, so its missions are in continuous time.
    """

    places: tuple[str, ...]
    times: Mapping[str, Rows]

    rows: ClassVar[tuple[str, ...]] = ()  # nothing is blocked
    # What the other worlds have too; only steps would need it, where roads are refused.
    width: ClassVar[float] = 1.0
    height: ClassVar[float] = 1.0
    corner: ClassVar[tuple[float, float]] = (1.0, 1.0)
    arrival_radius: ClassVar[float] = 0.0
    unit: ClassVar[float] = 1.0
    y_axis: ClassVar[str] = "up"

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return {name: number for number, name in enumerate(self.places)}

    def at(self, name: str) -> tuple[float, float]:
        """Return the `at` of a robot or task at a named place; KeyError for an unknown name."""
        return self._numbers[name], 0

    def name_of(self, place: tuple[float, float]) -> str:
        """Return the name of a place."""
        return self.places[int(place[0])]

    def is_inside(self, place: tuple[float, float]) -> bool:
        """Say whether this is one of the places."""
        number, zero = place
        return zero == 0 and number in range(len(self.places))

    def is_free(self, place: tuple[float, float]) -> bool:
        """Say whether a robot can be there: at every place."""
        return self.is_inside(place)

    def region(self, place: tuple[float, float]) -> int:
        """Return the connected part that a place lies in: there is only one."""
        return 0

    def pace(self, speed: float) -> float:
        """Return by how much a robot is faster than the times say."""
        return speed

    @cached_property
    def ways(self) -> Mapping[str, Rows]:
        """Return how long robots take from each place to each other one, infinite if they cannot.

        That is by `times` where there is a direct way, else by way of other places.
        """
        return {mover: _fill_gaps(rows) for mover, rows in self.times.items()}

    def leads(self, mover: str, here: tuple[float, float], there: tuple[float, float]) -> bool:
        """Say whether a mover gets from one place to another; one without a table, everywhere."""
        rows = self.ways.get(mover)
        return rows is None or math.isfinite(rows[int(here[0])][int(there[0])])

    @property
    def longest_way(self) -> float:
        """Return the longest time between two places, whatever moves."""
        times = (time for rows in self.ways.values() for row in rows for time in row)
        return max(filter(math.isfinite, times), default=0.0)

    def problems(self) -> Iterator[str]:
        """Return what is wrong with the roads themselves."""
        if not self.places:
            yield "the roads have no places; name one or more"
        if len(self._numbers) < len(self.places):
            twice = next(name for name in self.places if self.places.count(name) > 1)
            yield f"the roads have two places '{twice}'; rename one"
        if not self.times:
            yield "the roads have no times; give a matrix"
        for mover, rows in self.times.items():
            if {len(row) for row in rows} | {len(rows)} != {len(self.places)}:
                yield f"the times by {mover} are no square matrix of {len(self.places)} places"
            for a, row in enumerate(rows):
                for b, time in enumerate(row):
                    if not is_way(time):
                        yield f"the time by {mover} from place {a} to {b} is {time:g}; use 0 to 1e9"
                        return


def is_way(time: float) -> bool:
    """Say whether this can be the time of a way; infinity says that there is none."""
    return 0 <= time <= LONGEST_WAY or time == math.inf


def _fill_gaps(times: Rows) -> Rows:
    """Return times with the quickest way by other places where there is no direct one."""
    direct = np.array(times)
    has_way = np.isfinite(direct)
    if has_way.all():
        return times
    quickest = direct.copy()
    np.fill_diagonal(quickest, 0.0)
    for by in range(len(direct)):
        np.minimum(quickest, quickest[:, by, None] + quickest[by], out=quickest)
    return tuple(map(tuple, np.where(has_way, direct, quickest).tolist()))
