"""`teamformer bench` as a person meets it, killed in the middle too."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from typed import teamformer

COMMAND = [sys.executable, "-m", "teamformer.cli", "bench"]


def bench(*words: str) -> int:
    return teamformer("bench", *words)


def small(folder: Path, *words: str) -> tuple[str, ...]:
    chosen = ("--methods", "heuristic,join-all", "--out", str(folder), "--workers", "1")
    return ("fig3", "--trials", "4", *chosen, *words)


def test_it_leaves_rows_a_table_and_a_figure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bench(*small(tmp_path)) == 0
    printed = capsys.readouterr()
    assert "4N4T-C4" in printed.out
    assert "join-all" in printed.out
    names = {"rows.jsonl", "bench.json", "report.md", "summary.csv", "fig3.png", ".lock"}
    assert {path.name for path in tmp_path.iterdir()} == names
    assert (tmp_path / "rows.jsonl").read_text().count("\n") == 8
    assert (tmp_path / "summary.csv").read_text().count("\n") == 3
    assert "| 4N4T-C4 | heuristic | 4 |" in (tmp_path / "report.md").read_text()
    assert (tmp_path / "fig3.png").read_bytes().startswith(b"\x89PNG")


def test_json_is_a_line_for_each_trial(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert bench(*small(tmp_path, "--json")) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines == (tmp_path / "rows.jsonl").read_text().splitlines()
    rows = [json.loads(line) for line in lines]
    assert [(row["method"], row["world_seed"]) for row in rows] == [
        (policy, seed) for policy in ("heuristic", "join-all") for seed in range(4)
    ]
    asked = (
        "mission method seed completed makespan steps tasks_done tasks robots capabilities joins "
        "splits illegal_decisions decision_seconds total_seconds best_known lower_bound suite "
        "setting world_seed"
    )
    assert all(set(asked.split()) <= set(row) for row in rows)


def test_a_row_tells_the_command_that_runs_it_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bench(*small(tmp_path, "--json")) == 0
    row = json.loads(capsys.readouterr().out.splitlines()[-1])
    words = row["rerun"].split()
    assert words[:2] == ["teamformer", "bench"]
    assert bench(*words[2:]) == 0
    again = json.loads(capsys.readouterr().out)
    clocks = {"decision_seconds", "decision_cpu_seconds", "total_seconds"}
    bars = {"best_known"}  # alone, it knows nobody better
    assert {key: row[key] for key in row if key not in clocks | bars} == {
        key: again[key] for key in again if key not in clocks | bars
    }


def test_killed_in_the_middle_it_goes_on_where_it_was(tmp_path: Path) -> None:
    words = ["fig4b", "--trials", "15", "--methods", "heuristic,join-all", "--workers", "2"]
    command = [*COMMAND, *words, "--out", str(tmp_path)]
    rows = tmp_path / "rows.jsonl"
    running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120
    while not (rows.exists() and rows.stat().st_size > 0):
        assert time.monotonic() < deadline
        assert running.poll() is None
        time.sleep(0.01)
    running.send_signal(signal.SIGKILL)
    running.wait()
    there = rows.read_text().count("\n")
    assert 0 < there < 30
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert f"{there} of 30 trials are there already" in done.stderr
    keys = [
        (row["setting"], row["method"], row["world_seed"])
        for row in map(json.loads, rows.read_text().splitlines())
    ]
    policies = ("heuristic", "join-all")
    assert keys == [("20N100T-C4", policy, seed) for policy in policies for seed in range(15)]


def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    words = ["fig3", "--trials", "40000", "--methods", "heuristic", "--workers", "2"]
    command = [*COMMAND, *words, "--out", str(tmp_path)]
    running = subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    rows = tmp_path / "rows.jsonl"
    deadline = time.monotonic() + 120
    while not (rows.exists() and rows.stat().st_size > 0):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    running.send_signal(signal.SIGKILL)
    running.wait()
    _wait_for_the_end(running.pid, deadline)


def _wait_for_the_end(group: int, deadline: float) -> None:
    """Wait until no process of a group is left."""
    with contextlib.suppress(ProcessLookupError):
        while time.monotonic() < deadline:
            os.killpg(group, 0)
            time.sleep(0.05)
        pytest.fail("some processes are still alive")


DIES = """
import os
from teamformer.methods.scripted.joining import JoinAll

class Dies(JoinAll):
    def decide(self, view):
        os._exit(9)
"""


def test_a_worker_that_dies_is_told_and_rows_are_kept(tmp_path: Path) -> None:
    (tmp_path / "dying.py").write_text(DIES)
    words = ["fig3", "--trials", "4", "--workers", "2", "--out", "rows"]
    asked = [*COMMAND, *words, "--methods", "heuristic,dying:Dies"]
    done = subprocess.run(asked, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    assert "error: a worker process died" in done.stderr
    assert "Traceback" not in done.stderr
    again = [*COMMAND, *words, "--methods", "heuristic,join-all"]
    subprocess.run(again, capture_output=True, cwd=tmp_path, check=True)
    rows = (tmp_path / "rows" / "rows.jsonl").read_text().splitlines()
    assert len(rows) == 8


@pytest.mark.parametrize("pause", [0.001, pytest.param(0.03, marks=pytest.mark.slow)])
def test_ctrl_c_ends_it_at_once_and_keeps_the_rows(pause: float, tmp_path: Path) -> None:
    words = ["fig3", "--trials", "40000", "--methods", "heuristic", "--workers", "2"]
    command = [*COMMAND, *words, "--out", str(tmp_path)]
    running = subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    rows = tmp_path / "rows.jsonl"
    deadline = time.monotonic() + 120
    while not (rows.exists() and rows.stat().st_size > 0):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    while running.poll() is None:  # somebody is impatient, to the very end
        os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to all of them
        time.sleep(pause)
        assert time.monotonic() < deadline
    _, told = running.communicate(timeout=60)
    assert running.returncode == 1
    assert f"interrupted; the rows so far are in {tmp_path}" in told.splitlines()[-1]
    assert "Traceback" not in told
    _wait_for_the_end(running.pid, deadline)
    assert all(json.loads(line) for line in rows.read_text().splitlines())


def test_the_worlds_of_a_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "4N4T-C4.jsonl"
    world = {
        "setting": "4N4T-C4",
        "seed": 6,
        "rows": 10,
        "cols": 10,
        "caps": 4,
        "robots": [[0, 0, 0], [1, 0, 1], [2, 0, 2], [3, 0, 3]],
        "tasks": [[9, 9, [0, 1]], [5, 5, [2]], [0, 9, [3]], [2, 2, [0, 1, 2, 3]]],
        "authors_heuristic": 33,
    }
    stuck = world | {"seed": 8, "authors_heuristic": None}
    path.write_text(f"{json.dumps(world)}\n{json.dumps(stuck)}\n")
    words = (str(path), "--methods", "join-all", "--workers", "1")
    assert bench("authors", *words, "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    told = [(row["method"], row["world_seed"], row["completed"]) for row in rows]
    assert told[:2] == [("authors-heuristic", 6, True), ("authors-heuristic", 8, False)]
    assert told[2:] == [("join-all", 6, True), ("join-all", 8, True)]
    assert rows[0]["makespan"] == 33
    wrong = tmp_path / "wrong.jsonl"
    wrong.write_text("{}\n")
    assert bench("authors", str(wrong)) == 2
    assert "wrong.jsonl:1: this is no world" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("fig55",), "did you mean 'fig5b' or 'fig5a'"),
        (("fig3", "--trials", "0"), "--trials"),
        (("fig3", "--methods", "joinall"), "did you mean 'join-all'?"),
        (("fig3", "--settings", "4N20T-C4"), "suite 'fig3' has no setting '4N20T-C4'"),
        (("fig5a", "--methods", "gnn-c4"), "no method of those asked for"),
        (("authors",), "teamformer bench authors FILE"),
        (("none.yaml",), "there is no such file"),
        (("fig3", "--out", "/proc/none"), "cannot be written"),
    ],
)
def test_misuse_is_told(
    words: tuple[str, ...], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bench(*words) == 2
    printed = capsys.readouterr()
    assert told in printed.err
    assert printed.out == ""


def test_a_world_of_a_trial_can_be_run_by_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bench(*small(tmp_path / "rows", "--json")) == 0
    row = json.loads(capsys.readouterr().out.splitlines()[6])
    path = str(tmp_path / "world.yaml")
    words = ("--setting", row["setting"], "--seed", str(row["world_seed"]), "-o", path)
    assert teamformer("generate", *words) == 0
    assert teamformer("run", path, "--method", row["method"], "--json") == 0
    assert json.loads(capsys.readouterr().out)["makespan"] == row["makespan"]
    assert teamformer("generate", *words[:-1], f"{path}.yaml", "--robots", "9") == 2
    assert "--setting says it all" in capsys.readouterr().err
    assert teamformer("generate", "--setting", "4N", "-o", f"{path}.yaml") == 2
    assert "'4N' is no setting" in capsys.readouterr().err


def test_another_suite_s_folder_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert bench(*small(tmp_path)) == 0
    before = (tmp_path / "rows.jsonl").read_bytes()
    assert bench("fig4a", "--trials", "1", "--methods", "join-all", "--out", str(tmp_path)) == 2
    assert "holds rows of another benchmark: suite 'fig3', not 'fig4a'" in capsys.readouterr().err
    assert (tmp_path / "rows.jsonl").read_bytes() == before
