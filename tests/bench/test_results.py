"""The document of results, written from the folder of a real small run."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from hand_rows import rows_of
from teamformer import __version__
from teamformer.bench.report.beside import beside_the_plan
from teamformer.bench.report.kept import kept_tables
from teamformer.bench.report.results import template
from teamformer.bench.runner import AUTHORS
from teamformer.bench.store import folders_beside
from teamformer.bench.suites import names_of_suites
from teamformer.methods.by_name import BARE
from teamformer.methods.listings import our_method_names
from typed import teamformer


def bench(*words: str) -> int:
    return teamformer("bench", *words)


def test_the_document_stands_on_the_rows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, document = tmp_path / "rows", tmp_path / "docs" / "results.md"
    words = ("paper", "--trials", "3", "--workers", "1", "--time-limit", "20", "--out", str(folder))
    planned = ("--settings", "4N4T-C4", "--methods", "central,heuristic")
    assert bench(*words, *planned) == 0
    others = ("--settings", "4N4T-C4,4N20+20T-C4-nn", "--methods", "join-all,teamformer-bare")
    assert bench(*words, *others, "--report", str(document)) == 0
    capsys.readouterr()
    text = document.read_text()
    assert "--settings 4N4T-C4,4N20+20T-C4-nn --methods join-all,teamformer-bare" in text
    assert "18 trials: 3 of each method" in text
    assert "holds: 0 of 3 (0.0% to 56.1%)" in text
    assert "$" not in text.replace("\n$ ", "")  # every blank is filled in
    for image in ("fig3", "fig9"):
        assert f"![{image}](images/results-{image}.png)" in text
        assert (document.parent / "images" / f"results-{image}.png").exists()
    room = next(line for line in text.splitlines() if line.startswith("| 4N4T-C4 |"))
    assert "3 of 3" in room  # all proven, long before time is up


def test_missions_stand_beside_the_plan() -> None:
    """With 10 and 20 steps `plan` takes 15 on average; what takes a third more says so."""
    rows = [*rows_of("real", "plan", [10, 20]), *rows_of("real", "crews", [15, 25])]
    rows += rows_of("real", "heuristic", [30, 30])
    rows += rows_of("real", "teamformer", [40, None])
    rows += [replace(row, cost=3.0 + row.world_seed) for row in rows_of("sparse", "plan", [4, 6])]
    head, _, *table = beside_the_plan(rows).splitlines()
    assert head == "| setting | worlds | `plan` | `crews` | `heuristic` | `teamformer` |"
    assert table == [
        "| real | 2 | 15.0 ± 5.0 | 20.0 ± 5.0 (+33%) | 30.0 ± 0.0 (+100%) "
        "| 40.0 (+300%), 1 failed |",
        "| sparse | 2 | 5.0 ± 1.0, cost 3.5 |  |  |  |",
    ]
    assert beside_the_plan([]) == ""


OLDER = """# Results

The version of Teamformer that ran them: 0.1.0 (code abc). The machine: any.

## Missions

Mean steps.

| setting | `plan` |
| --- | ---: |
| real | 15.0 |

## What to know

Nothing.
"""


def test_tables_without_rows_stay_and_say_which_version_made_them(tmp_path: Path) -> None:
    document = tmp_path / "results.md"
    assert kept_tables(document) == {}
    document.write_text(OLDER)
    kept = kept_tables(document)
    told = "Kept from an earlier report; these rows were made by version 0.1.0 (code abc).\n\n"
    assert kept == {"Missions": f"{told}| setting | `plan` |\n| --- | ---: |\n| real | 15.0 |\n"}
    again = OLDER.replace("abc", "def").replace("Mean steps.\n\n", f"Mean steps.\n\n{told}")
    document.write_text(again)
    assert kept_tables(document) == kept


def test_a_report_keeps_what_it_cannot_make_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    document, tables = tmp_path / "results.md", tmp_path / "results-tables.md"
    document.write_text(OLDER)
    tables.write_text(OLDER.replace("## Missions", "## missions"))
    (tmp_path / "images").mkdir()
    (tmp_path / "images" / "results-scale.png").write_bytes(b"drawn before")
    words = ("fig3", "--trials", "1", "--workers", "1", "--methods", "join-all")
    assert bench(*words, "--out", str(tmp_path / "rows"), "--report", str(document)) == 0
    capsys.readouterr()
    told = "Kept from an earlier report; these rows were made by version 0.1.0 (code abc).\n\n| set"
    assert told in document.read_text()
    assert (
        "## Large missions\n\nNot measured: `teamformer bench large` does." in document.read_text()
    )
    older = "Kept from an earlier report:\n\n![scale](images/results-scale.png)"
    assert older in document.read_text()
    assert f"## missions\n\n{told}" in tables.read_text()


DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize(
    ("document", "name"), [("results.md", "results"), ("results-tables.md", "tables")]
)
def test_the_documents_are_as_the_command_writes_them(document: str, name: str) -> None:
    """All but what was measured: nobody has changed their text by hand."""
    parts = re.split(r"\$\w+", template(name).template)
    pattern = "(.+?)".join(re.escape(part) for part in parts)
    assert re.fullmatch(pattern, (DOCS / document).read_text(), re.DOTALL)


def test_the_documents_name_suites_and_methods_of_today() -> None:
    text = (DOCS / "results-tables.md").read_text()
    assert set(re.findall(r"^## (.*)$", text, re.MULTILINE)) <= set(names_of_suites())
    methods = set(re.findall(r"^\| \d+N[^|]+ \| ([\w-]+) \|", text, re.MULTILINE))
    assert len(methods) > 10
    assert {name.removesuffix(BARE) for name in methods} - {AUTHORS} <= set(our_method_names())


def test_a_document_says_which_version_ran_the_trials(tmp_path: Path) -> None:
    document, folder = tmp_path / "results.md", tmp_path / "rows"
    words = ("fig3", "--trials", "2", "--workers", "1", "--methods", "join-all")
    assert bench(*words, "--out", str(folder), "--report", str(document)) == 0
    ran = "The version of Teamformer that ran them: {}"
    assert ran.format(__version__) in document.read_text()
    rows = folder / "rows.jsonl"
    old = rows.read_text().replace(f', "version": "{__version__}"', "", 1)
    rows.write_text(old)
    assert bench(*words, "--out", str(folder), "--report", str(document)) == 0
    assert ran.format(f"before 0.1.0 and {__version__}") in document.read_text()


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
    assert "(results-tables.md)" in text
    tables = (tmp_path / "results-tables.md").read_text()
    assert tables.index("## fig3") < tables.index("## fig6")
    assert "(results.md)" in tables
