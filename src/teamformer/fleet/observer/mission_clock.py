"""How long a mission has been going on, by what its robots say; no clock: every moment is said."""

from __future__ import annotations


class MissionClock:
    """The mission's time at any moment, once a robot has been heard; both in seconds."""

    def __init__(self, longest: float) -> None:
        self._longest = longest  # before it was heard first; what is more is cut off
        self._born = self._heard = float("inf")

    @property
    def is_set(self) -> bool:
        """Say whether a robot has been heard."""
        return self._heard < float("inf")

    def hear(self, age: float, now: float) -> None:
        """Note how long the mission has been going on by a robot: the longest holds."""
        self._heard = min(self._heard, now)
        self._born = min(self._born, now - min(age, self._longest))

    def age(self, now: float) -> float:
        """Return how long the mission has been going on."""
        return now - self._born

    def listened(self, now: float) -> float:
        """Return for how long robots have been heard."""
        return now - self._heard
