"""The seam to the network: send bytes to everybody or to one, and take what has come."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Sequence
from typing import Protocol

MOST_A_SECOND = 100
MOST_BYTES_A_SECOND = 200_000
"""What one sender may say; more is dropped and counted, so that nobody can flood the others."""


class Transport(Protocol):
    """Carries messages; it may lose, double, delay and reorder them, but not change them."""

    def send(self, to: int, data: bytes) -> None:
        """Send to a robot, or to EVERYBODY that listens to the sender."""

    def listen_to(self, robots: Iterable[int]) -> None:
        """Take from now on what these robots say to everybody, and no others."""

    def receive(self, seconds: float) -> Sequence[bytes]:
        """Wait so long at most for messages; return all that have come."""

    def close(self) -> None:
        """Say no more."""


class Sluice:
    """Lets through what one sender may say in a second."""

    def __init__(self) -> None:
        self.dropped = 0
        self._said: dict[int, deque[tuple[float, int]]] = {}
        self._bytes: dict[int, int] = {}

    def lets(self, sender: int, size: int, now: float | None = None) -> bool:
        """Say whether a message of so many bytes may pass."""
        now = time.monotonic() if now is None else now
        said = self._said.setdefault(sender, deque())
        while said and said[0][0] < now - 1.0:
            self._bytes[sender] -= said.popleft()[1]
        total = self._bytes.get(sender, 0)
        if len(said) >= MOST_A_SECOND or total + size > MOST_BYTES_A_SECOND:
            self.dropped += 1
            return False
        said.append((now, size))
        self._bytes[sender] = total + size
        return True
