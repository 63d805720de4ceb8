"""The few statistics that the tables need: means, intervals, slopes, growth exponents."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Mean:
    """A mean over `count` values with their standard deviation; NaN where there are too few."""

    value: float
    deviation: float
    count: int

    @property
    def error(self) -> float:
        """Return the standard error of the mean."""
        return self.deviation / math.sqrt(self.count) if self.count else math.nan

    @property
    def half_width(self) -> float:
        """Return what the 95% interval reaches to either side (Student's t)."""
        if self.count < 2:
            return math.nan
        return t_quantile(0.5 + CONFIDENCE / 2, self.count - 1) * self.error


@dataclass(frozen=True)
class Slope:
    """By how much a value rises for each unit more of another, over `count` points.

    `half_width` is what the 95% interval reaches to either side; NaN where there are too few.
    """

    value: float
    half_width: float
    count: int

    @property
    def falls(self) -> bool:
        """Say whether all of the interval is below zero."""
        return self.value + self.half_width < 0

    @property
    def rises(self) -> bool:
        """Say whether all of the interval is above zero."""
        return self.value - self.half_width > 0


def slope_of(points: Sequence[tuple[float, float]]) -> Slope:
    """Return the slope of the least-squares line through points (x, y), with Student's interval."""
    count = len(points)
    if len({x for x, _ in points}) < 2:
        return Slope(math.nan, math.nan, count)
    x, y = np.array(points, dtype=np.float64).T
    x, y = x - x.mean(), y - y.mean()
    spread = float((x * x).sum())
    value = float((x * y).sum()) / spread
    freedom = count - 2
    if freedom < 1:
        return Slope(value, math.nan, count)
    rest = y - value * x
    error = math.sqrt(float((rest * rest).sum()) / freedom / spread)
    return Slope(value, t_quantile(0.5 + CONFIDENCE / 2, freedom) * error, count)


def mean_of(values: Sequence[float]) -> Mean:
    """Return the mean and the sample standard deviation."""
    count = len(values)
    if count == 0:
        return Mean(math.nan, math.nan, 0)
    deviation = float(np.std(values, ddof=1)) if count > 1 else math.nan
    return Mean(float(np.mean(values)), deviation, count)


def wilson(failures: int, trials: int) -> tuple[float, float]:
    """Return the 95% interval of a failure rate (Wilson 1927); all of it if nothing was tried."""
    if trials == 0:
        return 0.0, 1.0
    z = NormalDist().inv_cdf(0.5 + CONFIDENCE / 2)
    rate, weight = failures / trials, z * z / trials
    middle = (rate + weight / 2) / (1 + weight)
    reach = z * math.sqrt(rate * (1 - rate) / trials + weight / (4 * trials)) / (1 + weight)
    low = 0.0 if failures == 0 else middle - reach
    high = 1.0 if failures == trials else middle + reach
    return low, high


def growth_exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Return b of the least-squares fit value = a * size^b, on logarithms."""
    if len(set(sizes)) < 2 or min(values) <= 0:
        return math.nan
    x, y = np.log(sizes), np.log(values)
    x = x - x.mean()
    return float((x * y).sum() / (x * x).sum())


def t_quantile(part: float, freedom: int) -> float:
    """Return Student's t below which `part` of the distribution lies; 0.5 < part < 1."""
    low, high = 0.0, 1.0
    while _t_within(high, freedom) < 2 * part - 1:
        high *= 2
    for _ in range(60):
        middle = (low + high) / 2
        if _t_within(middle, freedom) < 2 * part - 1:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def _t_within(t: float, freedom: int) -> float:
    """Return the probability of (-t, t) (Abramowitz and Stegun 26.7.3 and 26.7.4)."""
    angle = math.atan(t / math.sqrt(freedom))
    square = math.cos(angle) ** 2
    is_odd = freedom % 2 == 1
    term = math.cos(angle) if is_odd else 1.0
    total = 0.0
    for power in range(1 + is_odd, freedom, 2):
        total += term
        term *= square * power / (power + 1)
    total *= math.sin(angle)
    return 2 / math.pi * (angle + total) if is_odd else total
