"""Which robots of a fleet an onlooker has not heard for a while, in words."""

from __future__ import annotations

from collections.abc import Sequence

SILENCE = 10.0
"""Seconds without any word of a robot after which it counts as not heard."""


class Silence:
    """When each robot was heard last; no clock: every moment is said, in seconds."""

    def __init__(self, names: Sequence[str], now: float) -> None:
        self._names = tuple(names)
        self._heard_at = [now] * len(self._names)
        self._unheard: tuple[str, ...] = ()
        self._fault = ""

    def hear(self, robot: int, now: float) -> None:
        """Note that a message of a robot has come."""
        self._heard_at[robot] = now

    def refuse(self, fault: str) -> None:
        """Note that a message has come that is none of the fleet's, and why."""
        self._fault = fault

    def changes(self, now: float) -> bool:
        """Look who is not heard now; say whether these are others than before."""
        before = self._unheard
        pairs = zip(self._names, self._heard_at, strict=True)
        self._unheard = tuple(name for name, at in pairs if now - at > SILENCE)
        return self._unheard != before

    @property
    def warning(self) -> str:
        """Say which robots are not heard, and what to look at if none is; empty if all are."""
        if not self._unheard:
            return ""
        if len(self._unheard) < len(self._names):
            return f"not heard for {SILENCE:g} s: {', '.join(self._unheard)}"
        why = f" (what came was refused: {self._fault})" if self._fault else ""
        return (
            f"no robot has been heard for {SILENCE:g} s{why}; does the fleet run, and are its "
            "scenario, endpoint and --keys the same here?"
        )
