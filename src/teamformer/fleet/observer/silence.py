"""Which robots of a fleet an onlooker has not heard for a while, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

SILENCE = 10.0
"""Seconds without any word of a robot after which it counts as not heard."""


class Unheard(NamedTuple):
    """Which robots are not heard, in words around the seconds for which that is so."""

    before: str
    seconds: int
    after: str
    is_of_all: bool

    def text(self) -> str:
        """Return the words with the seconds."""
        return f"{self.before}{self.seconds} s{self.after}"


class Silence:
    """When each robot was heard last; no clock: every moment is said, in seconds."""

    def __init__(self, names: Sequence[str], now: float) -> None:
        self._names = tuple(names)
        self._heard_at = [now] * len(self._names)
        self._unheard: tuple[int, ...] = ()
        self._fault = ""
        self.was_any_heard = False

    def hear(self, robot: int, now: float) -> None:
        """Note that a message of a robot has come."""
        self._heard_at[robot] = now
        self.was_any_heard = True

    def refuse(self, fault: str) -> None:
        """Note that a message has come that is none of the fleet's, and why."""
        self._fault = fault

    def changes(self, now: float) -> bool:
        """Look who is not heard now; say whether these are others than before."""
        before = self._unheard
        self._unheard = tuple(r for r, at in enumerate(self._heard_at) if now - at > SILENCE)
        return self._unheard != before

    def warning(self, now: float) -> Unheard | None:
        """Return which robots are not heard, and what to look at if none is; None if all are."""
        if not self._unheard:
            return None
        seconds = int(now - max(self._heard_at[robot] for robot in self._unheard))
        if len(self._unheard) < len(self._names):
            names = ", ".join(self._names[robot] for robot in self._unheard)
            return Unheard("not heard for ", seconds, f": {names}", is_of_all=False)
        why = f" (what came was refused: {self._fault})" if self._fault else ""
        start = "" if self.was_any_heard else "; what is drawn is only where the robots start"
        after = (
            f"{why}{start}; does the fleet run, and are its scenario, endpoint and --keys the "
            "same here?"
        )
        return Unheard("no robot heard for ", seconds, after, is_of_all=True)
