"""The time that a training may take, all counted: its start, its exams, and writing it down."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from teamformer.learning.algorithms import distributed

GUESSES = {"iteration": 0.0, "exam": 0.0, "export": 20.0}
"""Seconds that parts of a training are expected to take as long as none was measured."""


class Budget:
    """The seconds that a training has taken, those of earlier sessions included, and what is left.

    Every part of it is expected to take as long as it took at most so far. `begun` is when this
    session began, by `time.perf_counter`.
    """

    def __init__(self, minutes: float | None, device: str, begun: float | None = None) -> None:
        self.before = 0.0  # seconds that earlier sessions took
        self._minutes, self._device = minutes, device
        self._begun = time.perf_counter() if begun is None else begun
        self._longest: dict[str, float] = {}

    @property
    def seconds(self) -> float:
        """Return the seconds that the training has taken, the same in all processes."""
        elapsed = time.perf_counter() - self._begun
        return self.before + distributed.agreed([elapsed], self._device)[0]

    def is_spent(self, *to_come: str) -> bool:
        """Say whether there is no time left for what is still to come."""
        if self._minutes is None:
            return False
        expected = sum(self._longest.get(part, GUESSES[part]) for part in to_come)
        return self.seconds + expected >= 60 * self._minutes

    @contextmanager
    def spent_on(self, part: str) -> Iterator[None]:
        """Measure a part of the training: an `iteration`, an `exam` or an `export`."""
        begun = time.perf_counter()
        yield
        [seconds] = distributed.agreed([time.perf_counter() - begun], self._device)
        self._longest[part] = max(self._longest.get(part, 0.0), seconds)
