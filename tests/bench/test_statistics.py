"""Statistics against tables and hand arithmetic."""

from __future__ import annotations

import math

import pytest

from teamformer.bench.statistics import growth_exponent, mean_of, slope_of, t_quantile, wilson


@pytest.mark.parametrize(
    ("freedom", "printed"),
    [(1, 12.706), (2, 4.303), (3, 3.182), (9, 2.262), (10, 2.228), (49, 2.010), (999, 1.962)],
)
def test_t_is_what_tables_print(freedom: int, printed: float) -> None:
    assert t_quantile(0.975, freedom) == pytest.approx(printed, abs=5e-4)


def test_a_mean_with_its_interval() -> None:
    mean = mean_of([2, 4, 4, 6])  # deviations -2 0 0 2: variance 8/3
    assert mean.value == 4.0
    assert mean.deviation == pytest.approx(math.sqrt(8 / 3))
    assert mean.error == pytest.approx(math.sqrt(2 / 3))
    assert mean.half_width == pytest.approx(3.182 * math.sqrt(2 / 3), abs=1e-3)


def test_a_slope_with_its_interval() -> None:
    """Around x = 2 and y = 3: x -1 -1 1 1, y -1 -2 2 1, so 6 / 4; left over are 0.5 each, ±."""
    slope = slope_of([(1, 2), (1, 1), (3, 5), (3, 4)])
    assert slope.value == pytest.approx(1.5)
    assert slope.half_width == pytest.approx(4.303 * math.sqrt(1 / 2 / 4), abs=1e-3)  # 1.52
    assert not slope.rises
    assert not slope.falls


def test_a_slope_rises_or_falls_if_its_interval_leaves_zero_out() -> None:
    """With the same four points twice: six degrees of freedom, t = 2.447, ±0.61."""
    points = [(1, 2), (1, 1), (3, 5), (3, 4)] * 2
    assert slope_of(points).half_width == pytest.approx(2.447 * math.sqrt(2 / 6 / 8), abs=1e-3)
    assert slope_of(points).rises
    assert slope_of([(x, -y) for x, y in points]).falls
    flat = slope_of([(1, 0), (2, 0), (3, 0)])
    assert (flat.value, flat.half_width, flat.rises, flat.falls) == (0.0, 0.0, False, False)


def test_too_few_points_have_no_slope() -> None:
    assert math.isnan(slope_of([(1, 2), (1, 3)]).value)
    assert math.isnan(slope_of([(1, 2), (2, 3)]).half_width)
    assert not slope_of([(1, 2), (2, 3)]).rises


def test_too_few_values_have_no_spread() -> None:
    assert math.isnan(mean_of([]).value)
    assert mean_of([5]).value == 5.0
    assert math.isnan(mean_of([5]).half_width)


def test_wilson_by_hand() -> None:
    z = 1.959964
    low, high = wilson(0, 50)
    assert low == 0.0
    assert high == pytest.approx(z * z / (50 + z * z))  # 7.1%: what 0 of 50 leaves open
    low, high = wilson(5, 10)  # symmetric around a half
    assert low + high == pytest.approx(1.0)
    assert high - 0.5 == pytest.approx(z / 2 / math.sqrt(10 + z * z))
    assert wilson(10, 10)[1] == 1.0
    assert wilson(0, 0) == (0.0, 1.0)


def test_wilson_of_one_in_fifty() -> None:
    low, high = wilson(1, 50)  # the values that R's prop.test(1, 50, correct=FALSE) prints
    assert low == pytest.approx(0.003539, abs=1e-5)
    assert high == pytest.approx(0.104954, abs=1e-5)


def test_growth_exponents() -> None:
    sizes = [4, 8, 16, 32]
    assert growth_exponent(sizes, [3 * n**1.5 for n in sizes]) == pytest.approx(1.5)
    assert growth_exponent(sizes, [7, 7, 7, 7]) == pytest.approx(0.0)
    assert math.isnan(growth_exponent([4, 4], [1, 2]))
    assert math.isnan(growth_exponent([4, 8], [0, 2]))
