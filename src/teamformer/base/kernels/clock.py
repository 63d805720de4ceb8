"""Time without compiling: a first run compiles for most of its time, which tells nothing of it."""

from __future__ import annotations

import time

_compiled = [0.0]
"""Seconds that this process has compiled for."""
_begun = list[float]()
"""When what is being compiled was begun; what a function calls is compiled within that."""


def begin_compiling() -> bool:
    """Have the clock of work stand still; return whether it went until now."""
    _begun.append(time.perf_counter())
    return len(_begun) == 1


def end_compiling() -> None:
    """Have the clock of work go on, once all is compiled that was begun."""
    begun = _begun.pop()
    if not _begun:
        _compiled[0] += time.perf_counter() - begun


def compiling_seconds() -> float:
    """Return how many seconds this process has compiled for until now."""
    return _compiled[0]


def working_seconds() -> float:
    """Return the seconds of a clock that stands still while this process compiles."""
    return time.perf_counter() - _compiled[0]
