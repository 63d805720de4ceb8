"""When robots work that have shifts: how long walks take then, and when something fits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

Shift = tuple[float, float]
"""When a shift begins and ends."""

SAME = 1e-9
"""Moments nearer than this share of the time that has passed are the same: sums are rounded."""

MOST_TRIED = 100
"""After so many attempts nobody looks further for a moment that suits the shifts of several."""


@dataclass(frozen=True)
class Rota:
    """The shifts of a robot in the order of time; `every` is after how long they come again.

    Without shifts it always works; without `every` (0) it never works again after the last one.
    """

    shifts: tuple[Shift, ...] = ()
    every: float = 0.0

    def __bool__(self) -> bool:
        """Say whether there are times at which it does not work."""
        return bool(self.shifts)

    @property
    def longest(self) -> float:
        """Return how long its longest shift is."""
        return max((closes - opens for opens, closes in self.shifts), default=math.inf)

    @property
    def share(self) -> float:
        """Return in which share of its time it works as long as shifts come again."""
        if not self.every:
            return 1.0
        return sum(closes - opens for opens, closes in self.shifts) / self.every

    @property
    def over(self) -> float:
        """Return from when on it never works again; infinite if there is no such moment."""
        return self.shifts[-1][1] if self.shifts and not self.every else math.inf

    def since(self, now: float) -> Iterator[Shift]:
        """Yield its shifts that are not over at a moment, one after the other; perhaps for ever."""
        if not self.shifts:
            yield 0.0, math.inf
            return
        turn = max(0, math.floor((now - self.shifts[0][0]) / self.every)) if self.every else 0
        while True:
            later = turn * self.every
            for opens, closes in self.shifts:
                if closes + later >= now:
                    yield opens + later, closes + later
            if not self.every:
                return
            turn += 1

    def counted_from(self, now: float) -> Rota:
        """Return the same shifts with times that are counted from a moment."""
        return Rota(tuple((opens - now, closes - now) for opens, closes in self.shifts), self.every)

    def is_at_work(self, now: float) -> bool:
        """Say whether it works at a moment; it does when a shift begins, not when one ends."""
        return any(opens <= now < closes for opens, closes in _next_two(self, now))

    def walks(self, begin: float, spent: float) -> Iterator[Shift]:
        """Yield from when to when it walks that has so long to walk; its walk pauses in between.

        It begins at `begin`, or with the next shift. If it never gets there, nothing more comes.
        """
        left = spent
        for opens, closes in self.since(begin):
            start = max(begin, opens)
            if start + left <= closes + SAME * max(1.0, abs(closes)):
                yield start, start + left
                return
            if closes > start:
                yield start, closes
                left -= closes - start

    def walked(self, begin: float, spent: float) -> float:
        """Return when it has walked so long that sets out at `begin`; infinite if it never has."""
        if not self.shifts or spent <= 0 or math.isinf(begin + spent):
            return begin + spent
        done, end = 0.0, begin
        for start, end in self.walks(begin, spent):
            done += end - start
        return end if done >= spent - SAME * max(1.0, abs(end)) else math.inf

    def ends_leg(self, begin: float, spent: float) -> float:
        """Return when it is at the next place that stands between two, be its last shift over."""
        end = self.walked(begin, spent)
        return begin + spent if math.isinf(end) else end

    def goes_on(self, now: float) -> float:
        """Return the first moment at or after one at which it works; infinite if it never does."""
        if not self.shifts:
            return now
        return next(
            (max(now, opens) for opens, closes in self.since(now) if closes > now), math.inf
        )

    def next_border(self, now: float) -> tuple[float, bool] | None:
        """Return when a shift begins or ends next after a moment, and whether it begins; or None.

        Where shifts touch the one that ends comes first, at the same time as the other one.
        """
        for opens, closes in _next_two(self, now):
            if opens > now:
                return opens, True
            if closes > now:
                return closes, False
        return None

    def worked(self, begin: float, end: float) -> float:
        """Return how long it works between two moments."""
        if not self.shifts:
            return end - begin
        done = 0.0
        for opens, closes in self.since(begin):
            if opens >= end:
                break
            done += min(end, closes) - max(begin, opens)
        return done

    def fits(self, earliest: float, takes: float) -> float:
        """Return the first moment from which something that takes so long is within a shift."""
        if not takes <= self.longest + SAME:
            return math.inf
        for opens, closes in self.since(earliest):
            start = max(earliest, opens)
            if start + takes <= closes + SAME * max(1.0, abs(closes)):
                return start
        return math.inf


ALWAYS = Rota()
"""Of a robot without shifts."""


class HasRota(Protocol):
    """A robot."""

    @property
    def rota(self) -> Rota:
        """Return when it works."""


def rotas_of(robots: Sequence[HasRota]) -> tuple[Rota, ...]:
    """Return when each robot works; nothing where all always do."""
    rotas = tuple(robot.rota for robot in robots)
    return rotas if any(rotas) else ()


def fits_all(rotas: Sequence[Rota], earliest: float, takes: float) -> float:
    """Return the first moment from which something is within a shift of each, infinite if none."""
    bound = [rota for rota in rotas if rota]
    for _ in range(MOST_TRIED if bound else 0):
        start = max(rota.fits(earliest, takes) for rota in bound)
        if start in (earliest, math.inf):
            return start
        earliest = start
    return math.inf if bound else earliest


def fits_now(rotas: Sequence[Rota], now: float, takes: float) -> bool:
    """Say whether something that begins now is within a shift of each."""
    return fits_all(rotas, now, takes) == now


def _next_two(rota: Rota, now: float) -> list[Shift]:
    """Return the shift that ends at or after a moment, and the next one."""
    return [shift for shift, _ in zip(rota.since(now), range(2), strict=False)]
