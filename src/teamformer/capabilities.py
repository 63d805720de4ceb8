"""Arithmetic on capability counts: mappings from a capability's name to how often it is there.

A count that is zero and one that is absent mean the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

Counts = Mapping[str, int]


def total(parts: Iterable[Counts]) -> dict[str, int]:
    """Add up the counts of several robots or teams."""
    result: dict[str, int] = {}
    for part in parts:
        for name, count in part.items():
            result[name] = result.get(name, 0) + count
    return result


def covers(have: Counts, need: Counts) -> bool:
    """Say whether every needed count is there."""
    return all(have.get(name, 0) >= count for name, count in need.items())


def missing(have: Counts, need: Counts) -> dict[str, int]:
    """Return what is needed beyond what is there, without zeros."""
    short = {name: count - have.get(name, 0) for name, count in need.items()}
    return {name: count for name, count in short.items() if count > 0}


def describe(counts: Counts) -> str:
    """Write counts for people: `lift, 2 x weld`."""
    return ", ".join(
        name if count == 1 else f"{count} x {name}" for name, count in counts.items() if count
    )
