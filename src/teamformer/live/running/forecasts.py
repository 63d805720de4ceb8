"""How a mission ends if nothing more happens: played ahead, in many futures where it is uncertain.

A future is a truth that could be behind what has been seen so far, and the mission is played to its
end in it. How that is done depends on its time: `live/steps` and `live/continuous` do it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from teamformer.mission.coordination import Plan
from teamformer.mission.model import Mission

SAMPLES = 40
"""Futures at most."""

SECONDS = 20.0
"""For all futures together."""

BAND = (0.1, 0.9)
"""The parts of the futures that have ended by the two moments of a band."""

IsOver = Callable[[], bool]
"""Says that nobody wants to know any more."""


def never() -> bool:
    """Say that somebody still wants to know."""
    return False


class Played(NamedTuple):
    """A future that was played: how and when it ended, and by task when it was done, or None.

    Times are in steps or, in continuous time, in the mission's unit, here as everywhere below.
    """

    status: str
    end: float
    done_at: Sequence[float | None]


class Past(Protocol):
    """The present of a mission, and how it came about."""

    @property
    def mission(self) -> Mission:
        """Return the mission with all that has happened to it."""

    @property
    def tasks(self) -> tuple[int, int]:
        """Return how many tasks there are that everybody may know of, and how many in all.

        Those that are to appear at random yet are the last.
        """

    @property
    def is_planned(self) -> bool:
        """Say whether robots go by plans of a coordinator."""

    def play_ahead(self, is_over: IsOver) -> Played:
        """Play to the end, or until nobody wants to know any more."""

    def future(self, seed: int) -> Past | None:
        """Return the present under a truth that is drawn; None if the past would be another."""

    def with_plan(self, plan: Plan) -> Past:
        """Return the same if a plan were taken over now."""

    def search_plan(self, seconds: float, seed: int, is_over: IsOver) -> Plan:
        """Search for a better plan from the present on; it is never worse than the one in force."""


class Unfinished(NamedTuple):
    """How a mission ended that was not completed, and when."""

    status: str
    end: float


@dataclass(frozen=True)
class Forecast:
    """How a mission ends, in one future or several: the ends of those done, the first one first.

    `done_at` has for each task the mean time at which it is done, over the futures in which it is;
    None if it is in none.
    """

    futures: int
    ends: tuple[float, ...]
    otherwise: Unfinished | None = None  # of one that is not done
    done_at: tuple[float | None, ...] = ()

    def text(self, unit: str = " steps") -> str:
        """Return how it ends as words; `unit` stands behind times."""
        is_sure = self.futures == len(self.ends)
        part = "" if is_sure else f" in {len(self.ends)} of {self.futures} futures"
        if not self.ends:
            assert self.otherwise is not None
            return f"{self.otherwise.status} after {self.otherwise.end:g}{unit}"
        low, high = self.band
        when = f"{low:g}" if low == high else f"{low:g} to {high:g}"
        return f"done after {when}{unit}{part}"

    @property
    def band(self) -> tuple[float, float]:
        """Return the times by which a tenth and nine tenths of the futures done are done."""
        low, high = (self.ends[int(part * (len(self.ends) - 1) + 0.5)] for part in BAND)
        return low, high

    @property
    def rank(self) -> tuple[int, float]:
        """Return what is lower for better forecasts: futures not done, then the mean end."""
        return self.futures - len(self.ends), self.mean if self.ends else 0.0

    @property
    def mean(self) -> float:
        """Return the mean end of the futures that are done."""
        return sum(self.ends) / len(self.ends)


def forecast(past: Past, is_over: IsOver = never) -> Forecast:
    """Return how the mission ends; `is_over` says that nobody wants to know any more."""
    if not past.mission.has_surprises:
        return _summed_up([past.play_ahead(is_over)], past)
    until = time.monotonic() + SECONDS
    played: list[Played] = []
    for seed in range(SAMPLES):
        future = past.future(seed)
        if future is not None:
            played.append(future.play_ahead(is_over))
        if played and (is_over() or time.monotonic() > until):
            break
    return _summed_up(played or [past.play_ahead(never)], past)


def _summed_up(played: Sequence[Played], now: Past) -> Forecast:
    """Return how plays of the present end; those tasks count that have appeared by now."""
    done = sorted(one.end for one in played if one.status == "completed")
    others = [Unfinished(one.status, one.end) for one in played if one.status != "completed"]
    known, count = now.tasks
    rows = zip(*(one.done_at[:known] for one in played), strict=True)
    done_at = tuple(_mean([end for end in ends if end is not None]) for ends in rows)
    unknown = (None,) * (count - known)
    return Forecast(len(played), tuple(done), others[0] if others else None, done_at + unknown)


def _mean(ends: Sequence[float]) -> float | None:
    return sum(ends) / len(ends) if ends else None
