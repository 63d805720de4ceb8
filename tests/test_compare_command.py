"""`teamformer compare` where some methods fail: the others are shown all the same."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from test_cli import FOUR, teamformer

OWN = """
class Failing:
    needs_everything = False

    def begin(self, everything, rng):
        pass

    def decide(self, view):
        raise KeyError("luck")
"""

AFTER_WITH_DELAYS = """
teamformer: 1
world: {grid: [3, 1]}
capabilities: [a]
robots:
  - {at: [0, 0], can: [a], delays: 0.1}
tasks:
  - {at: [1, 0], needs: [a]}
  - {at: [2, 0], needs: [a], after: [t1]}
"""


@pytest.fixture
def failing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A policy of a user's that raises whenever it is asked."""
    (tmp_path / "failing_policies.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return "failing_policies:Failing"


def test_who_fails_is_a_row_that_says_so(failing: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("compare", FOUR, "--policies", f"join-all,{failing},heuristic", "--seeds", "2")
    assert teamformer(*words) == 1
    shown = capsys.readouterr().out
    rows = [line.split() for line in shown.splitlines()]
    named = [row for row in rows if len(row) > 1 and row[1] in ("0", "1")]
    assert [row[:2] for row in named] == [
        [name, seed] for name in ("join-all", failing, "heuristic") for seed in ("0", "1")
    ]
    assert [row[2] for row in named if row[0] == failing] == ["failed", "failed"]
    assert all(row[2].isdigit() for row in named if row[0] != failing)
    assert "KeyError: 'luck'" in " ".join(shown.split())


def test_who_fails_is_told_in_json_too(failing: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("compare", FOUR, "--policies", f"join-all,{failing}", "--json") == 1
    good, bad = map(json.loads, capsys.readouterr().out.splitlines())
    assert (good["policy"], good["completed"]) == ("join-all", True)
    assert (bad["policy"], bad["completed"], bad["status"]) == (failing, False, "failed")
    assert (bad["scenario"], bad["seed"], bad["makespan"]) == (good["scenario"], 0, None)
    assert "failing_policies.py" in bad["error"]
    assert good["best_known"] == good["makespan"]


def test_where_all_fail_the_first_error_is_told(
    failing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert teamformer("compare", FOUR, "--policies", failing) == 2
    printed = capsys.readouterr()
    assert "KeyError: 'luck'" in printed.err
    assert printed.out == ""


def test_central_plans_what_comes_after_others_where_robots_are_delayed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two cells in two steps, if nothing delays the robot, as with seed 0; the rules know that."""
    (tmp_path / "mission.yaml").write_text(AFTER_WITH_DELAYS)
    words = ("--policies", "join-all,central", "--time-limit", "0.2", "--json")
    assert teamformer("compare", str(tmp_path / "mission.yaml"), *words) == 0
    simple, planned = map(json.loads, capsys.readouterr().out.splitlines())
    assert (simple["policy"], planned["policy"]) == ("join-all", "central")
    assert simple["makespan"] == planned["makespan"] == planned["lower_bound"] == 2
