"""Anytime curves: what the planner's best plan is at any time, against sums done by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hand_rows import rows_of
from teamformer.bench.measurements.anytime import anytime_curves, best_at
from teamformer.bench.report.figures import draw_anytime
from teamformer.bench.rows import Row, row_of

SMALL = "4N4T-C4"


def planned(curves: list[list[list[float]]], bound: int = 10) -> list[Row]:
    return [
        replace(row, curve=curve, lower_bound=bound, time_limit=4.0)
        for row, curve in zip(rows_of(SMALL, "central", [20] * len(curves)), curves, strict=True)
    ]


def test_the_best_plan_so_far_holds_until_a_better_one() -> None:
    curve = [[0.5, 30], [1.0, 32], [2.0, 24]]  # a plan that is worse changes nothing
    assert best_at(curve, np.array([0.5, 0.9, 1.5, 2.0, 9.0])).tolist() == [30, 30, 30, 24, 24]


def test_a_curve_is_the_mean_ratio_from_the_last_first_plan_on() -> None:
    rows = planned([[[0.5, 30], [3.0, 20]], [[1.0, 40]]])
    seconds, ratios = anytime_curves(rows)[SMALL]
    assert (seconds[0], seconds[-1]) == (1.0, 4.0)
    assert ratios[0] == pytest.approx((3.0 + 4.0) / 2)
    assert ratios[-1] == pytest.approx((2.0 + 4.0) / 2)


def test_only_planners_have_curves(tmp_path: Path) -> None:
    others = rows_of(SMALL, "join-all", [20])
    assert list(draw_anytime(others, tmp_path)) == []
    [path] = draw_anytime([*others, *planned([[[0.1, 21]]])], tmp_path)
    assert path.name == "anytime.png"
    assert len(path.read_bytes()) > 10_000


def test_curves_survive_a_file() -> None:
    [row] = planned([[[0.125, 21], [0.25, 20]]])
    assert row_of(row.to_line()) == row
    assert row_of(row.to_line().replace("[[0.125, 21], [0.25, 20]]", '"fast"')) is None
