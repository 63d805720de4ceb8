"""Small choices from what has been drawn before: far faster than a new strategy for each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from hypothesis import strategies as st

Item = TypeVar("Item")

NUMBERS = st.integers(0, 119)


def pick(draw: st.DrawFn, items: Sequence[Item]) -> Item:
    """Return one of some items, the first of them in the simplest case."""
    return items[draw(NUMBERS) % len(items)]


def now_and_then(draw: st.DrawFn, one_in: int = 4) -> bool:
    """Say whether something is to be so that mostly is not."""
    return draw(NUMBERS) % one_in == one_in - 1


def are_more(draw: st.DrawFn, before: Sequence[object], most: int) -> bool:
    """Say whether a list goes on: it has one entry or more, in the simplest case one."""
    return not before or (len(before) < most and draw(NUMBERS) % 4 != 0)


def some(draw: st.DrawFn, items: Sequence[Item], most: int) -> list[Item]:
    """Return one or more different items, in their order."""
    count, first = 1 + draw(NUMBERS) % min(most, len(items)), draw(NUMBERS)
    step = max(1, len(items) // count)
    return [items[n] for n in sorted({(first + n * step) % len(items) for n in range(count)})]
