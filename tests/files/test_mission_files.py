"""Mission files that are right: every key, every form, and there and back again."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path

import numpy as np
import pytest

from random_worlds import random_world, with_fractions
from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.generate import Spec, generate
from teamformer.files.mission_files import (
    mission_from_tree,
    mission_to_tree,
    read_mission,
    write_mission,
)
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.mission.parts.frame import Frame
from teamformer.mission.parts.grid import Grid

EVERY_KEY = """\
teamformer: 1
name: night shift
world: {grid: [8, 6], y_axis: down}
capabilities: [lift, scan, 'no']
robots:
  - {name: r1, at: [2, 3], can: [lift, scan]}
  - {at: [2, 3], can: {'no': 2}, speed: 0.5, lost: 40}
tasks:
  - {name: crate, at: [7, 5], needs: {lift: 1, 'no': 2}, duration: 4, appears: 30}
  - at: [0, 0]
    needs:
      - scan
teams: [[r1, r2]]
sensing_radius: .inf
join_radius: 1.5
forming_steps: 0
step_limit: 77
"""

AS_BUILT = Mission(
    name="night shift",
    world=Grid(8, 6, y_axis="down"),
    capabilities=("lift", "scan", "no"),
    robots=(
        Robot("r1", (2, 3), {"lift": 1, "scan": 1}),
        Robot("r2", (2, 3), {"no": 2}, speed=0.5, absences=(Absence(40),)),
    ),
    tasks=(
        Task("crate", (7, 5), {"lift": 1, "no": 2}, duration=4, appears=30),
        Task("t2", (0, 0), {"scan": 1}),
    ),
    teams=((0, 1),),
    sensing_radius=math.inf,
    join_radius=1.5,
    forming_steps=0,
    step_limit=77,
)

SMALL = """\
teamformer: 1
world: %s
capabilities: [lift]
robots: [{at: [0, 0], can: [lift]}]
tasks: [{at: [1, 0], needs: [lift]}]
"""


def read(folder: Path, text: str, name: str = "case.yaml") -> Mission:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return read_mission(path)


def test_every_key_is_read(tmp_path: Path) -> None:
    assert read(tmp_path, EVERY_KEY) == AS_BUILT


def test_what_is_left_out_has_the_documented_value(tmp_path: Path) -> None:
    mission = read(tmp_path, SMALL % "{grid: [2, 1]}", "depot.yaml")
    assert mission.name == "depot"
    assert (mission.robots[0].name, mission.tasks[0].name) == ("r1", "t1")
    assert (mission.sensing_radius, mission.join_radius) == (1.0, 0.0)
    assert mission.forming_steps == 1
    assert mission.step_limit == 4 * 2 * (2 + 1 + 1)  # four walks of 2 + 1, one robot forms


@pytest.mark.parametrize(
    "rows",
    ['{rows: [".@", ".."]}', '{rows: [".#", ".."], y_axis: down}', "\n  rows: |\n    .#\n    .."],
)
def test_rows_begin_at_y_0(tmp_path: Path, rows: str) -> None:
    text = (SMALL % rows).replace("at: [1, 0]", "at: [1, 1]")
    assert read(tmp_path, text).world == Grid(2, 2, (".@", ".."), "down")


def test_y_axis_only_turns_the_drawing(tmp_path: Path) -> None:
    world = read(tmp_path, SMALL % '{rows: ["..", "@@"], y_axis: up}').world
    assert world == Grid(2, 2, ("..", "@@"), "up")
    assert not world.is_free((0, 1))


def test_a_map_is_looked_for_beside_the_mission(tmp_path: Path) -> None:
    (tmp_path / "maps").mkdir()
    text = "type octile\nheight 1\nwidth 3\nmap\n..T\n"
    (tmp_path / "maps" / "yard.map").write_text(text, encoding="utf-8")
    assert read(tmp_path, SMALL % "{map: maps/yard.map}").world == Grid(3, 1, ("..@",), "down")


def test_a_ros_map_is_read_in_cells_of_the_wanted_size(tmp_path: Path) -> None:
    (tmp_path / "floor.yaml").write_text(
        "image: floor.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
        encoding="utf-8",
    )
    (tmp_path / "floor.pgm").write_text("P2 4 2 255\n255 255 255 255\n255 255 255 0\n")
    text = SMALL % "{map: floor.yaml, cell: 0.1}"
    with pytest.raises(TeamformerError, match=r"task 't1' is at \[1, 0\], inside an obstacle"):
        read(tmp_path, text)
    text = text.replace("at: [1, 0]", "at: [0, 0]")
    assert read(tmp_path, text).world == Grid(2, 1, (".@",), "up", Frame(0.1))


def test_json_is_the_same_tree(tmp_path: Path) -> None:
    tree = mission_to_tree(AS_BUILT)
    for text in (json.dumps(tree), json.dumps(tree, indent="\t"), json.dumps(tree, indent=4)):
        assert read(tmp_path, text, "case.json") == AS_BUILT


def test_json_escapes_are_read(tmp_path: Path) -> None:
    name = 'robot \U0001f916 "x" \\ud83d \\/ \xe9'
    tree = {**mission_to_tree(AS_BUILT), "name": name}
    assert read(tmp_path, json.dumps(tree, ensure_ascii=True), "case.json").name == name


def test_the_tree_is_plain_json() -> None:
    tree = mission_to_tree(AS_BUILT)
    assert tree["sensing_radius"] == ".inf"  # JSON has no infinity
    assert tree["robots"][0] == {"name": "r1", "at": [2, 3], "can": ["lift", "scan"]}
    assert tree["tasks"][0]["needs"] == {"lift": 1, "no": 2}
    assert tree["teams"] == [["r1", "r2"]]
    assert json.loads(json.dumps(tree, allow_nan=False)) == tree


def test_the_tree_holds_the_map_itself() -> None:
    grid = Grid(3, 2, ("..@", "..."), "up")
    robot, task = Robot("r", (0, 0), {"a": 1}), Task("t", (1, 1), {"a": 1})
    tree = mission_to_tree(Mission("m", grid, ("a",), (robot,), (task,)))
    assert tree["world"] == {"rows": ["..@", "..."], "y_axis": "up"}


def test_a_written_file_has_a_line_for_each_robot_and_task(tmp_path: Path) -> None:
    path = tmp_path / "out.yaml"
    write_mission(AS_BUILT, path)
    lines = path.read_text(encoding="utf-8").splitlines()
    assert "  - {name: r1, at: [2, 3], can: [lift, scan]}" in lines
    assert '  - {name: r2, at: [2, 3], can: {"no": 2}, speed: 0.5, lost: 40}' in lines
    assert "sensing_radius: .inf" in lines


@pytest.mark.parametrize("suffix", [".yaml", ".json"])
def test_random_missions_come_back_from_files(tmp_path: Path, suffix: str) -> None:
    rng = np.random.default_rng(5)
    path = tmp_path / f"there{suffix}"
    for number in range(60):
        mission = random_world(rng)
        mission = with_fractions(mission, rng) if number % 2 else mission
        write_mission(mission, path)
        assert read_mission(path) == mission
        tree = json.loads(json.dumps(mission_to_tree(mission)))
        assert mission_from_tree(tree, "record.json") == mission


AWKWARD = [
    "no",
    "12:30",
    "1e3",
    "007",
    "~",
    "a: b",
    "#1",
    "x ",
    "- y",
    "[z]",
    "'",
    '"',
    "\\",
    "\xe9",
    "=",
    "2026-01-01",
    ".inf",
    "<<",
    "null",
    "*a",
    "&a",
    "!t",
    "%",
    "@",
    "\U0001f916",
    "?",
]


@pytest.mark.parametrize("suffix", [".yaml", ".json"])
@pytest.mark.parametrize("name", AWKWARD)
def test_awkward_names_come_back(tmp_path: Path, name: str, suffix: str) -> None:
    mission = Mission(
        name,
        Grid(2, 2),
        (name,),
        (Robot(name, (0, 0), {name: 2}),),
        (Task(name, (1, 1), {name: 1}),),
    )
    path = tmp_path / f"there{suffix}"
    write_mission(mission, path)
    assert read_mission(path) == mission


def test_a_file_with_a_byte_order_mark_is_read(tmp_path: Path) -> None:
    path = tmp_path / "bom.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + EVERY_KEY.replace("\n", "\r\n").encode())
    assert read_mission(path) == AS_BUILT


def test_a_place_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(TeamformerError, match="cannot be written") as caught:
        write_mission(AS_BUILT, tmp_path / "no such folder" / "out.yaml")
    assert caught.value.hint


@pytest.mark.parametrize("suffix", [".yaml", ".json"])
def test_a_thousand_robots_are_read_at_once(tmp_path: Path, suffix: str) -> None:
    spec = Spec(1000, 1000, 20, world=Grid(200, 200))
    mission = generate(spec, np.random.default_rng(0))
    path = tmp_path / f"large{suffix}"
    write_mission(mission, path)
    begun = time.process_time()
    assert read_mission(path) == mission
    assert time.process_time() - begun < 1.5  # seconds; a tenth of it is usual with libyaml
