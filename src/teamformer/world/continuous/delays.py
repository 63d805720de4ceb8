"""How long robots take that stand still at times: outside their shifts, and where delayed.

Delays are of whole units of time, as steps have it.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Iterator, Sequence

from teamformer.mission.model import Robot
from teamformer.mission.parts.shifts import ALWAYS, Rota, Shift

MASK = 2**64 - 1


class StandingStill:
    """In which units of time each robot is delayed, drawn from a seed that is part of the truth.

    They are worked out as far as somebody asks, and stay the same whoever asks. A robot alone
    stands still outside its shifts, too; a load is not carried then, it is set down.
    """

    def __init__(self, robots: Sequence[Robot]) -> None:
        self._robots = robots
        self._states = [_first_state(r.delays.seed or 0) if r.delays else 0 for r in robots]
        self._stands: list[list[bool]] = [[] for _ in robots]

    def fork(self) -> StandingStill:
        """Return another one that says the same, for somebody who asks at the same time."""
        twin = copy.copy(self)
        twin._states, twin._stands = list(self._states), [list(row) for row in self._stands]
        return twin

    def after(self, who: Iterable[int], begin: float, spent: float) -> float:
        """Return when robots that walk together have walked so long, from a moment on.

        They walk only in units of time in which none of them stands still.
        """
        robots, left = list(who), spent
        if not any(self._robots[robot].delays for robot in robots):
            return self._rota(robots).walked(begin, spent)
        for opens, closes in self._walks(robots, begin):
            if left <= closes - opens:
                return opens + left
            left -= closes - opens
        return math.inf

    def walked(self, who: Iterable[int], begin: float, end: float) -> float:
        """Return how long robots that are together on their way walk between two moments."""
        robots, done = list(who), 0.0
        if not any(self._robots[robot].delays for robot in robots):
            return self._rota(robots).worked(begin, end)
        for opens, closes in self._walks(robots, begin):
            if opens >= end:
                break
            done += min(end, closes) - opens
        return done

    def _rota(self, robots: Sequence[int]) -> Rota:
        return self._robots[robots[0]].rota if len(robots) == 1 else ALWAYS

    def _walks(self, robots: Sequence[int], begin: float) -> Iterator[Shift]:
        """Yield from when to when robots walk together, unit of time by unit of time."""
        delayed = [robot for robot in robots if self._robots[robot].delays is not None]
        for opens, closes in self._rota(robots).since(begin):
            now = max(begin, opens)
            while now < closes:
                unit = math.floor(now)
                until = min(unit + 1.0, closes)
                if not any(self._is_still(robot, unit) for robot in delayed):
                    yield now, until
                now = until

    def _is_still(self, robot: int, unit: int) -> bool:
        stands, delays = self._stands[robot], self._robots[robot].delays
        assert delays is not None, "only those are asked about"
        while len(stands) <= unit:
            state = self._states[robot] = _next_state(self._states[robot])
            stands.append((state >> 11) / 2**53 < delays.chance)
        return stands[unit]


def _first_state(seed: int) -> int:
    return (seed * 2654435769 + 88172645463325252) % 2**64


def _next_state(state: int) -> int:
    """Return the state after this one: xorshift64, as kernels draw."""
    state ^= state << 13 & MASK
    state ^= state >> 7
    return state ^ (state << 17 & MASK)
