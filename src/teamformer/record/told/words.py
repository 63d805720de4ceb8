"""Words that stories of robots have in common, in steps and in continuous time."""

from __future__ import annotations

from collections.abc import Sequence

MANY = 3
"""Names that are written out where more would be too many to read."""


def listed(names: Sequence[str]) -> str:
    """Return names in a row; of many the first, and how many more there are."""
    shown = ", ".join(names[:MANY])
    return f"{shown} and {len(names) - MANY} more" if len(names) > MANY else shown
