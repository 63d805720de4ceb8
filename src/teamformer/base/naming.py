"""Names in a sentence."""

from __future__ import annotations

from collections.abc import Iterable

MANY = 3
"""Names that are written out where more would be too many to read."""


def listed(names: Iterable[object], most: int = MANY) -> str:
    """Return names as a text: the first ones of many, and how many more there are."""
    every = [str(name) for name in names]
    more = f" and {len(every) - most} more" if len(every) > most else ""
    return ", ".join(every[:most]) + more
