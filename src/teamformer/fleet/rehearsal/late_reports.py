"""What a body reports in a rehearsal: what is true, or what was, where the schedule says so."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from teamformer.fleet.bodies.body import Report

EVERY = 0.1
"""Seconds between two reports of nothing but another place."""


class LateReports:
    """The reports of one body, each `lag` seconds late; at times an older one comes again.

    `chance` draws from the schedule's random numbers whether something of a probability happens.
    """

    def __init__(self, lag: float, stutter: float, chance: Callable[[float], bool]) -> None:
        self.lag = lag
        self._stutter = stutter
        self._chance = chance
        self._kept: deque[tuple[float, Report]] = deque()

    def is_news(self, report: Report) -> bool:
        """Say whether there was no report yet, or another was the last."""
        return not self._kept or self._kept[-1][1] != report._replace(number=self._newest.number)

    def is_due(self, now: float, report: Report) -> bool:
        """Say whether news is to be kept now: nothing but another place has to wait."""
        if not self._kept:
            return True
        newest = self._newest
        slow = report._replace(x=newest.x, y=newest.y, charge=newest.charge)
        if newest != slow._replace(number=newest.number):
            return True
        return now - self._kept[-1][0] > EVERY - 1e-9

    @property
    def _newest(self) -> Report:
        return self._kept[-1][1]

    def keep(self, now: float, report: Report) -> None:
        """Keep a report until its time has come."""
        self._kept.append((now, report))

    def at(self, now: float) -> Report:
        """Return what the body reports now."""
        kept, lag, stutter = self._kept, self.lag, self._stutter
        while len(kept) > 2 and kept[1][0] <= now - lag:
            if stutter and self._chance(stutter):
                break
            kept.popleft()
        if len(kept) == 2 and kept[1][0] <= now - lag:
            return kept[1][1] if not self._chance(stutter) else kept[0][1]
        return kept[0][1]

    def forget(self) -> None:
        """Forget what was reported, as a robot does that starts anew."""
        self._kept.clear()
