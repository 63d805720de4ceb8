"""Batteries and chargers in mission files: read, written, refused with line and remedy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import read_mission, write_mission
from teamformer.mission.checks.rules import rules_not_played
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.regions import walks

FILE = """teamformer: 1
world: {plane: [40, 40]}
time: continuous
capabilities: [lift, scan]
chargers:
  - {at: [20, 20]}
  - {at: [2, 2], room: 2}
robots:
  - {name: a, at: [2, 2], can: [lift], battery: {lasts: 60, fills: 20, serving: 0.5}}
  - {name: b, at: [5, 6], can: [scan]}
tasks:
  - {name: x, at: [32, 36], needs: [lift, scan], duration: 4}
"""


def mission_of(folder: Path, *changes: tuple[str, str]) -> Path:
    text = FILE
    for old, new in changes:
        assert text.count(old) == 1
        text = text.replace(old, new)
    path = folder / "mission.yaml"
    path.write_text(text)
    return path


def told(folder: Path, *changes: tuple[str, str]) -> list[str]:
    with pytest.raises(MissionError) as error:
        read_mission(mission_of(folder, *changes))
    return [line.partition("mission.yaml:")[2] for line in str(error.value).splitlines()]


@pytest.mark.parametrize("name", ["written.yaml", "written.json"])
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    mission = read_mission(mission_of(tmp_path))
    assert mission.robots[0].battery == Battery(60, 20, serving=0.5)
    assert mission.robots[1].battery is None
    assert mission.chargers == (Charger((20, 20)), Charger((2, 2), 2))
    write_mission(mission, tmp_path / name)
    assert read_mission(tmp_path / name) == replace(mission, name=mission.name)


def test_mistakes_are_told_all_at_once_each_with_its_line(tmp_path: Path) -> None:
    changes = (
        ("lasts: 60, fills: 20, serving: 0.5", "lasts: 0, fills: -1, starts: 2, serving: 1001"),
        ("{at: [20, 20]}", "{at: [20, 50], room: 0}"),
    )
    assert told(tmp_path, *changes) == [
        "6: charger 1 is at [20.0, 50.0], outside the map; x goes from 0 to 40.0 and y from 0 to "
        "40.0",
        "6: charger 1 has room for 0 robots; use 1 to 1000",
        "9: the battery of robot 'a' lasts 0; use more than 0, to 1e9",
        "9: the battery of robot 'a' fills in -1; use 0 to 1e9",
        "9: the battery of robot 'a' starts with 2 of what it holds; use 0 to 1",
        "9: the battery of robot 'a' spends 1001 on serving; use 0 to 1000",
    ]


def test_a_battery_needs_a_charger(tmp_path: Path) -> None:
    lines = "chargers:\n  - {at: [20, 20]}\n  - {at: [2, 2], room: 2}\n"
    message = "robot 'a' has a battery, but there is no charger; add chargers, or drop it"
    assert told(tmp_path, (lines, "")) == [f"6: {message}"]


# From the charger at [20, 20] it is 20 to the task and 20 back, and the task takes 4 x 0.5.


def test_a_task_that_is_just_near_enough_to_a_charger_is_good(tmp_path: Path) -> None:
    charging = read_mission(mission_of(tmp_path, ("lasts: 60", "lasts: 42"))).charging
    assert charging is not None
    assert charging.able((0, 1), 0) == [0, 1]


def test_a_task_that_is_too_far_from_chargers_is_refused(tmp_path: Path) -> None:
    assert told(tmp_path, ("lasts: 60", "lasts: 41.9")) == [
        "12: task 'x' is too far from chargers for full batteries of robots that bring lift; put a "
        "charger nearer, or give batteries that last longer"
    ]


def test_a_robot_that_gets_to_no_charger_is_refused(tmp_path: Path) -> None:
    changes = (("name: a, at: [2, 2]", "name: a, at: [2, 5]"), ("serving: 0.5", "starts: 0.049"))
    assert told(tmp_path, *changes)[0] == (
        "9: robot 'a' gets to no charger with what its battery starts with; put one nearer, or let "
        "it start with more"
    )
    read_mission(mission_of(tmp_path, changes[0], ("serving: 0.5", "starts: 0.05")))


def test_a_robot_that_cannot_get_home_is_refused(tmp_path: Path) -> None:
    ends = ("time: continuous", "time: continuous\nends: [40, 0]")
    near = ("[32, 36]", "[22, 22]")
    assert told(tmp_path, ends, near, ("lasts: 60", "lasts: 28.28")) == [
        "10: robot 'a' does not get from a charger to where the mission ends; put a charger "
        "nearer, or give batteries that last longer"
    ]
    read_mission(mission_of(tmp_path, ends, near, ("lasts: 60", "lasts: 28.29")))


def test_linked_tasks_want_as_many_robots_that_get_away_from_there(tmp_path: Path) -> None:
    """Both `a` and `c` lift, but only one of them is able for either task."""
    robot = "{name: b, at: [5, 6], can: [scan]}"
    other = "{name: c, at: [2, 2], can: [lift], battery: {lasts: 38, fills: 20}}"
    task = "needs: [lift, scan], duration: 4}"
    linked = f"{task}\n  - {{name: y, at: [32, 35], needs: [lift], starts: {{x: [0, 0]}}}}"
    changes = ((robot, f"{robot}\n  - {other}"), (task, linked))
    assert told(tmp_path, *changes) == [
        "14: 'x', 'y' are done by different robots, and too few get to a charger from there; put "
        "a charger nearer, or give batteries that last longer, or drop a link"
    ]
    read_mission(mission_of(tmp_path, *changes, ("lasts: 38", "lasts: 39")))


STEPS = ("time: continuous", "time: steps")


def test_in_steps_all_robots_with_batteries_are_able_for_all_tasks(tmp_path: Path) -> None:
    """At half a metre a step it is 40 there and 40 back to robot a, and the task takes 2.

    Nobody needs robot b for it, but it may be of the team.
    """
    half = ("name: a, at: [2, 2]", "name: a, speed: 0.5, at: [2, 2]")
    mission = read_mission(mission_of(tmp_path, STEPS, ("lasts: 60", "lasts: 42")))
    assert list(rules_not_played(mission)) == []
    told_of = (
        "12: task 'x' is too far from chargers for a full battery of robot 'a'; in steps teams "
        "walk as one, so put a charger nearer, or give batteries that last longer"
    )
    assert told(tmp_path, STEPS, half) == [told_of]
    read_mission(mission_of(tmp_path, STEPS, half, ("lasts: 60", "lasts: 82")))
    both = ("can: [scan]", "can: [scan], battery: {lasts: 30, fills: 1}")
    assert told(tmp_path, STEPS, both) == [told_of.replace("'a'", "'b'")]


def test_in_steps_who_flies_over_walls_has_no_battery(tmp_path: Path) -> None:
    changes = (
        STEPS,
        ("world: {plane: [40, 40]}", 'world: {rows: [".....", ".@...", "....."]}'),
        ("{at: [20, 20]}", "{at: [4, 2]}"),
        ("at: [5, 6]", "at: [0, 0]"),
        ("at: [32, 36]", "at: [4, 0]"),
        ("can: [lift],", "can: [lift], moves: air,"),
    )
    assert told(tmp_path, *changes) == [
        "9: robot 'a' flies over obstacles with a battery; in steps only who walks may have one; "
        "drop the battery, or moves"
    ]


def test_walks_go_round_walls() -> None:
    rows = ("..@.", "..@.", "....", "@@@@", "....")
    assert walks(rows, ".", (0, 0), [(0, 0), (3, 0), (1, 2), (0, 4)]) == [0, 7, 3, float("inf")]
