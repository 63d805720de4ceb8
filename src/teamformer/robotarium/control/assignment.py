"""Who takes which slot: the assignment of least total cost."""

from __future__ import annotations

from scipy.optimize import linear_sum_assignment

from teamformer.base.array_types import Array


def match(places: Array, slots: Array) -> Array:
    """Return for each place (n, 2) the slot (n, 2) it takes.

    The squares of the ways add up to the least, so that nobody has to pass far through the others.
    """
    ways = places[:, None] - slots[None]  # (n, n, 2)
    _, taken = linear_sum_assignment((ways**2).sum(axis=2))
    chosen: Array = slots[taken]
    return chosen
