"""`teamformer import` and `teamformer plan` as a person meets them."""

from __future__ import annotations

import json
import math
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from others_rules import dcmrta_makespan, hetero_mrta_makespan, hhcrsp_cost, sadcher_makespan
from teamformer.files.mission_files import read_mission
from teamformer.planning.continuous.rules import warm_up
from typed import FOUR, teamformer

TREE = {
    "setup": {"robots": 4, "tasks": 3, "num_skills": 2},
    "tasks": {
        "0": {"pos": {"x": 0.5, "y": 0.25}, "skillset": {"0": 1, "1": 1}, "duration": 1.5},
        "1": {"pos": {"x": 0.9, "y": 0.75}, "skillset": {"0": 1, "1": 0}, "duration": 2.25},
        "2": {"pos": {"x": 0.2, "y": 0.85}, "skillset": {"0": 0, "1": 1}, "duration": 0.5},
    },
    "robots": {
        str(n): {"pose": {"x": 0.1, "y": 0.2}, "skillset": {"0": n % 2, "1": 1 - n % 2}}
        for n in range(4)
    },
}

OTHERS = Path(os.environ.get("TEAMFORMER_OTHERS", "/nowhere"))
needs_data = pytest.mark.skipif(
    not OTHERS.is_dir(), reason="TEAMFORMER_OTHERS names no folder with other people's instances"
)


def plan(mission: Path, capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    warm_up()
    capsys.readouterr()
    assert teamformer("plan", str(mission), "--json", *words) == 0
    row: dict[str, Any] = json.loads(capsys.readouterr().out)
    return row


def routes(row: dict[str, Any]) -> dict[str, list[str]]:
    return {route["robot"]: [s["task"] for s in route["stops"]] for route in row["routes"]}


@pytest.fixture
def imported(tmp_path: Path) -> Path:
    path = tmp_path / "env_0.json"
    path.write_text(json.dumps(TREE))
    assert teamformer("import", "hetero-mrta", str(path), "-o", str(tmp_path / "m.yaml")) == 0
    return tmp_path / "m.yaml"


def test_names_are_printed_as_they_are(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What stands in square brackets is no colour."""
    robots = [{"name": "[red]", "at": [0, 0], "can": ["a"]}]
    tasks = [{"name": "[/]", "at": [1, 0], "needs": ["a"]}]
    world = {"name": "[b]", "world": {"grid": [2, 1]}, "capabilities": ["a"]}
    tree = {"teamformer": 1, "time": "continuous", **world, "robots": robots, "tasks": tasks}
    (tmp_path / "names.yaml").write_text(yaml.safe_dump(tree))
    assert teamformer("plan", str(tmp_path / "names.yaml"), "--method", "plan") == 0
    shown = capsys.readouterr().out.split()
    assert shown[0] == "[b]:"
    why = shown.index("why")
    assert shown[why - 3 : why] == ["[red]", "[/]", "1-1"]  # and no "back": nobody goes home
    assert shown[-5:] == ["0-1:", "[/]:", "[red]", "walks", "1"]


@pytest.mark.parametrize("policy", ["central", "plan", "reactive"])
def test_plans_keep_the_instance_s_own_rules(
    policy: str, imported: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    row = plan(imported, capsys, "--method", policy, "--time-limit", "5")
    assert row["makespan"] == pytest.approx(hetero_mrta_makespan(TREE, routes(row)), abs=1e-6)
    assert [route["robot"] for route in row["routes"]] == ["r0", "r1", "r2", "r3"]
    assert max(route["back"] for route in row["routes"]) == row["makespan"] >= row["bound"]
    for route in row["routes"]:
        times = [t for stop in route["stops"] for t in (stop["arrive"], stop["start"], stop["end"])]
        assert times == sorted(times)
    if policy == "central":
        # t1 takes a robot there and back, at a speed of 0.2, and 2.25: more than the others take
        assert row["proven"] is True
        assert row["makespan"] == pytest.approx(10 * math.hypot(0.8, 0.55) + 2.25, abs=1e-6)


@pytest.mark.parametrize("mission", ["imported", FOUR])
def test_a_plan_is_a_record_like_any_other(
    mission: str, imported: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is judged, exported, shown, and begun with; its critical path is that of the plan."""
    file, folder = imported if mission == "imported" else Path(mission), tmp_path / "out"
    record = str(folder / "record.json")
    row = plan(file, capsys, "--time-limit", "0.5", "--out", str(folder))
    assert teamformer("check", record, "--json") == 0
    assert json.loads(capsys.readouterr().out)["critical_path"] == row["critical_path"]
    assert teamformer("export", record, str(tmp_path / "tables")) == 0
    assert teamformer("view", record, str(tmp_path / "page.html")) == 0
    assert (tmp_path / "page.html").read_text() == (folder / "record.html").read_text()
    assert (tmp_path / "tables" / "tasks.csv").read_text().count("\n") == 1 + len(
        read_mission(file).tasks
    )
    again = plan(file, capsys, "--time-limit", "0", "--from", record)
    assert again["makespan"] <= row["makespan"]


def test_a_mission_in_continuous_time_is_run_as_it_is_planned(
    imported: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    row = plan(imported, capsys, "--method", "plan")
    assert teamformer("run", str(imported), "--json") == 0
    told = json.loads(capsys.readouterr().out)
    assert round(told["makespan"], 6) == row["makespan"]
    assert told["critical_path"][-1]["to"] == row["makespan"]


def test_real_robots_refuse_continuous_time(
    imported: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert teamformer("robotarium", "fly", str(imported)) == 2
    said = capsys.readouterr().err
    assert "missions in continuous time are not played in steps" in said
    assert f"{imported}:" in said


WHOLE = """
teamformer: 1
time: continuous
world: {grid: [9, 1]}
capabilities: [a, b]
robots: [{name: r, at: [0, 0], can: [a]}, {name: s, at: [8, 0], can: [b]}]
tasks:
  - {name: one, at: [2, 0], needs: [a], duration: 3}
  - {name: two, at: [4, 0], needs: [a, b], duration: 5}
  - {name: three, at: [8, 0], needs: [b], duration: 2}
"""


def test_a_bound_of_whole_times_is_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By r: 4 to walk and 3 at `one`, then 5 at `two`: 12; or s does `three` later, at 18."""
    (tmp_path / "whole.yaml").write_text(WHOLE)
    row = plan(tmp_path / "whole.yaml", capsys, "--time-limit", "1")
    assert (row["makespan"], row["bound"], row["proven"]) == (12, 12, True)


def test_missions_in_steps_are_planned_too(capsys: pytest.CaptureFixture[str]) -> None:
    row = plan(Path(FOUR), capsys, "--time-limit", "1")
    stops = [stop for route in row["routes"] for stop in route["stops"]]
    assert {stop["task"] for stop in stops} == {t.name for t in read_mission(Path(FOUR)).tasks}
    assert max(stop["end"] for stop in stops) == row["makespan"]
    assert all(stop["arrive"] <= stop["start"] <= stop["end"] for stop in stops)


LATE = """
teamformer: 1
world: {grid: [9, 1]}
capabilities: [a]
robots: [{name: r, at: [0, 0], can: [a]}]
tasks:
  - {name: near, at: [2, 0], needs: [a], between: [7.5, 9]}
  - {name: far, at: [6, 0], needs: [a], between: [0, 4]}
"""


def test_plans_in_steps_wait_for_windows_and_tell_who_is_late(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """To `far` in 6 steps, then 4 back to `near`, whose window has begun by then."""
    (tmp_path / "late.yaml").write_text(LATE)
    row = plan(tmp_path / "late.yaml", capsys, "--time-limit", "1")
    assert (row["makespan"], row["late"]) == (10, {"near": 1, "far": 2})


def test_a_bound_of_the_makespan_is_none_of_the_cost(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Whatever comes first, 10 steps are the least; (2 * 10 + 1 + 2) / 3 is the cost of `LATE`."""
    text = f"{LATE}cost: {{makespan: 2, tardiness: 1}}\n"
    (tmp_path / "late.yaml").write_text(text)
    assert teamformer("plan", str(tmp_path / "late.yaml"), "--time-limit", "1") == 0
    first = capsys.readouterr().out.splitlines()[0]
    assert re.fullmatch(
        r"late: over at 10, at a cost of 7.66667; no plan can take less than \d+", first
    )


LOST = """
teamformer: 1
world: {grid: [15, 5]}
capabilities: [a]
robots:
  - {name: x, at: [0, 0], can: [a], lost: 3}
  - {name: y, at: [0, 0], can: [a]}
tasks:
  - {name: t, at: [14, 1], needs: [a], only: [x]}
"""


def test_what_can_never_be_done_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "lost.yaml").write_text(LOST)
    assert teamformer("plan", str(tmp_path / "lost.yaml"), "--time-limit", "1") == 1
    said = capsys.readouterr().err
    assert "lost: t can never be done: since step 3 no robots are left" in said
    assert "--time-limit" not in said


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("plan", FOUR, "--method", "best"), "method 'best' makes no plans"),
        (("plan", FOUR, "--method", "reactive"), "plans missions in continuous time"),
        (("plan", FOUR, "--out", FOUR), "this is no folder"),
        (("plan", "nowhere.yaml"), "nowhere.yaml"),
        (("import", "mrta", FOUR, "-o", "x.yaml"), "format 'mrta' is unknown"),
        (("import", "hetero-mrta", FOUR, "-o", "x.yaml"), "this is not whole JSON"),
    ],
)
def test_misuse_is_told(
    words: tuple[str, ...], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert teamformer(*words) == 2
    assert told in capsys.readouterr().err


@needs_data
@pytest.mark.parametrize("path", sorted(OTHERS.glob("ral/env_*.json"))[:3], ids=lambda p: p.stem)
def test_real_instances_of_hetero_mrta(
    path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert teamformer("import", "hetero-mrta", str(path), "-o", str(tmp_path / "m.yaml")) == 0
    row = plan(tmp_path / "m.yaml", capsys, "--method", "plan")
    tree = json.loads(path.read_text())
    assert row["makespan"] == pytest.approx(hetero_mrta_makespan(tree, routes(row)), abs=1e-6)


# Routes and makespan of CTAS-D, as HeteroMRTA's authors publish them (Apache-2.0). Their files have
# six places of every time, and no other source tells more: all six are asserted.
CTAS_D = {
    "env_0": (
        "27.845170",
        "12 7 1 3|11 16 13 8|4 19 18 6 15 2|11 5 3|16 8|12 18 6 14 0|4 19 6 14 2|11 16 17 9|"
        "10 5 13 8|10 7 14|5 1 3|16 8|4 19 18 6 14 0|16 17 15 2|",
    ),
    "env_1": (
        "23.175377",
        "2 15 14|17 19|4 13 18|17 1 3 18 8|7 16 11 14|10 4 15 0 12|16 9 5|4 13 0|6 1 3 18|10 9|"
        "2 16 0|7 4 19 18|10 9|4 13 11 14|17 19 18",
    ),
}


@needs_data
@pytest.mark.parametrize("name", CTAS_D)
def test_the_rules_give_the_makespan_that_is_published_for_ctas_d(name: str) -> None:
    published, routes = CTAS_D[name]
    tree = json.loads((OTHERS / "ral" / f"{name}.json").read_text())
    named = {
        f"r{number}": [f"t{task}" for task in route.split()]
        for number, route in enumerate(routes.split("|"))
    }
    assert f"{hetero_mrta_makespan(tree, named):.6f}" == published


@needs_data
def test_real_instances_of_dcmrta(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = OTHERS / "dcmrta" / "env_0"
    assert teamformer("import", "dcmrta", str(folder), "-o", str(tmp_path / "m.yaml")) == 0
    row = plan(tmp_path / "m.yaml", capsys, "--method", "plan")
    graph, needs = read_dcmrta(folder)
    assert row["makespan"] == pytest.approx(dcmrta_makespan(graph, needs, routes(row)), abs=1e-5)


def read_dcmrta(folder: Path) -> tuple[dict[str, Any], dict[str, int]]:
    graph = yaml.safe_load((folder / "graph.yaml").read_text())["vehicle0"]
    tasks = yaml.safe_load((folder / "task_param.yaml").read_text())
    needs = {f"t{n}": int(tasks[f"task{n}"]["and0"]["or0"]["capReq"]) for n in range(len(tasks))}
    return graph, needs


@needs_data
@pytest.mark.parametrize("number", range(3))
def test_sadcher_optima_are_proven(
    number: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = OTHERS / "sadcher" / "three.json"
    assert teamformer("import", "sadcher", str(path), "-o", str(tmp_path / "three")) == 0
    row = plan(tmp_path / "three" / f"three-{number}.yaml", capsys, "--time-limit", "20")
    tree = json.loads(path.read_text())[number]
    assert row["proven"] is True
    assert row["makespan"] == pytest.approx(tree["milp_optimum"], abs=1e-4)
    assert row["makespan"] == pytest.approx(sadcher_makespan(tree, routes(row)), abs=1e-5)


HHCRSP = OTHERS / "hhcrsp"
REPORTED = {  # of the ten smallest instances, to one place, as papers on them tell it
    **{"10_1": 218.2, "10_2": 246.6, "10_3": 305.9, "10_4": 186.9, "10_5": 189.5},
    **{"10_6": 200.1, "10_7": 225.4, "10_8": 232.0, "10_9": 222.3, "10_10": 225.0},
}


def hhcrsp_instance(name: str) -> tuple[Path, Any, float]:
    """Return an instance's file, its tree, and what the published solution of it costs."""
    path = HHCRSP / "instances" / f"InstanzCPLEX_HCSRP_{name}.json"
    tree = json.loads(path.read_text())
    [solution] = (HHCRSP / "solutions").glob(f"sol-{path.stem}-*.json")
    visits = {
        route["caregiver_id"]: [
            (stop["patient"], stop["service"], stop["arrival_time"])
            for stop in route.get("locations", ())
        ]
        for route in json.loads(solution.read_text())["routes"]
    }
    return path, tree, hhcrsp_cost(tree, visits)


@needs_data
@pytest.mark.parametrize("name", REPORTED)
def test_the_rules_give_the_costs_that_are_published_of_hhcrsp(name: str) -> None:
    assert hhcrsp_instance(name)[2] == pytest.approx(REPORTED[name], abs=0.05)


@needs_data
@pytest.mark.parametrize("name", ["10_1", "10_3"])
def test_real_instances_of_hhcrsp(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, tree, published = hhcrsp_instance(name)
    assert teamformer("import", "hhcrsp", str(path), "-o", str(tmp_path / "m.yaml")) == 0
    row = plan(tmp_path / "m.yaml", capsys, "--method", "plan")
    visits = {
        route["robot"]: [visit_of(tree, stop) for stop in route["stops"]] for route in row["routes"]
    }
    assert hhcrsp_cost(tree, visits) == pytest.approx(row["cost"], abs=1e-4)
    assert row["cost"] == pytest.approx(published, abs=1e-3)


@needs_data
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "above"),
    [("kummer/HHCRSP_25_5_37_0.8_R_RC", 0.02), ("italian/instance_003-rome-*", 0.10)],
)
def test_the_validator_of_its_authors_finds_plans_of_hhcrsp_legal(
    name: str, above: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    [path] = HHCRSP.glob(f"{name}.json")
    tree = json.loads(path.read_text())
    assert teamformer("import", "hhcrsp", str(path), "-o", str(tmp_path / "m.yaml")) == 0
    row = plan(tmp_path / "m.yaml", capsys, "--method", "plan")
    keys = ("patient", "service", "arrival_time")
    told = {
        "routes": [
            {
                "caregiver_id": route["robot"],
                "locations": [
                    dict(zip(keys, visit_of(tree, stop), strict=True))
                    | {"departure_time": stop["end"]}
                    for stop in route["stops"]
                ],
            }
            for route in row["routes"]
        ]
    }
    solution = tmp_path / "solution.json"
    solution.write_text(json.dumps(told))
    words = [sys.executable, "validator.py", "check-solution", str(path), str(solution)]
    run = subprocess.run(words, cwd=HHCRSP / "validator", capture_output=True, text=True)
    if "ModuleNotFoundError" in run.stderr:
        pytest.skip("the validator needs pyparsing, scipy, click and pandas")
    assert run.returncode == 0, run.stderr
    assert json.loads(run.stdout)["total_cost"] == pytest.approx(row["cost"], abs=1e-4)
    [best] = best_published(path)
    assert best <= row["cost"] + 0.5 <= best * (1 + above)


def best_published(path: Path) -> list[float]:
    """Return the best cost that is published of an instance."""
    told = (HHCRSP / f"{path.parent.name}_best.md").read_text().splitlines()
    rows = [[cell.strip() for cell in line.split("|")] for line in told]
    return [float(row[5]) for row in rows if len(row) > 5 and row[1] == path.name]


def visit_of(tree: Any, stop: dict[str, Any]) -> tuple[str, str, float]:
    patient, _, service = stop["task"].partition("-")
    [asked] = [p["required_caregivers"] for p in tree["patients"] if p["id"] == patient]
    return patient, service or asked[0]["service"], stop["start"]
