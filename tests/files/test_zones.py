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
from teamformer.mission.checks.rules import (
    rules_not_played,
    rules_not_run,
    rules_of_fleets,
    rules_of_rehearsals,
)
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.roads import Roads
from teamformer.mission.parts.zones import AtWork, Zone, ZoneRoom, may_enter, may_unload, rooms_of

MISSION = Mission(
    "mission",
    Grid(9, 9),
    ("a",),
    (Robot("p", (0, 0), {"a": 1}),),
    (Task("x", (1, 1), {"a": 1}), Task("y", (4, 5), {"a": 1}), Task("z", (4, 6), {"a": 1})),
    time="continuous",
    zones=(
        Zone("dock", area=((1, 1), (4, 5)), room=2),
        Zone("door", places=((4, 6),)),
        Zone("gate", tasks=("x", "z")),
    ),
)


@pytest.mark.parametrize("name", ["mission.yaml", "mission.json"])
def test_what_is_written_is_read(name: str, tmp_path: Path) -> None:
    write_mission(MISSION, tmp_path / name)
    assert read_mission(tmp_path / name) == MISSION


def test_tasks_are_in_a_zone_by_area_by_name_or_by_place() -> None:
    assert [zone.tasks_in(MISSION.tasks) for zone in MISSION.zones] == [[0, 1], [2], [0, 2]]


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
        ({"area": ((1, 1),)}, ("area",), "has one corner; write two, [[x, y], [x, y]]"),
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


@pytest.mark.parametrize(
    ("room", "gap", "duration", "told"),
    [
        (1, (0, 0), 1, "'n' has room for 1, and by their links 'x', 'z' go on at once; give it"),
        (1, (0, 3), 4, "by their links 'x', 'z' go on at once"),
        (1, (0, 4), 4, ""),  # the second may begin when the first has ended
        (2, (0, 0), 1, ""),
    ],
)
def test_linked_tasks_that_go_on_at_once_need_room(
    room: int, gap: tuple[float, float], duration: float, told: str
) -> None:
    first, other, last = MISSION.tasks
    tasks = replace(first, duration=duration), other, replace(last, starts={"x": gap}, duration=1)
    robots = MISSION.robots[0], replace(MISSION.robots[0], name="q")
    changed = {"robots": robots, "tasks": tasks}
    zones = (Zone("n", tasks=("x", "y", "z"), room=room),)
    if not told:
        assert replace(MISSION, **changed, zones=zones).zones == zones
        return
    with pytest.raises(MissionError) as refused:
        replace(MISSION, **changed, zones=zones)
    [problem] = refused.value.problems
    assert problem.where == ("zones", "n", "room")
    assert told in problem.message


def test_only_zones_that_are_too_small_for_their_tasks_bind() -> None:
    assert rooms_of(MISSION) == [ZoneRoom(2, frozenset({0, 2}), 1)]


def test_a_task_enters_in_its_turn_and_where_there_is_room() -> None:
    rooms = [ZoneRoom(0, frozenset({1, 2, 3}), 2), ZoneRoom(1, frozenset({3, 4}), 1)]
    assert may_enter(rooms, (1, 2, 3, 4), AtWork(()), 1)
    assert not may_enter(rooms, (1, 2, 3, 4), AtWork(()), 2)  # after 1
    assert not may_enter(rooms, (3, 4), AtWork((1, 2)), 3)  # the first is full
    assert may_enter(rooms, (3, 4), AtWork((1,)), 3)
    assert not may_enter(rooms, (3,), AtWork((1, 4)), 3)  # the second is full
    assert may_enter(rooms, (5,), AtWork((1, 2, 4)), 5)  # in no zone


def test_loads_are_unloaded_where_there_is_room_and_before_others_begin() -> None:
    """Load 5 is taken up in the zone, 6 and 7 are brought there; it has room for one."""
    rooms = [ZoneRoom(0, frozenset({1, 5}), 1, frozenset({6, 7}))]
    assert may_unload(rooms, AtWork((), (), (6, 7)), 6)
    assert not may_unload(rooms, AtWork((), (), (6, 7)), 7)  # it has come later
    assert not may_unload(rooms, AtWork((5,), (), (6,)), 6)  # 5 is being taken up
    assert not may_unload(rooms, AtWork((), (7,), (6,)), 6)
    assert not may_enter(rooms, (1,), AtWork((), (), (6,)), 1)
    assert may_enter(rooms, (1,), AtWork((6, 7)), 1)  # which are taken up elsewhere
    assert may_unload(rooms, AtWork((), (), (5,)), 5)  # brought to no zone


def test_what_does_not_go_with_zones_is_refused() -> None:
    first, *others = MISSION.tasks
    by_name = replace(MISSION, zones=(Zone("gate", tasks=("z",)),))
    hidden = replace(first, within=2.0)
    loaded, far = replace(first, to=(8, 8)), replace(first, at=(7, 7), to=(8, 8))
    rest = "which does not go with zone '{}' yet; drop one of the two"
    cases = [
        (replace(MISSION, tasks=(loaded, *others)), "task 'x' has a load, ", "dock"),
        (replace(MISSION, tasks=(hidden, *others)), "", ""),
        (replace(by_name, tasks=(far, *others)), "", ""),
        (MISSION, "", ""),
    ]
    for mission, told, zone in cases:
        assert [*rules_not_run(mission)] == []
        messages = [problem.message for problem in rules_of_rehearsals(mission)]
        assert messages == ([told + rest.format(zone)] if told else [])
        assert [*rules_not_played(replace(mission, time="steps"))] == []


def test_fleets_take_zones_in_steps_and_in_continuous_time() -> None:
    for time in ("steps", "continuous"):
        mission = replace(MISSION, time=time)
        assert list(rules_of_fleets(mission)) == []
    assert [*rules_not_played(replace(MISSION, time="steps"))] == []
