"""The document of results, written from the folder of a real small run."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from teamformer import cli
from teamformer.bench.store import folders_beside


def bench(*words: str) -> int:
    argv, sys.argv = sys.argv, ["teamformer", "bench", *words]
    try:
        cli.main()
    except SystemExit as stop:
        return stop.code if isinstance(stop.code, int) else 0
    finally:
        sys.argv = argv
    return 0


def test_the_document_stands_on_the_rows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, document = tmp_path / "rows", tmp_path / "docs" / "results.md"
    words = ("paper", "--trials", "3", "--workers", "1", "--time-limit", "20", "--out", str(folder))
    planned = ("--settings", "4N4T-C4", "--methods", "central,heuristic")
    assert bench(*words, *planned) == 0
    others = ("--settings", "4N4T-C4,4N20+20T-C4-nn", "--methods", "join-all,teamformer")
    assert bench(*words, *others, "--report", str(document)) == 0
    capsys.readouterr()
    text = document.read_text()
    assert "--settings 4N4T-C4,4N20+20T-C4-nn --methods join-all,teamformer" in text
    assert "It holds 18 trials: 3 of each method" in text
    assert "holds: 0 of 3 (0.0% to 56.1%)" in text
    assert "$" not in text.replace("\n$ ", "")  # every blank is filled in
    for image in ("fig3", "fig9"):
        assert f"![{image}](images/results-{image}.png)" in text
        assert (document.parent / "images" / f"results-{image}.png").exists()
    room = next(line for line in text.splitlines() if line.startswith("| 4N4T-C4 |"))
    assert "3 of 3" in room  # all proven, long before time is up


def test_a_report_needs_a_folder_and_whole_ones_beside(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document = str(tmp_path / "results.md")
    assert bench("fig3", "--report", document) == 2
    assert "add --out FOLDER" in capsys.readouterr().err
    (tmp_path / "torn").mkdir()
    (tmp_path / "torn" / "bench.json").write_text("{")
    assert bench("fig3", "--out", str(tmp_path / "rows"), "--report", document) == 2
    assert f"{tmp_path / 'torn' / 'bench.json'}: cannot be understood" in capsys.readouterr().err


def test_rows_of_the_benchmarks_beside_stand_one_after_the_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An older one of the same suite is not among them."""
    chosen = ("--trials", "1", "--methods", "join-all", "--workers", "1")
    for suite, name in (("fig6", "a"), ("fig3", "older"), ("fig3", "newer")):
        report = ("--report", str(tmp_path / "results.md")) if name == "newer" else ()
        assert bench(suite, *chosen, "--out", str(tmp_path / name), *report) == 0
    assert [folder.name for folder in folders_beside(tmp_path / "newer")] == ["a"]
    text = (tmp_path / "results.md").read_text()
    assert text.index("### fig3") < text.index("### fig6")
