"""Who takes which slot: the assignment of least total cost."""

from __future__ import annotations

import numpy as np

from teamformer.jit import entry
from teamformer.sim.arrays import Array


@entry
def assign(cost):  # type: ignore[no-untyped-def]
    """Return the column of each row that adds up to the least cost; `cost` is (n, n).

    The Hungarian method with potentials and shortest augmenting paths (Jonker and Volgenant,
    "A shortest augmenting path algorithm", Computing 1987), n^3 steps.
    """
    n = len(cost)
    row_price, column_price = np.zeros(n + 1), np.zeros(n + 1)
    row_of = np.full(n + 1, -1)  # of each column; the last column starts every path
    came_from = np.zeros(n + 1, dtype=np.int64)
    for row in range(n):
        row_of[n] = row
        column = n
        least = np.full(n + 1, np.inf)
        is_done = np.zeros(n + 1, dtype=np.bool_)
        while row_of[column] != -1:
            is_done[column] = True
            at, step, following = row_of[column], np.inf, -1
            for other in range(n):
                if not is_done[other]:
                    reduced = cost[at, other] - row_price[at] - column_price[other]
                    if reduced < least[other]:
                        least[other], came_from[other] = reduced, column
                    if least[other] < step:
                        step, following = least[other], other
            for other in range(n + 1):
                if is_done[other]:
                    row_price[row_of[other]] += step
                    column_price[other] -= step
                else:
                    least[other] -= step
            column = following
        while column != n:
            row_of[column] = row_of[came_from[column]]
            column = came_from[column]
    columns = np.zeros(n, dtype=np.int64)
    for column in range(n):
        columns[row_of[column]] = column
    return columns


def match(places: Array, slots: Array) -> Array:
    """Return for each place (n, 2) the slot (n, 2) it takes.

    The squares of the ways add up to the least, so that nobody has to pass far through the others.
    """
    ways = places[:, None] - slots[None]  # (n, n, 2)
    taken: Array = slots[assign((ways**2).sum(axis=2))]
    return taken
