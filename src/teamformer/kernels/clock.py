"""Time without compiling: a first run compiles for most of its time, which tells nothing of it."""

from __future__ import annotations

import time

_compiled = [0.0]
"""Seconds that this process has compiled for; the compiler adds to them."""


def add_compiling(seconds: float) -> None:
    """Add what compiling has taken."""
    _compiled[0] += seconds


def compiling_seconds() -> float:
    """Return how many seconds this process has compiled for until now."""
    return _compiled[0]


def working_seconds() -> float:
    """Return the seconds of a clock that stands still while this process compiles."""
    return time.perf_counter() - _compiled[0]
