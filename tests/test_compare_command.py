"""`teamformer compare` where some methods fail: the others are shown all the same."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from teamformer.cli.verbs.missions import compare
from teamformer.cli.verbs.missions.run import watch_trial
from teamformer.methods.by_name import Method
from teamformer.mission.model import Mission
from teamformer.record.files.reading import read_record
from teamformer.record.files.writing import record_to_tree
from teamformer.trials.trial import PlayedTrial
from typed import FOUR, teamformer

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
def failing(own_folder: Path) -> str:
    """A policy of a user's that raises whenever it is asked."""
    (own_folder / "failing_policies.py").write_text(OWN)
    return "failing_policies:Failing"


def test_who_fails_is_a_row_that_says_so(failing: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = ("compare", FOUR, "--methods", f"join-all,{failing},heuristic", "--seeds", "2")
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
    assert teamformer("compare", FOUR, "--methods", f"join-all,{failing}", "--json") == 1
    good, bad = map(json.loads, capsys.readouterr().out.splitlines())
    assert (good["method"], good["completed"]) == ("join-all", True)
    assert (bad["method"], bad["completed"], bad["status"]) == (failing, False, "failed")
    assert (bad["mission"], bad["seed"], bad["makespan"]) == (good["mission"], 0, None)
    assert "failing_policies.py" in bad["error"]
    assert good["best_known"] == good["makespan"]


def test_where_all_fail_the_first_error_is_told(
    failing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert teamformer("compare", FOUR, "--methods", failing) == 2
    printed = capsys.readouterr()
    assert "KeyError: 'luck'" in printed.err
    assert printed.out == ""


def test_central_plans_what_comes_after_others_where_robots_are_delayed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two cells in two steps, if nothing delays the robot, as with seed 0; the rules know that."""
    (tmp_path / "mission.yaml").write_text(AFTER_WITH_DELAYS)
    words = ("--methods", "join-all,central", "--time-limit", "0.2", "--json")
    assert teamformer("compare", str(tmp_path / "mission.yaml"), *words) == 0
    simple, planned = map(json.loads, capsys.readouterr().out.splitlines())
    assert (simple["method"], planned["method"]) == ("join-all", "central")
    assert simple["makespan"] == planned["makespan"] == planned["lower_bound"] == 2


def shown_on(page: Path) -> dict[str, Any]:
    """Return what a page embeds."""
    text = page.read_text().split('<script type="application/json" id="record">')[1]
    shown: dict[str, Any] = json.loads(text.split("</script>")[0])
    return shown


def test_records_and_one_page_of_them_are_written(failing: str, tmp_path: Path) -> None:
    methods = f"join-all,{failing},heuristic"
    assert teamformer("compare", FOUR, "--methods", methods, "--out", "out") == 1
    out = tmp_path / "out"
    assert {path.name for path in out.iterdir()} == {
        *("join-all-0.json", "heuristic-0.json", "compare.html")
    }  # fmt: skip
    shown = shown_on(out / "compare.html")
    names = ("join-all", "heuristic")
    trees = [record_to_tree(read_record(out / f"{name}-0.json")) for name in names]
    assert shown["compared"] == json.loads(json.dumps(trees))
    [failed] = shown["failed"]
    assert (failed["method"], failed["seed"]) == (failing, 0)
    assert "KeyError: 'luck'" in failed["why"]
    assert teamformer("check", str(out / "join-all-0.json")) == 0


def test_view_puts_several_records_on_one_page(tmp_path: Path) -> None:
    words = ("--methods", "join-all,heuristic", "--out", str(tmp_path))
    assert teamformer("compare", FOUR, *words) == 0
    records = [str(tmp_path / f"{name}-0.json") for name in ("heuristic", "join-all")]
    assert teamformer("view", *records, str(tmp_path / "both.html")) == 0
    shown = shown_on(tmp_path / "both.html")["compared"]
    assert [tree["method"] for tree in shown] == ["heuristic", "join-all"]
    assert teamformer("view", *records) == 0
    assert shown_on(tmp_path / "heuristic-0.html")["compared"] == shown


def test_a_mission_with_a_cost_is_judged_by_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The costs shown are those of `--json`, and the least of them is the best."""
    path = tmp_path / "dear.yaml"
    path.write_text(
        "teamformer: 1\nname: dear\nworld: {grid: [4, 1]}\ncapabilities: [a]\n"
        "robots: [{at: [1, 0], can: [a]}]\ncost: {completion: 1}\n"
        "tasks:\n  - {at: [0, 0], needs: [a], name: light}\n"
        "  - {at: [3, 0], needs: [a], name: heavy, weight: 9}\n"
    )
    assert teamformer("compare", str(path), "--methods", "plan,heuristic", "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    costs = [row["cost"] for row in rows]
    assert teamformer("compare", str(path), "--methods", "plan,heuristic") == 0
    shown = capsys.readouterr().out.splitlines()
    assert shown[1].split()[:4] == ["method", "seed", "makespan", "cost"]
    cells = [line.split() for line in shown[2:4]]
    assert [float(row[3]) for row in cells] == costs
    assert cells[0][4] == "+0%"
    assert cells[1][4] == f"{100 * (costs[1] / costs[0] - 1):+.0f}%"
    assert shown[4].endswith(f"least cost {min(costs):g}")


def test_a_mission_with_windows_is_judged_by_its_lateness_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The heuristic is done first and late by 9; the plan goes to the urgent task first."""
    path = tmp_path / "urgent.yaml"
    path.write_text(
        "teamformer: 1\nname: urgent\nworld: {grid: [12, 1]}\ncapabilities: [a]\n"
        "robots: [{at: [4, 0], can: [a]}]\n"
        "tasks:\n  - {at: [0, 0], needs: [a], name: near}\n"
        "  - {at: [11, 0], needs: [a], name: urgent, between: [0, 7]}\n"
    )
    assert teamformer("compare", str(path), "--methods", "plan,heuristic", "--json") == 0
    planned, simple = map(json.loads, capsys.readouterr().out.splitlines())
    assert (planned["makespan"], planned["late"]) == (18, {})
    [by] = simple["late"].values()
    worth = simple["makespan"] + 2 * by
    assert simple["makespan"] < 18 < worth
    over = round(100 * (worth / 18 - 1), 2)
    assert (planned["percent_over_best"], simple["percent_over_best"]) == (0, over)
    assert teamformer("compare", str(path), "--methods", "plan,heuristic") == 0
    shown = capsys.readouterr().out.splitlines()
    assert shown[1].split()[:5] == ["method", "seed", "makespan", "late", "to"]
    assert shown[2].split()[2:5] == ["18", "-", "+0%"]
    assert shown[3].split()[2:7] == [str(simple["makespan"]), "1", "by", f"{by:g}", f"{over:+.0f}%"]
    assert (
        "`to best` counts the makespan, and 2 times its weight for each step that a task is late"
        in shown
    )


def test_ctrl_c_between_trials_keeps_what_was_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def presses_at_the_third(mission: Mission, method: Method, seed: int) -> PlayedTrial:
        asked.append(seed)
        if len(asked) == 3:
            raise KeyboardInterrupt
        return watch_trial(mission, method, seed)

    monkeypatch.setattr(compare, "watch_trial", presses_at_the_third)
    words = ("compare", FOUR, "--methods", "heuristic", "--seeds", "5", "--out", str(tmp_path))
    assert teamformer(*words) == 1
    shown = capsys.readouterr()
    assert "interrupted: 2 of 5 trials ran to their end" in shown.err
    assert shown.out.count(" heuristic ") == 2
    assert {path.name for path in tmp_path.iterdir()} >= {"heuristic-0.json", "heuristic-1.json"}


def test_ctrl_c_before_any_trial_says_so(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def presses(*_: object) -> PlayedTrial:
        raise KeyboardInterrupt

    monkeypatch.setattr(compare, "watch_trial", presses)
    assert teamformer("compare", FOUR, "--methods", "heuristic") == 1
    assert capsys.readouterr().err.splitlines()[-1] == "interrupted"
