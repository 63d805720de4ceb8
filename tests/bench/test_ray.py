"""The same rows from a Ray cluster of two workers; skipped where Ray is not installed."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path

import pytest

from teamformer.bench.executors import run_here, run_on_ray
from teamformer.bench.rows import Row
from teamformer.bench.runner import Request, run_benchmark
from teamformer.bench.store import Store
from teamformer.bench.suites import Suite

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    ray = pytest.importorskip("ray")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore"),  # Ray's own
]


def rows_without_clocks(folder: Path, request: Request, engine) -> list[Row]:  # type: ignore[no-untyped-def]
    folder.mkdir()
    with Store(folder, request.about, print) as store:
        run_benchmark(request, store, engine, print)
        return [
            replace(row, decision_seconds=0, decision_cpu_seconds=0, total_seconds=0)
            for row in store.rows.values()
        ]


def test_a_cluster_of_two_gives_the_same_rows(tmp_path: Path) -> None:
    suite = Suite(
        "small",
        "for the cluster",
        settings=("4N4T-C4", "8N20T-C8"),
        methods=("heuristic", "join-all", "teamformer"),
    )
    request = Request(suite, trials=12, workers=2)
    here = rows_without_clocks(tmp_path / "here", request, run_here)
    there = rows_without_clocks(tmp_path / "there", request, run_on_ray)
    assert len(here) == 2 * 3 * 12
    assert here == there
    assert not ray.is_initialized()
