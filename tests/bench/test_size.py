"""Time and memory against size: what is measured of each mission, and the figure of it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from teamformer.bench.measurements.size import _measured, measure_size
from teamformer.bench.report.figures import draw_size


def test_each_size_is_run_and_judged_by_each_method(tmp_path: Path) -> None:
    ballast = bytearray(600_000_000)  # what this process has is not counted as the commands'
    rows = list(measure_size({6: 8, 9: 9}))
    assert len(ballast) > max(row.run_megabytes for row in rows) * 1e6
    assert [(row.method, row.count) for row in rows] == [
        ("plan", 6), ("crews", 6), ("plan", 9), ("crews", 9),
    ]  # fmt: skip
    for row in rows:
        assert 0 < row.makespan < 60
        assert 0 < row.check_seconds < row.run_seconds
        assert 20 < row.check_megabytes < row.run_megabytes < 1000
    path = draw_size(rows, tmp_path)
    assert path == tmp_path / "size.png"
    assert path.read_bytes().startswith(b"\x89PNG")


def test_a_command_that_fails_is_no_measurement() -> None:
    with pytest.raises(subprocess.CalledProcessError):
        _measured(["run", "no-such-file.yaml"])
