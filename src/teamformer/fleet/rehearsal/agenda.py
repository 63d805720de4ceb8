"""The agenda of a rehearsal: the ticks in which something happens, and what."""

from __future__ import annotations

import heapq
from collections import defaultdict

from teamformer.fleet.messages import Message

Happening = tuple[str, int]
"""What begins or ends, and whom or which fault it is about."""

Letter = tuple[int, int, Message]
"""From whom, to whom, and what."""


class Agenda:
    """What comes when; whole ticks, and none twice."""

    def __init__(self) -> None:
        self.happenings: dict[int, list[Happening]] = defaultdict(list)
        self.letters: dict[int, list[Letter]] = defaultdict(list)
        self.wakes: dict[int, list[int]] = defaultdict(list)
        self._ticks: list[int] = []
        self._planned: set[int] = set()

    def __bool__(self) -> bool:
        return bool(self._ticks)

    def visit(self, tick: int) -> None:
        """Have a look at a tick, whether anything is to happen in it or not."""
        if tick not in self._planned:
            self._planned.add(tick)
            heapq.heappush(self._ticks, tick)

    def next_tick(self) -> int:
        """Take the earliest tick off the agenda and return it."""
        tick = heapq.heappop(self._ticks)
        self._planned.discard(tick)
        return tick
