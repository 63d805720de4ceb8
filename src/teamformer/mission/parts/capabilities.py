"""Arithmetic on capability counts: mappings from a capability's name to how much of it is there.

A count that is zero and one that is absent mean the same. Counts may be fractions, such as
capacities in kilograms, exact to three places: every result is rounded to them, so that it is the
number that one would write down, 0.3 for 0.1 and 0.2. Arrays hold counts in units, whole numbers:
the unit of a capability is what all robots bring whole multiples of.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

Counts = Mapping[str, float]

PLACES = 3
ONE: int = 10**PLACES
"""Units are given in thousandths, and this is a whole one."""


def exact(count: float) -> float:
    """Return a count as one would write it: to three places, and without a fraction if it can be.

    What is no finite number stays what it is.
    """
    if isinstance(count, int) or not math.isfinite(count):
        return count
    rounded = round(float(count), PLACES)
    return int(rounded) if rounded.is_integer() else rounded


def is_exact(count: float) -> bool:
    """Say whether a count is a finite number of no more than three places."""
    return math.isfinite(count) and exact(count) == count


def total(parts: Iterable[Counts]) -> dict[str, float]:
    """Add up the counts of several robots or teams."""
    result: dict[str, float] = {}
    for part in parts:
        for name, count in part.items():
            result[name] = exact(result.get(name, 0) + count)
    return result


def covers(have: Counts, need: Counts) -> bool:
    """Say whether every needed count is there."""
    return all(have.get(name, 0) >= count for name, count in need.items())


def missing(have: Counts, need: Counts) -> dict[str, float]:
    """Return what is needed beyond what is there, without zeros."""
    short = {name: exact(count - have.get(name, 0)) for name, count in need.items()}
    return {name: count for name, count in short.items() if count > 0}


def describe(counts: Counts) -> str:
    """Write counts for people: `lift, 2 x weld`."""
    return ", ".join(
        name if count == 1 else f"{written(count)} x {name}"
        for name, count in counts.items()
        if count
    )


def written(count: float) -> str:
    """Write a count: `2`, `12.5`."""
    return str(exact(count))


def units_of(parts: Iterable[Counts]) -> dict[str, int]:
    """Return the unit of each capability that robots bring, in thousandths.

    It is one where all counts are whole numbers; else the largest that all are multiples of.
    """
    units: dict[str, int] = {}
    for part in parts:
        for name, count in part.items():
            units[name] = math.gcd(units.get(name, 0), _thousandths(count))
    return {name: ONE if unit % ONE == 0 else unit for name, unit in units.items()}


def in_units(counts: Counts, units: Mapping[str, int]) -> dict[str, int]:
    """Return counts in whole units, rounded up; units are one where none is given.

    Who brings whole units has as much as is needed if, and only if, that is so in units.
    """
    return {name: -(-_thousandths(count) // units.get(name, ONE)) for name, count in counts.items()}


def out_of_units(counts: Mapping[str, int], units: Mapping[str, int]) -> dict[str, float]:
    """Return counts given in whole units as they are written."""
    return {name: exact(count * units.get(name, ONE) / ONE) for name, count in counts.items()}


def _thousandths(count: float) -> int:
    return round(count * ONE)
