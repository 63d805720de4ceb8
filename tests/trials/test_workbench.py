"""What programs may do with missions in a folder: nothing outside of it, and in few words."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.mission_files import write_mission
from teamformer.trials.api.missions import generate, load
from teamformer.trials.mcp.telling import MOST_LINES, in_words, of_tools
from teamformer.trials.mcp.work_folder import WorkFolder
from teamformer.trials.mcp.workbench import TOOLS, Workbench

WRONG = {
    "teamformer": 1,
    "world": {"grid": [4, 4]},
    "capabilities": ["a"],
    "robots": [{"at": [9, 9], "can": ["a"]}],
    "tasks": [{"at": [1, 1], "needs": ["a"]}, {"at": [1, 1], "needs": ["b"]}],
}


@pytest.fixture
def bench(tmp_path: Path) -> Workbench:
    inside = tmp_path / "inside"
    inside.mkdir()
    (tmp_path / "secret.yaml").write_text(TINY)
    (tmp_path / "secret.map").write_text("type octile\nheight 1\nwidth 2\nmap\n..\n")
    return Workbench(WorkFolder(inside))


TINY = """\
teamformer: 1
world: {grid: [4, 4]}
capabilities: [a]
robots: [{at: [0, 0], can: [a]}]
tasks: [{at: [3, 3], needs: [a]}]
"""


def test_every_mistake_has_its_path_or_its_line(bench: Workbench) -> None:
    told = bench.write_mission("wrong.yaml", WRONG)
    assert [it["where"] for it in told["mistakes"]] == ["robots[0].at", "tasks[1].needs"]
    assert told["mistakes"][1]["message"].endswith("not under capabilities; add it there")
    assert all("line" not in it for it in told["mistakes"])
    assert bench.list_files() == {"files": []}
    told = bench.write_mission("wrong.yaml", TINY.replace("[3, 3]", "[4, 3]"))
    (mistake,) = told["mistakes"]
    assert (mistake["where"], mistake["line"]) == ("tasks[0].at", 5)


def test_a_tool_says_each_mistake_of_a_mission_that_it_cannot_use(bench: Workbench) -> None:
    (bench.folder.root / "wrong.json").write_text(json.dumps(WRONG))
    with pytest.raises(MissionError) as error:
        bench.run_mission("wrong.json")
    first, second = in_words(error.value).splitlines()
    assert "wrong.json:1: robot 'r1' is at [9, 9]" in first
    assert "add it there" in second


def test_what_is_right_is_written_as_it_was_said(bench: Workbench) -> None:
    said = f"# by night\n{TINY}"
    assert bench.write_mission("night/a.yaml", said)["written"]
    assert (bench.folder.root / "night" / "a.yaml").read_text() == said
    with pytest.raises(TeamformerError, match="there is such a file"):
        bench.write_mission("night/a.yaml", TINY)
    assert bench.write_mission("night/a.yaml", TINY, replace=True)["tasks"] == 1
    assert bench.list_files() == {"files": ["night/a.yaml"]}


@pytest.mark.parametrize(
    "name", ["../secret.yaml", "/etc/hostname", "link.yaml", "up/secret.yaml", "", "a\0b"]
)
def test_nothing_outside_is_read_or_written(bench: Workbench, name: str) -> None:
    root = bench.folder.root
    (root / "link.yaml").symlink_to(root.parent / "secret.yaml")
    (root / "up").symlink_to(root.parent)
    before = (root.parent / "secret.yaml").read_text()
    actions: tuple[Callable[[], object], ...] = (
        lambda: bench.check_mission(name),
        lambda: bench.explain(name),
        lambda: bench.write_mission(name, TINY.replace("3, 3", "2, 2"), replace=True),
        lambda: bench.show([name]),
        lambda: bench.change_mission(name, "without task t1", "new.yaml"),
    )
    for act in actions:
        with pytest.raises(TeamformerError):
            act()
    assert (root.parent / "secret.yaml").read_text() == before
    assert sorted(path.name for path in root.iterdir()) == ["link.yaml", "up"]


def test_a_result_is_not_written_through_a_link_that_leads_out(bench: Workbench) -> None:
    bench.write_mission("a.yaml", TINY)
    secret = bench.folder.root.parent / "secret.yaml"
    for folder in ("out", "plan"):
        (bench.folder.root / folder).mkdir()
    for folder in ("out", "plan"):
        (bench.folder.root / folder / "record.html").symlink_to(secret)
    for act in (bench.run_mission, bench.plan_mission):
        with pytest.raises(TeamformerError, match="this is not in"):
            act("a.yaml", seconds=0.1)  # type: ignore[operator]
    assert secret.read_text() == TINY


def test_a_mission_names_no_map_outside(bench: Workbench) -> None:
    text = TINY.replace("grid: [4, 4]", "map: ../secret.map").replace("[3, 3]", "[1, 0]")
    (mistake,) = bench.write_mission("m.yaml", text)["mistakes"]
    assert "this is not in" in mistake["message"]
    secret = (bench.folder.root.parent / "secret.map").read_text()
    (bench.folder.root / "own.map").write_text(secret)
    assert bench.write_mission("m.yaml", text.replace("../secret", "own"))["written"]


@pytest.mark.parametrize("method", ["mine:Patient", "runs/teamformer", "nobody"])
def test_methods_are_those_that_are_listed(bench: Workbench, method: str) -> None:
    bench.write_mission("a.yaml", TINY)
    with pytest.raises(TeamformerError, match="there is no method"):
        bench.run_mission("a.yaml", method)


def test_results_are_short_whatever_the_mission(bench: Workbench) -> None:
    path = bench.folder.root / "large.yaml"
    write_mission(generate(seed=1, robots=60, tasks=80), path)
    told = bench.run_mission("large.yaml", "crews")
    assert told["status"] == "completed"
    assert len(told["done"]) == MOST_LINES + 1
    assert told["done"][-1] == f"and {80 - MOST_LINES} more; the page has all"
    assert len(json.dumps(told)) < 6000
    assert told["legal"]


def test_a_change_is_one_that_advise_measures(bench: Workbench) -> None:
    bench.write_mission("a.yaml", TINY)
    bench.change_mission("a.yaml", "one more robot like r1", "more.yaml")
    assert len(load(bench.folder.root / "more.yaml").robots) == 2
    with pytest.raises(TeamformerError, match="could not be done"):
        bench.change_mission("a.yaml", "without robot r1", "none.yaml")
    with pytest.raises(TeamformerError) as error:
        bench.change_mission("a.yaml", "one more robot like r2", "none.yaml")
    assert error.value.hint == "did you mean 'one more robot like r1' or 'without robot r1'?"


def test_a_plan_is_a_record_with_its_page(bench: Workbench) -> None:
    bench.write_mission("a.yaml", TINY)
    told = bench.plan_mission("a.yaml", seconds=0.2, out="plans/a")
    assert (told["makespan"], told["proven"]) == (6, True)
    assert told["routes"] == ["r1: t1 6-6"]
    assert told["page"] == "plans/a/record.html"
    assert bench.check_record(told["record"]) == {"legal": True, "findings": []}
    assert bench.explain(told["record"])["why_so_late"] == told["why_so_late"]


def test_every_tool_says_what_it_is() -> None:
    for name in TOOLS:
        assert getattr(Workbench, name).__doc__


def test_a_remedy_names_tools_where_the_terminal_has_verbs() -> None:
    told = "use `teamformer run MISSION --out DIR`, `compare` or `live`; see `to best`"
    assert of_tools(told) == "use run_mission, compare_methods or `live`; see `to best`"
