"""How much results of searches differ by luck alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from teamformer.base.array_types import Floats

RESAMPLES = 20_000
"""Differences of medians that noise is worked out from."""

COVERED = 0.95
"""With this probability no gain of any change is above the noise if none changes anything."""


class Noise:
    """What differences between medians of repeated searches vary by, in all that was searched.

    Every search's deviation from the median of its mission is pooled: so three searches that happen
    to agree do not pass for sure.
    """

    def __init__(self, results: Iterable[Sequence[float]]) -> None:
        repeated = [np.asarray(values) for values in results if len(values) > 1]
        deviations = [values - np.median(values) for values in repeated]
        self._deviations: Floats = np.concatenate([[0.0], *deviations])
        if repeated:
            self._deviations = self._deviations[1:]

    def of_gain(self, searches: int, others: int, changes: int) -> float:
        """Return what gains, differences of medians of so many searches each, are within.

        It is what the largest gain of so many `changes` hardly ever exceeds if none of them
        changes anything: of many draws from pure luck the best one looks like advice.
        """
        rng = np.random.default_rng(0)
        one, other = (
            np.median(rng.choice(self._deviations, (RESAMPLES, count)), axis=1)
            for count in (searches, others)
        )
        return float(np.quantile(other - one, COVERED ** (1 / max(1, changes))))
