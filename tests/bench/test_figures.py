"""Figures: every part of a suite that has trials is drawn, with bars where they belong."""

from __future__ import annotations

from pathlib import Path

from hand_rows import rows_of
from teamformer.bench.report.figures import colour_of, draw_suite
from teamformer.bench.report.files import bare_if_run
from teamformer.bench.rows import Row
from teamformer.bench.suites import load_suite
from teamformer.bench.summary import summarise


def draw(suite: str, rows: list[Row], folder: Path) -> list[str]:
    return [path.name for path in draw_suite(load_suite(suite), summarise(rows), folder)]


def test_only_parts_with_trials_are_drawn(tmp_path: Path) -> None:
    rows = [
        *rows_of("4N20T-C4", "heuristic", [80, 90]),
        *rows_of("8N20T-C8", "gnn-c8-ppo", [70, None]),
        *rows_of("8N20T-C8", "deepset-c8-ppo", [None, None]),  # no bar, and no complaint
    ]
    assert draw("paper", rows, tmp_path) == ["fig4a.png", "fig5a.png"]
    for name in ("fig4a.png", "fig5a.png"):
        assert len((tmp_path / name).read_bytes()) > 10_000


def test_figures_have_networks_without_their_deadlock_guard_where_these_were_run() -> None:
    rows = [
        row
        for setting, method in (
            ("4N20T-C4", "gnn-c4-ppo"),
            ("4N20T-C4", "gnn-c4-ppo-bare"),
            ("4N20T-C4", "heuristic"),
            ("8N20T-C8", "gnn-c8-ppo"),
        )
        for row in rows_of(setting, method, [10])
    ]
    assert [(row.setting, row.method) for row in bare_if_run(rows)] == [
        ("4N20T-C4", "gnn-c4-ppo-bare"),
        ("4N20T-C4", "heuristic"),
        ("8N20T-C8", "gnn-c8-ppo"),
    ]
    assert colour_of("teamformer-bare") == colour_of("teamformer")
    assert colour_of("gnn-c4-ppo-bare") == colour_of("gnn-c8-ppo")


def test_curves_have_a_panel_for_each_axis(tmp_path: Path) -> None:
    settings = load_suite("scale").settings
    rows = [row for setting in settings for row in rows_of(setting, "join-all", [50, 60])]
    assert draw("scale", rows, tmp_path) == ["scale.png"]
    assert len((tmp_path / "scale.png").read_bytes()) > 20_000


def test_tables_are_not_drawn(tmp_path: Path) -> None:
    assert draw("table1", rows_of("4N20T-C4", "heuristic", [80]), tmp_path) == []


def test_a_family_has_one_colour() -> None:
    assert colour_of("gnn-c4") == colour_of("gnn-c8") == colour_of("gnn-c8-ppo")
    assert colour_of("gnn-c4") != colour_of("join-all")
    assert colour_of("crews") != colour_of("join-all")
    assert colour_of("mine:Policy") == colour_of("mine:Policy")
