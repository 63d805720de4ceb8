"""The folder of rows: nothing lost, nothing doubled, nobody else's."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from teamformer.base.errors import TeamformerError
from teamformer.bench.jobs import Job, known_row
from teamformer.bench.rows import Row, row_of, with_bars
from teamformer.bench.store import BenchmarkDescription, Store
from teamformer.files.drawn.named_settings import world_of

ABOUT = BenchmarkDescription("fig3", 0, {"forming_steps": 1})


def make_row(policy: str = "join-all", seed: int = 0, makespan: int | None = 20) -> Row:
    job = Job("fig3", "4N4T-C4", policy, (seed,), 10.0, "abc")
    return known_row(job, seed, world_of("4N4T-C4", seed), makespan)


def by_seed(row: Row) -> tuple[str, int]:
    return row.method, row.world_seed


def reopened(folder: Path, say: Callable[[str], None] = print) -> dict[tuple[str, str, int], Row]:
    with Store(folder, ABOUT, say) as store:
        return dict(store.rows)


def test_rows_come_back_as_they_were(tmp_path: Path) -> None:
    rows = [make_row(seed=seed) for seed in range(3)]
    with Store(tmp_path, ABOUT, print) as store:
        store.add(rows)
    assert list(reopened(tmp_path).values()) == rows


def test_no_trial_is_kept_twice(tmp_path: Path) -> None:
    with Store(tmp_path, ABOUT, print) as store:
        store.add([make_row(makespan=20), make_row(makespan=99)])
    assert (tmp_path / "rows.jsonl").read_text().count("\n") == 1
    assert [row.makespan for row in reopened(tmp_path).values()] == [20]


def test_a_cut_off_line_is_set_aside_and_said(tmp_path: Path) -> None:
    with Store(tmp_path, ABOUT, print) as store:
        store.add([make_row(seed=seed) for seed in range(3)])
    path = tmp_path / "rows.jsonl"
    text = path.read_text()
    path.write_text(text[:-40])  # as a crash in the middle of writing leaves it
    said: list[str] = []
    assert [key[2] for key in reopened(tmp_path, said.append)] == [0, 1]
    assert "line 3 cannot be read" in said[0]
    assert "broken-rows.txt" in said[0]
    cut_off = text.splitlines()[2][:-39]
    assert (tmp_path / "broken-rows.txt").read_text() == f"rows.jsonl:3: {cut_off}\n"
    assert path.read_text() == "".join(text.splitlines(keepends=True)[:2])
    said.clear()
    reopened(tmp_path, said.append)
    assert said == []


def test_rows_added_after_a_cut_off_line_are_whole(tmp_path: Path) -> None:
    with Store(tmp_path, ABOUT, print) as store:
        store.add([make_row(seed=0)])
    path = tmp_path / "rows.jsonl"
    path.write_text(path.read_text().rstrip("\n"))  # only the end of the line is missing
    with Store(tmp_path, ABOUT, print) as store:
        store.add([make_row(seed=1)])
    assert [row_of(line) is not None for line in path.read_text().splitlines()] == [True, True]


@pytest.mark.parametrize(
    "line",
    [
        "{}",
        "null",
        "[1]",
        "7",
        '{"suite": "fig3"}',
        "\\ud800",
        make_row().to_line().replace('"world_seed": 0', '"world_seed": "0"'),
        make_row().to_line().replace('"completed": true', '"completed": 1'),
        make_row().to_line().replace('"makespan": 20', '"makespan": true'),
        make_row().to_line().replace('"code"', '"cod"'),
    ],
)
def test_what_is_no_row(line: str) -> None:
    assert row_of(line) is None


@pytest.mark.parametrize(
    ("other", "told"),
    [
        (replace(ABOUT, suite="fig6"), "suite 'fig3', not 'fig6'"),
        (replace(ABOUT, first_seed=7), "first_seed 0, not 7"),
        (replace(ABOUT, rules={}), "rules {'forming_steps': 1}, not {}"),
    ],
)
def test_another_benchmark_s_folder_is_refused(
    tmp_path: Path, other: BenchmarkDescription, told: str
) -> None:
    reopened(tmp_path)
    with pytest.raises(TeamformerError, match="holds rows of another benchmark") as refused:
        Store(tmp_path, other, print).__enter__()
    assert told in str(refused.value)
    reopened(tmp_path)  # and nothing is locked or changed


def test_a_folder_that_says_nothing_is_refused(tmp_path: Path) -> None:
    (tmp_path / "rows.jsonl").write_text("")
    with pytest.raises(TeamformerError, match="holds rows, but no bench"):
        reopened(tmp_path)
    (tmp_path / "bench.json").write_text("[")
    with pytest.raises(TeamformerError, match="cannot be understood"):
        reopened(tmp_path)


def test_two_at_once_are_refused(tmp_path: Path) -> None:
    with (
        Store(tmp_path, ABOUT, print),
        pytest.raises(TeamformerError, match="another bench is at work here"),
    ):
        Store(tmp_path, ABOUT, print).__enter__()
    reopened(tmp_path)


def test_the_bars_of_a_world_are_shared_by_its_trials(tmp_path: Path) -> None:
    rows = [
        replace(make_row("heuristic", 0, 30), lower_bound=12, list_schedule=17),
        make_row("join-all", 0, 20),
        replace(make_row("central", 0, 18), relaxed=15, relaxed_bound=14),
        make_row("join-all", 1, None),
    ]
    with Store(tmp_path, ABOUT, print) as store:
        store.add(reversed(rows))
        store.finish(by_seed)
    told = [
        (row.method, row.world_seed, row.best_known, row.lower_bound, row.list_schedule)
        for row in reopened(tmp_path).values()
    ]
    assert told == [
        ("central", 0, 18, 14, 17),
        ("heuristic", 0, 18, 14, 17),
        ("join-all", 0, 18, 14, 17),
        ("join-all", 1, None, None, None),
    ]


def test_bars_do_not_depend_on_the_order_of_rows() -> None:
    rows = [make_row("a", 0, 9), make_row("b", 0, 7), make_row("a", 1, 5)]
    assert [row.best_known for row in with_bars(rows)] == [7, 7, 5]
    assert [row.best_known for row in with_bars(rows[::-1])] == [5, 7, 7]


def test_the_folder_says_what_it_is(tmp_path: Path) -> None:
    reopened(tmp_path)
    assert json.loads((tmp_path / "bench.json").read_text()) == {
        "suite": "fig3",
        "first_seed": 0,
        "rules": {"forming_steps": 1},
        "worlds": "",
        "format": 2,
    }
