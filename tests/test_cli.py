"""The command line as a person meets it: what it prints, what it writes, how it ends."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest

from teamformer.cli.terminal import console
from teamformer.files.mission_files import read_mission
from teamformer.methods.by_name import load_method
from teamformer.methods.listings import method_listings
from teamformer.record.files.reading import read_record
from teamformer.record.referee import judge
from teamformer.trials.trial import run_trial
from typed import FOUR, teamformer

ROOT = Path(__file__).parent.parent
SMALL_ROBOTS = str(ROOT / "examples" / "robotarium-4.yaml")


def test_run_writes_a_record_that_check_accepts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert teamformer("run", FOUR, "--method", "join-all", "--out", str(tmp_path)) == 0
    shown = capsys.readouterr().out
    record = read_record(tmp_path / "record.json")
    assert f"all done after {record.end.makespan} steps" in shown
    assert all(task.name in shown for task in record.mission.tasks)
    assert "<html" in (tmp_path / "record.html").read_text(encoding="utf-8").lower()
    assert teamformer("check", str(tmp_path / "record.json")) == 0
    assert "legal" in capsys.readouterr().out


def test_run_json_is_one_object_with_every_key(capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("run", FOUR, "--json") == 0
    row = json.loads(capsys.readouterr().out)
    keys = (
        "mission method seed completed makespan steps tasks_done tasks robots capabilities joins "
        "splits illegal_decisions planning_seconds decision_seconds simulating_seconds "
        "compiling_seconds total_seconds best_known lower_bound"
    )
    assert set(keys.split(" ")) <= set(row)
    assert not {"policy", "order", "allocation"} & set(row)
    assert row["method"] == "plan"
    parts = ("planning_seconds", "decision_seconds", "simulating_seconds", "compiling_seconds")
    assert sum(row[part] for part in parts) == pytest.approx(row["total_seconds"], abs=1e-5)
    assert row["completed"] is True
    assert row["makespan"] == row["steps"] >= row["lower_bound"] > 0
    assert (row["tasks_done"], row["tasks"], row["robots"], row["capabilities"]) == (4, 4, 4, 4)
    assert row["illegal_decisions"] == 0


def test_same_seed_same_record(tmp_path: Path) -> None:
    records = []
    for name in ("a", "b"):
        assert teamformer("run", FOUR, "--out", str(tmp_path / name), "--seed", "5") == 0
        records.append((tmp_path / name / "record.json").read_bytes())
    assert records[0] == records[1]


def with_step_limit(folder: Path, steps: int) -> str:
    """Return the example as a file of its own with another step limit."""
    path = folder / "limited.yaml"
    path.write_text(f"step_limit: {steps}\n{Path(FOUR).read_text(encoding='utf-8')}")
    return str(path)


def test_step_limit_makes_a_failure(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("run", with_step_limit(tmp_path, 3)) == 1
    assert "not done within the limit of 3 steps" in capsys.readouterr().out


def test_what_must_be_done_and_is_missed_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nobody is at `far` by step 5, and the mission is over then."""
    text = """
teamformer: 1
world: {grid: [30, 1]}
capabilities: [a]
until: 5
robots: [{name: r, at: [0, 0], can: [a]}]
tasks:
  - {name: near, at: [1, 0], needs: [a]}
  - {name: far, at: [29, 0], needs: [a], KIND}
"""
    for kind, told in {
        "optional: false": "too late at step 5: far must be done",
        "optional: true": "all done or missed after 1 steps",
    }.items():
        (tmp_path / "far.yaml").write_text(text.replace("KIND", kind), encoding="utf-8")
        teamformer("run", str(tmp_path / "far.yaml"))
        assert told in capsys.readouterr().out


def test_a_lost_capability_ends_the_trial_and_names_the_task(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = Path(FOUR).read_text(encoding="utf-8").replace("can: [power]", "can: [power], lost: 2")
    (tmp_path / "lost.yaml").write_text(text, encoding="utf-8")
    assert teamformer("run", str(tmp_path / "lost.yaml"), "--out", str(tmp_path)) == 1
    shown = capsys.readouterr().out
    assert "given up at step 2: t3, t4 can never be done" in shown
    assert "\nlost: r4 in step 2\n" in shown
    assert read_record(tmp_path / "record.json").end.blocked_tasks == ("t3", "t4")
    assert teamformer("check", str(tmp_path / "record.json")) == 0


def test_check_says_what_is_only_claimed_and_compares_the_mission(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--method", "join-all", "--seed", "3", "--out", str(tmp_path))
    assert teamformer("run", with_step_limit(tmp_path, 900), *words) == 0
    record = str(tmp_path / "record.json")
    bound = read_record(tmp_path / "record.json").lower_bound
    capsys.readouterr()
    assert teamformer("check", record) == 0
    claims = f"method join-all, seed 3, lower bound {bound}"
    assert f"only claimed by the record: {claims}\n" in capsys.readouterr().out
    assert teamformer("check", record, "--mission", FOUR, "--json") == 1
    verdict = json.loads(capsys.readouterr().out)
    limit = read_mission(Path(FOUR)).step_limit
    assert [finding["message"] for finding in verdict["findings"]] == [
        f"the record is of another mission than {FOUR}: step_limit is 900, there {limit}"
    ]
    assert verdict["claimed"]["seed"] == 3
    text = Path(FOUR).read_text(encoding="utf-8")
    same = tmp_path / "same.yaml"
    same.write_text(f"step_limit: 900\n{text.replace('name: four', 'name: more than four')}")
    assert teamformer("check", record, "--mission", str(same)) == 0
    for method in ("plan", "crews"):
        assert teamformer("run", FOUR, "--method", method, "--out", str(tmp_path)) == 0
        assert teamformer("check", record, "--mission", FOUR) == 0


def test_check_finds_a_forged_makespan(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("run", FOUR, "--out", str(tmp_path)) == 0
    path = tmp_path / "record.json"
    record = json.loads(path.read_text(encoding="utf-8"))
    record["end"]["makespan"] -= 1
    path.write_text(json.dumps(record), encoding="utf-8")
    capsys.readouterr()
    assert teamformer("check", str(path), "--json") == 1
    verdict = json.loads(capsys.readouterr().out)
    assert verdict["legal"] is False
    assert any("makespan" in finding["message"] for finding in verdict["findings"])


def test_compare_shows_every_method_against_the_best(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("compare", FOUR, "--methods", "heuristic,join-all,central", "--time-limit", "2")
    assert teamformer(*words, "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["method"] for row in rows] == ["heuristic", "join-all", "central"]
    best = min(row["makespan"] for row in rows)
    assert {row["best_known"] for row in rows} == {best}
    assert rows[2]["makespan"] == best
    assert all(row["lower_bound"] <= best for row in rows)
    assert [row["percent_over_best"] == 0 for row in rows] == [r["makespan"] == best for r in rows]
    assert ["relaxed" in row for row in rows] == [False, False, True]
    assert rows[2]["proven"] is True
    assert rows[2]["relaxed"] <= best
    assert rows[2]["played_by"] in ("plan", "search", "schedule", "join-all")
    assert teamformer(*words) == 0
    shown = capsys.readouterr().out
    assert f"best known {best}, lower bound {rows[0]['lower_bound']}" in shown
    assert shown.count("deciding") == 1
    assert f"schedule with free joining: {rows[2]['relaxed']} (optimal" in shown


def test_compare_measures_each_truth_by_its_own_bars(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One step to a task of none to five: by seed all are done in another number of steps."""
    path = tmp_path / "unsure.yaml"
    path.write_text(
        "teamformer: 1\nworld: {grid: [3, 1]}\ncapabilities: [a]\n"
        "robots: [{at: [0, 0], can: [a]}]\n"
        "tasks: [{at: [1, 0], needs: [a], duration: [0, 5], between: [0, 4]}]\n"
    )
    words = ("compare", str(path), "--methods", "join-all,join-fitting", "--seeds", "4")
    assert teamformer(*words, "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    made = {row["seed"]: row["makespan"] for row in rows}
    assert len(set(made.values())) > 1
    for row in rows:
        assert row["makespan"] == row["best_known"] == row["lower_bound"] == made[row["seed"]]
        assert (row["percent_over_best"], row["percent_over_bound"]) == (0, 0)
    assert teamformer(*words) == 0
    shown = capsys.readouterr().out
    for seed, steps in made.items():
        assert f"seed {seed}: best known {steps}, lower bound {steps}\n" in shown


def test_generate_makes_a_mission_that_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "made.yaml"
    words = ("--robots", "6", "--tasks", "9", "--capabilities", "3", "--grid", "12x8")
    assert teamformer("generate", *words, "--seed", "2", "-o", str(path)) == 0
    capsys.readouterr()
    assert teamformer("run", str(path), "--method", "heuristic", "--json") == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["robots"], row["tasks"], row["capabilities"]) == (6, 9, 3)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("run", "nowhere.yaml"), "nowhere.yaml: there is no such file"),
        (("run", str(ROOT)), "this is a folder"),
        (("run", sys.executable), "not"),
        (("run", FOUR, "--seed", "x"), "--seed"),
        (("run", FOUR, "--method", "joinall"), "did you mean 'join-all'?"),
        (("run", FOUR, "--method", "nowhere:Nobody"), "cannot be imported"),
        (("run", FOUR, "--out", "/proc/none"), "cannot be written"),
        (("run", FOUR, "--out", FOUR), "this is no folder"),
        (("robotarium", "fly", SMALL_ROBOTS, "--method", "central"), "plans every step before"),
        (("robotarium", "fly", SMALL_ROBOTS, "--simulator", "x"), "there is no simulator 'x'"),
        (("robotarium", SMALL_ROBOTS), "No such command"),
        (("bench", "robotarium", "--methods", "central"), "plans every step before the start"),
        (("generate", "-o", "x.yaml", "--grid", "99999x99999"), "9,999,800,001 cells"),
        (("run", FOUR, "--policy", "join-all"), "No such option: --policy"),
        (("compare", FOUR, "--methods", "join-all,"), "there is no method without a name"),
        (("compare", FOUR, "--methods", "plan,,crews"), "or drop a comma from a list of them"),
        (("generate", "-o", "/proc/none/x.yaml"), "cannot be written"),
        (("generate", "-o", "x.yaml", "--grid", "ten"), "WIDTHxHEIGHT"),
        (("generate", "-o", "x.yaml", "--robots", "0"), "--robots"),
        (("generate", "-o", "x.yaml", "--grid", "9999x9999"), "99,980,001 cells"),
        (("compare", FOUR, "--methods", "heuristic,heuristic"), "'heuristic' is named twice"),
        (("run", FOUR, "--method", ".mine:X"), "write it as module:Class"),
        (("generate", "-o", "x.yaml", "--requirements", "9"), "requirements is 9"),
        (("check", FOUR), "not"),
        (("view", "nowhere.json"), "there is no such file"),
        (("view", "page.html"), "a page is made of a record"),
        (("compare", FOUR, "--out", "/proc/none"), "cannot be written"),
        (("export", "nowhere.json", "x.mcap"), "there is no such file"),
        (("export", "nowhere.json"), "Missing argument"),
        (("export", "nowhere.json", "x.csv"), "or a folder for tables"),
        (("bench", "sped"), "did you mean 'speed'?"),
        (("fly",), "fly"),
    ],
)
def test_misuse_is_told_and_exits_with_2(
    words: tuple[str, ...],
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert teamformer(*words) == 2
    printed = capsys.readouterr()
    assert message in printed.err
    assert printed.out == ""
    assert list(tmp_path.iterdir()) == []


def test_your_own_policy_by_module_and_class(
    own_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = (ROOT / "docs" / "reference" / "policies.md").read_text(encoding="utf-8")
    code = page.split('```python title="sociable.py"\n')[1].split("```")[0]
    (own_folder / "mine.py").write_text(code, encoding="utf-8")
    assert teamformer("run", FOUR, "--method", "mine:Sociable", "--json") == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["method"], row["tasks_done"], row["illegal_decisions"]) == ("mine:Sociable", 4, 0)


def test_a_mistake_in_your_own_policy_is_told_without_a_traceback(
    own_folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = """
class Wrong:
    needs_everything = False

    def begin(self, everything, rng):
        pass

    def decide(self, view):
        return view.cuonts
"""
    (own_folder / "wrong.py").write_text(code, encoding="utf-8")
    assert teamformer("run", FOUR, "--method", "wrong:Wrong", "--json") == 2
    printed = capsys.readouterr()
    assert "wrong.py:9: AttributeError: 'View' object has no attribute 'cuonts'" in printed.err
    assert printed.out == ""


@pytest.mark.parametrize("words", [(), ("--json",)])
@pytest.mark.thorough
def test_names_that_the_terminal_cannot_show_and_narrow_pipes(
    words: tuple[str, ...], tmp_path: Path
) -> None:
    text = Path(FOUR).read_text(encoding="utf-8").replace("name: four", "name: \u00e9\u4e2d four")
    assert "\u00e9" in text
    (tmp_path / "named.yaml").write_text(text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "teamformer.cli", "run", "named.yaml", *words],
        cwd=tmp_path,
        capture_output=True,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(sys.path),
            "PYTHONIOENCODING": "ascii",
            "COLUMNS": "20",
        },
    )
    told = [line for line in done.stderr.splitlines() if not line.startswith(b"compiling")]
    assert (done.returncode, told) == (0, [])
    shown = done.stdout.decode("ascii")
    if words:
        assert json.loads(shown)["mission"].startswith("\u00e9\u4e2d four")
    else:
        assert shown.startswith(r"\xe9\u4e2d four")
        assert "step  task  needs" in shown


SLOW = """
import time
from teamformer.methods.scripted.joining import JoinAll
class Slow(JoinAll):
    def decide(self, view):
        print('deciding', flush=True)
        time.sleep({pause})
        return super().decide(view)
"""


def start_slow(folder: Path, pause: float, *words: str) -> subprocess.Popen[str]:
    """Start the command line in a folder that has a policy of which each step can be seen."""
    (folder / "slow.py").write_text(SLOW.format(pause=pause), encoding="utf-8")
    return subprocess.Popen(
        [sys.executable, "-m", "teamformer.cli", *words],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join((str(folder), *sys.path))},
    )


def press_ctrl_c(
    process: subprocess.Popen[str], steps: int, wait: float, sent: int = signal.SIGINT
) -> tuple[str, str]:
    """Wait for the last of so many steps to begin, and a little; return what is shown then."""
    assert process.stdout is not None
    for _ in range(steps):
        assert process.stdout.readline() == "deciding\n"
    time.sleep(wait)
    process.send_signal(sent)
    return process.communicate(timeout=60)


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(("pause", "wait"), [(0.2, 0.05), (0.0, 0.001)])
@pytest.mark.thorough
def test_ctrl_c_leaves_a_legal_record_of_what_was_done(
    pause: float, wait: float, sent: int, tmp_path: Path
) -> None:
    process = start_slow(tmp_path, pause, "run", FOUR, "--method", "slow:Slow", "--out", "out")
    shown, errors = press_ctrl_c(process, 3, wait, sent)
    assert "Traceback" not in errors
    record = read_record(tmp_path / "out" / "record.json")
    assert judge(record).findings == ()
    assert record.end.steps >= 2
    if pause:
        assert process.returncode == 1
        assert record.end.status == "interrupted"
        assert f"interrupted at step {record.end.steps}" in shown


@pytest.mark.thorough
def test_ctrl_c_ends_a_comparison_and_shows_what_was_done(tmp_path: Path) -> None:
    words = ("compare", FOUR, "--methods", "join-all,slow:Slow,heuristic", "--seeds", "2")
    process = start_slow(tmp_path, 0.2, *words)
    shown, errors = press_ctrl_c(process, 2, 0.05)
    assert "Traceback" not in errors
    assert process.returncode == 1
    rows = [line.split() for line in shown.splitlines() if " slow" in line or " join-" in line]
    assert [row[:2] for row in rows] == [["join-all", "0"], ["join-all", "1"], ["slow:Slow", "0"]]
    assert rows[2][2] == "interrupted"
    assert "interrupted: 2 of 6 trials" in errors


def test_a_planner_s_bound_is_everybody_s(capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("compare", FOUR, "--methods", "join-all,central", "--json") == 0
    simple, planned = map(json.loads, capsys.readouterr().out.splitlines())
    assert planned["proven"] is True  # so that the relaxed schedule is its own bound
    assert simple["lower_bound"] == planned["lower_bound"] >= planned["relaxed"]
    assert teamformer("run", FOUR, "--method", "central", "--json") == 0
    alone = json.loads(capsys.readouterr().out)
    assert alone["lower_bound"] == planned["lower_bound"]


ONE_BY_ONE = [pytest.param(closed, marks=pytest.mark.slow) for closed in (">&-", "2>&-")]


@pytest.mark.parametrize("closed", [">&- 2>&-", "<&-", *ONE_BY_ONE])
@pytest.mark.thorough
def test_closed_streams_are_no_fault(closed: str) -> None:
    command = f"{sys.executable} -m teamformer.cli run {FOUR} --method join-all {closed}"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(command, shell=True, capture_output=True, text=True, env=environment)
    assert done.returncode == 0
    assert "Traceback" not in done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_what_cannot_be_printed_is_told() -> None:
    command = [sys.executable, "-m", "teamformer.cli", "methods"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, env=environment)
    assert done.returncode == 1
    assert done.stderr == b"error: the output cannot be written: No space left on device\n"


@pytest.mark.thorough
def test_in_a_narrow_terminal_nothing_is_left_out() -> None:
    environment = {"COLUMNS": "40", "PYTHONPATH": os.pathsep.join(sys.path)}
    for words in (["compare", FOUR, "--methods", "join-all"], ["methods"]):
        shown = show_in_terminal(words, {**os.environ, **environment})
        assert "…" not in shown
        assert "join-all" in shown


def show_in_terminal(words: list[str], environment: dict[str, str]) -> str:
    """Return what a terminal is sent."""
    master, slave = pty.openpty()
    command = [sys.executable, "-m", "teamformer.cli", *words]
    with subprocess.Popen(command, stdout=slave, stderr=subprocess.DEVNULL, env=environment):
        os.close(slave)
        sent = b""
        with contextlib.suppress(OSError):  # what reading raises once the other side has gone
            while part := os.read(master, 4096):
                sent += part
    os.close(master)
    return sent.decode()


def test_many_robots_are_not_all_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "crowd.yaml"
    sizes = ("--robots", "14", "--capabilities", "14", "--tasks", "1", "--requirements", "14")
    assert teamformer("generate", *sizes, "-o", str(file)) == 0
    assert teamformer("run", str(file), "--method", "join-all") == 0
    shown = capsys.readouterr().out
    assert "r1, r2, r3, r4, r5, r6, r7, r8, r9, r10, r11 and 3 more" in shown


def test_on_a_full_disk_the_result_is_shown_and_no_half_record_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def write(path: Path, data: bytes) -> int:
        path.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", write)
    assert teamformer("run", FOUR, "--method", "join-all", "--json", "--out", str(tmp_path)) == 1
    printed = capsys.readouterr()
    assert json.loads(printed.out)["completed"] is True
    assert f"error: {tmp_path / 'record.json'}: No space left on device" in printed.err
    assert list(tmp_path.iterdir()) == []


def test_a_mission_too_large_to_be_planned_soon_is_solved_by_crews_and_run_says_so(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("teamformer.planning.steps.shared_plan.MOST_AT_ONCE", 31)  # 4 * (4 + 4)
    assert teamformer("run", FOUR, "--json") == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out)["method"] == "crews"
    assert "4 robots and 4 tasks are too many for the method plan: crews instead" in shown.err
    assert teamformer("run", FOUR, "--json", "--method", "plan") == 0
    shown = capsys.readouterr()
    assert json.loads(shown.out)["method"] == "plan"
    assert "too many" not in shown.err


def test_run_says_by_which_method_and_what_took_the_time(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert teamformer("run", FOUR) == 0
    shown = capsys.readouterr().out
    assert shown.startswith("four robots: plan, seed 0\n")
    seconds = r"\d+\.\d\d s"
    line = f"planning {seconds}, deciding {seconds}, simulating {seconds}\n"
    assert re.search(line, shown), shown


def test_compare_plays_every_method_under_what_it_was_made_for(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """What each does in `compare` is what it does alone, by its own coordination."""
    names = ["heuristic", "join-all", "teamformer", "crews", "plan"]
    assert teamformer("compare", FOUR, "--methods", ",".join(names), "--json") == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["method"] for row in rows] == names
    mission = read_mission(Path(FOUR))
    for row in rows:
        end = run_trial(mission, load_method(row["method"])).record.end
        made = (end.makespan, end.joins, end.splits)
        assert (row["makespan"], row["joins"], row["splits"]) == made, row["method"]


def test_methods_are_listed_once_each_with_who_says_the_tasks(
    capsys: pytest.CaptureFixture[str],
) -> None:
    listings = method_listings()
    tasks_by = {listing.name: listing.tasks_by for listing in listings}
    assert len(tasks_by) == len(listings)
    for name in ("plan", "central", "crews", "soonest", "reactive", "teamformer-tasks"):
        assert tasks_by.pop(name) == "its own plan"
    assert set(tasks_by.values()) == {"the paper's order"}
    assert teamformer("methods") == 0
    told = capsys.readouterr().out
    assert all(f"\n {listing.name} " in told for listing in listings)
    assert "your own: --method module:Class (docs/reference/methods.md)" in told


@pytest.mark.parametrize("command", ["methods", f"run {FOUR} --method join-all --out out"])
@pytest.mark.thorough
def test_a_reader_that_has_seen_enough_is_no_fault(command: str, tmp_path: Path) -> None:
    pipeline = f"set -o pipefail; {sys.executable} -m teamformer.cli {command} | true"
    done = subprocess.run(
        ["bash", "-c", pipeline],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert "Traceback" not in done.stderr
    assert "Exception" not in done.stderr
    assert done.returncode == 0
    if "out" in command:
        assert read_record(tmp_path / "out" / "record.json").end.status == "completed"


def test_generate_overwrites_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mission.yaml"
    path.write_text("by hand")
    assert teamformer("generate", "-o", str(path)) == 2
    assert f"error: {path}: there is such a file\nhint: remove it, or name another" in (
        capsys.readouterr().err
    )
    assert path.read_text() == "by hand"
    assert teamformer("generate", "--setting", "4N20T-C4", "-o", str(path)) == 2
    path.unlink()
    assert teamformer("generate", "--setting", "4N20T-C4", "-o", str(path)) == 0


def test_the_version_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert teamformer("--version") == 0
    assert capsys.readouterr().out == f"teamformer {version('teamformer')}\n"


def test_where_there_is_no_terminal_there_is_no_bar(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(console, "PATIENCE", -1.0)
    with console.StepProgress(3) as progress:
        progress.update(1, 1)
    assert capsys.readouterr().err == ""
