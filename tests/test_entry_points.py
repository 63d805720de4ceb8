"""What packages bring by name: found with ours, and told with the package where it fails."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pytest

from packages import add_package, packages_in
from small_worlds import two_robots_one_task
from teamformer.base import entry_points
from teamformer.base.entry_points import GROUPS, brought, find_brought, names_of
from teamformer.base.errors import TeamformerError
from teamformer.cli.verbs.records.export import export
from teamformer.files.imports import import_missions
from teamformer.fleet.bodies.body import Report
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.process.bodies_by_name import body_maker
from teamformer.methods.by_name import files_of_own, load_method
from teamformer.methods.listings import method_listings, method_names, our_method_names
from teamformer.record.files.writing import save_record
from teamformer.trials.trial import run_trial
from typed import teamformer

CODE = """
from teamformer.methods.coordinators.crews import Crews
from teamformer.fleet.bodies.body import Report
from teamformer.methods.scripted.joining import JoinAll
from teamformer.files.drawn.smallest import smallest_mission


class Eager(JoinAll):
    '''Joins whomever it meets.

    And more.
    '''


class Rude(JoinAll):
    def decide(self, view):
        return 1 / 0


class Still:
    def __init__(self, mission, robot, address, line):
        self.at = mission.source.robots[robot].at
        self.address = address

    def command(self, command):
        pass

    def report(self):
        return Report(*self.at) if self.address == "here" else "nowhere"

    def close(self):
        pass


def read(path):
    return [smallest_mission()] if path.suffix == ".good" else 3


def write(record, path):
    path.write_text(str(record.end.makespan))
"""

METHODS = {
    "eager": "eager_robots:Eager",
    "rude": "eager_robots:Rude",
    "gone": "eager_robots:Gone",
    "lost": "no_such_module:Lost",
    "twice": "eager_robots:Eager",
    "gnn-c4": "eager_robots:Eager",
}
OTHERS = {
    "bodies": {"still": "eager_robots:Still"},
    "importers": {"ours": "eager_robots:read"},
    "exporters": {"steps": "eager_robots:write"},
}


@pytest.fixture(autouse=True)
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    folder = tmp_path / "site-packages"
    folder.mkdir()
    add_package(folder, "eager-robots", {"methods": METHODS, **OTHERS}, "eager_robots", CODE)
    add_package(folder, "rivals", {"methods": {"twice": "rivals:Rival"}}, "rivals", "")
    with packages_in(folder, monkeypatch):
        yield


def test_ours_are_found_as_others_are() -> None:
    """The installation names what the project's file declares; if not, install it again."""
    project = Path(__file__).parents[1] / "pyproject.toml"
    declared = tomllib.loads(project.read_text())["project"]["entry-points"]
    for what, group in GROUPS.items():
        ours = {one.name: one.entry.value for one in brought(what) if one.is_ours}
        assert ours == declared[group]
        for one in brought(what):
            if one.is_ours:
                assert callable(one.load())


def test_a_method_of_a_package_is_listed_with_it_and_run() -> None:
    told = {listing.name: listing for listing in method_listings()}
    assert told["eager"].summary == "Joins whomever it meets"
    assert (told["eager"].package, told["plan"].package) == ("eager-robots", "teamformer")
    assert told["eager"].tasks_by == "the paper's order"
    assert "package 'eager-robots' cannot be loaded" in told["gone"].summary
    assert "eager" in method_names()
    assert "eager" not in our_method_names()
    assert [file.name for file in files_of_own("eager")] == ["eager_robots.py"]
    record = run_trial(two_robots_one_task(), load_method("eager")).record
    assert (record.method, record.end.status) == ("eager", "completed")


@pytest.mark.parametrize(
    ("name", "message", "hint"),
    [
        ("twice", "'twice' comes with two packages, eager-robots and rivals", "uninstall rivals"),
        ("gnn-c4", "two packages, teamformer and eager-robots", "uninstall eager-robots"),
        ("gone", "'gone' of package 'eager-robots' cannot be loaded.*Gone", "pip uninstall eager"),
        ("lost", "'lost' of package 'eager-robots'.*No module named", "update the package"),
        ("eagre", "there is no method 'eagre'", "did you mean 'eager'"),
    ],
)
def test_what_cannot_be_loaded_is_told_with_its_package(name: str, message: str, hint: str) -> None:
    with pytest.raises(TeamformerError, match=message) as caught:
        load_method(name)
    assert hint in caught.value.hint


def test_what_a_package_does_wrong_is_told_by_file_and_line() -> None:
    with pytest.raises(TeamformerError, match=r"'rude' failed at \S*eager_robots.py:17: ZeroDiv"):
        run_trial(two_robots_one_task(), load_method("rude"))


def test_bodies_importers_and_exporters_of_packages(tmp_path: Path) -> None:
    line, fleet = cast(Any, None), FleetMission(two_robots_one_task())
    at = fleet.source.robots[1].at
    assert body_maker("still:here")(fleet, 1, line).report() == Report(*map(float, at))
    with pytest.raises(TeamformerError, match="returned str, not a Report"):
        body_maker("still")(fleet, 1, line).report()
    [mission] = import_missions("ours", tmp_path / "a.good")
    assert mission.tasks
    with pytest.raises(TeamformerError, match="'ours' of package 'eager-robots' returned some"):
        import_missions("ours", tmp_path / "a.bad")
    path, out = tmp_path / "record.json", tmp_path / "run.steps"
    record = run_trial(two_robots_one_task(), load_method("plan")).record
    save_record(record, path)
    assert export(path, [out]) == 0
    assert out.read_text() == str(record.end.makespan)
    with pytest.raises(TeamformerError) as caught:
        export(path, [tmp_path / "run.step"])
    assert ".steps of package eager-robots" in caught.value.hint


def test_an_installation_that_is_older_than_its_code_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(entry_points, "OURS", "renamed")
    brought.cache_clear()
    with pytest.raises(TeamformerError, match="names no method of its own") as caught:
        find_brought("method", "plan")
    assert caught.value.hint.startswith("install it again: ")
    assert caught.value.hint.endswith(" install -e '.'")


def test_entry_points_are_read_once(monkeypatch: pytest.MonkeyPatch) -> None:
    before = names_of("method")
    monkeypatch.delattr(entry_points, "entry_points")
    assert names_of("method") == before


def test_a_method_of_a_package_enters_the_table_of_methods_without_search(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "learned"
    chosen = ("--settings", "warehouse-half", "--methods", "join-all,eager", "--trials", "2")
    assert teamformer("bench", "learned", *chosen, "--workers", "1", "--out", str(out)) == 0
    assert "eager" in capsys.readouterr().out
    rows = [json.loads(line) for line in (out / "rows.jsonl").read_text().splitlines()]
    assert {(row["method"], row["world_seed"]) for row in rows} == {
        (method, seed) for method in ("join-all", "eager") for seed in (0, 1)
    }
    steps = {(row["method"], row["world_seed"]): row["steps"] for row in rows}
    for seed in (0, 1):  # whom it meets it joins, as join-all does
        assert steps["eager", seed] == steps["join-all", seed]
    assert "| warehouse-half | eager | 2 |" in (out / "report.md").read_text()
