"""Zones in mission files: read, written, refused; and which tasks are in them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import (
    mission_from_tree,
    mission_to_tree,
    read_mission,
    write_mission,
)
from teamformer.mission.checks.rules import rules_not_planned, rules_not_played, rules_not_run
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.zones import Zone

MISSION = Mission(
    "mission",
    Grid(9, 9),
    ("a",),
    (Robot("p", (0, 0), {"a": 1}),),
    (Task("x", (1, 1), {"a": 1}), Task("y", (4, 5), {"a": 1}), Task("z", (4, 6), {"a": 1})),
    time="continuous",
    zones=(
        Zone("dock", area=((1, 1), (4, 5)), room=2),
        Zone("gate", tasks=("x", "z")),
        Zone("door", places=((4, 6),)),
    ),
)


@pytest.mark.parametrize("name", ["mission.yaml", "mission.json"])
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    write_mission(MISSION, tmp_path / name)
    assert read_mission(tmp_path / name) == MISSION


def test_tasks_are_in_a_zone_by_area_by_name_or_by_place() -> None:
    assert [zone.tasks_in(MISSION.tasks) for zone in MISSION.zones] == [[0, 1], [0, 2], [2]]


def test_on_roads_places_have_names() -> None:
    tree = mission_to_tree(MISSION) | {
        "world": {"roads": "from, dock, bay\ndock, 0, 4\nbay, 5, 0\n"},
        "robots": [{"at": "dock", "can": ["a"]}],
        "tasks": [{"at": "bay", "needs": ["a"]}],
        "zones": {"door": {"places": ["bay"], "room": 3}},
    }
    mission = mission_from_tree(tree)
    assert isinstance(mission.world, Roads)
    assert mission.zones == (Zone("door", places=(mission.world.at("bay"),), room=3),)
    assert mission_to_tree(mission)["zones"] == {"door": {"places": ["bay"], "room": 3}}
    with pytest.raises(MissionError, match="on roads there is none; name places"):
        replace(mission, zones=(Zone("door", area=((0, 0), (1, 0))),))


@pytest.mark.parametrize(
    ("zone", "where", "told"),
    [
        ({}, (), "zone 'n' holds nothing; write area, tasks or places"),
        ({"tasks": ("w",)}, ("tasks", 0), "zone 'n' holds 'w', which is no task; name one"),
        ({"tasks": ("x",), "places": ((1, 1),)}, ("places",), "has tasks and places; keep one"),
        ({"tasks": ("x",), "room": 0}, ("room",), "zone 'n' has room for 0 services; use 1 to"),
        ({"area": ((7, 7), (8, 8))}, ("area",), "no task is in zone 'n'; move it, or drop it"),
        ({"area": ((1, 1),)}, ("area",), "has 1 corners; write two, [[x, y], [x, y]]"),
        ({"area": ((4, 1), (1, 5))}, ("area",), "goes from [4, 1] to [1, 5]; write the smaller"),
        ({"places": ((9, 1),)}, ("places", 0), "zone 'n' has a place at [9, 1], outside the map"),
    ],
)
def test_zones_are_refused_with_their_place(
    zone: dict[str, Any], where: tuple[str | int, ...], told: str
) -> None:
    with pytest.raises(MissionError) as refused:
        replace(MISSION, zones=(Zone("n", **zone),))
    problem = refused.value.problems[0]
    assert problem.where == ("zones", "n", *where)
    assert told in problem.message


def test_what_is_no_mapping_of_zones_is_refused() -> None:
    for wrong in ([], {}, "dock", {"dock": 3}, {"dock": {"places": []}}):
        with pytest.raises(MissionError):
            mission_from_tree(mission_to_tree(MISSION) | {"zones": wrong})


def test_nobody_keeps_to_zones_yet() -> None:
    told = "missions with zones are checked, but not run yet; drop zones"
    for rules in (rules_not_run, rules_not_planned):
        assert [problem.message for problem in rules(MISSION)] == [told]
    [problem] = rules_not_played(replace(MISSION, time="steps"))
    assert problem.message == "zones are for continuous time; write time: continuous"
