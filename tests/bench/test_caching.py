"""Keeping keys and values changes no decision and saves most of the time."""

from __future__ import annotations

from teamformer.bench.measurements.caching import Caching, measure_caching


def test_decisions_are_the_same_and_sooner_made() -> None:
    found = measure_caching(trials=1)
    assert found.are_same
    assert found.views > 50
    assert found.speedup > 2  # 5 where it was measured in peace


def test_the_speedup_is_how_many_times_longer_it_takes_without() -> None:
    assert Caching(cached=0.5, uncached=4.0, views=1, are_same=True).speedup == 8.0
