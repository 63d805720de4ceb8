"""How good a planner's plan is after so many seconds: anytime curves."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.bench.rows import Row

POINTS = 200
"""Times at which a curve is drawn."""


def anytime_curves(rows: Iterable[Row]) -> dict[str, tuple[Array, Array]]:
    """Return, for each setting, seconds and the mean ratio of the best plan to the lower bound.

    A curve begins when every world has a plan and ends at the time limit; both are (times,).
    """
    planned: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        if row.curve and row.lower_bound and row.time_limit:
            planned[row.setting].append(row)
    return {setting: _mean_curve(found) for setting, found in planned.items()}


def _mean_curve(rows: Sequence[Row]) -> tuple[Array, Array]:
    begin = max(row.curve[0][0] for row in rows if row.curve)
    end = max(begin, *(row.time_limit for row in rows if row.time_limit))
    times = np.linspace(begin, end, POINTS)
    ratios = [best_at(row.curve, times) / row.lower_bound for row in rows if row.curve]
    return times, np.mean(ratios, axis=0)


def best_at(curve: Sequence[Sequence[float]], times: Array) -> Array:
    """Return the makespan of the best plan at each time; `times` begin with the first plan."""
    seconds, makespans = np.array(curve).T
    latest = np.searchsorted(seconds, times, side="right") - 1
    return np.minimum.accumulate(makespans)[latest]
