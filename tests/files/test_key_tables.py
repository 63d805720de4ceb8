"""The tables of keys and the dataclasses of the model say the same."""

from __future__ import annotations

import re
from dataclasses import MISSING, Field, fields
from typing import Any

import pytest

from teamformer.base.errors import MissionError
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.mission.keys import robot_keys, task_keys
from teamformer.mission.keys.charging_keys import BATTERY_KEYS, CHARGER_KEYS
from teamformer.mission.keys.key import Key
from teamformer.mission.keys.mission_keys import ARRIVALS_KEYS, MISSION_KEYS
from teamformer.mission.keys.robot_keys import BREAKS_KEYS, DELAYS_KEYS, ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.keys.world_keys import PLANE_KEYS
from teamformer.mission.keys.zone_keys import ZONE_KEYS
from teamformer.mission.model import Arrivals, Breakdown, Delays, Mission, Robot, Task
from teamformer.mission.parts.charging import Battery, Charger
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.zones import Zone

TABLES: dict[type[Any], tuple[tuple[Key, ...], dict[str, str]]] = {
    Robot: (ROBOT_KEYS, robot_keys.NOT_ALIKE),
    Task: (TASK_KEYS, task_keys.NOT_ALIKE),
    Mission: (MISSION_KEYS, {"teamformer": "the version of the format"}),
    Arrivals: (ARRIVALS_KEYS, {}),
    Battery: (BATTERY_KEYS, {}),
    Breakdown: (BREAKS_KEYS, {}),
    Charger: (CHARGER_KEYS, {}),
    Delays: (DELAYS_KEYS, {}),
    Zone: (
        ZONE_KEYS,
        {"name": "it stands before the keys", "loads": "only what is left of a mission names them"},
    ),
    Plane: (PLANE_KEYS, dict.fromkeys(("plane", "width", "height"), "plane has both sides")),
}


def default_of(field: Field[Any]) -> object:
    return field.default if field.default_factory is MISSING else field.default_factory()


@pytest.mark.parametrize("made", TABLES, ids=lambda made: made.__name__)
def test_every_field_of_the_model_has_its_key_or_a_reason(made: type[Any]) -> None:
    keys, not_alike = TABLES[made]
    held = {field.name for field in fields(made)}
    assert held ^ {key.field for key in keys} == set(not_alike)
    assert all(not_alike.values())


@pytest.mark.parametrize("made", TABLES, ids=lambda made: made.__name__)
def test_defaults_of_keys_are_those_of_the_model(made: type[Any]) -> None:
    keys, _ = TABLES[made]
    by_name = {field.name: default_of(field) for field in fields(made)}
    for key in keys:
        if key.field in by_name and not key.is_required and key.name != "name":
            assert key.default == by_name[key.field], key.name


@pytest.mark.parametrize("keys", [keys for keys, _ in TABLES.values()])
def test_a_key_says_what_holds_without_it(keys: tuple[Key, ...]) -> None:
    for key in keys:
        is_said = key.is_required or key.without or isinstance(key.default, int | float | str)
        assert is_said, key.name
        assert key.means, key.name
        assert not key.means.endswith("."), key.name


MISSION: dict[str, Any] = {
    "teamformer": 1,
    "world": {"grid": [4, 3]},
    "capabilities": ["lift"],
    "robots": [{"name": "a", "at": [0, 0], "can": ["lift"]}],
    "tasks": [{"name": "x", "at": [3, 2], "needs": ["lift"]}],
}


@pytest.mark.parametrize(
    ("thing", "key", "told"),
    [
        ("robots", "at", "at of robot 1 is nothing; write a cell as [x, y]"),
        ("tasks", "at", "at of task 1 is nothing; write a cell as [x, y]"),
        ("tasks", "to", "to of task 1 is nothing; write a cell as [x, y]"),
        ("robots", "delays", "delays of robot 1 is nothing; write a number"),
    ],
)
def test_a_key_without_a_value_is_refused(thing: str, key: str, told: str) -> None:
    [was] = MISSION[thing]
    with pytest.raises(MissionError, match=f"^mission: {re.escape(told)}$"):
        mission_from_tree(MISSION | {thing: [was | {key: None}]})


def test_notes_are_read_and_written() -> None:
    [robot], [task] = MISSION["robots"], MISSION["tasks"]
    noted = {"robots": [robot | {"note": "leaks oil"}], "tasks": [task | {"note": "door 3"}]}
    mission = mission_from_tree(MISSION | noted)
    assert (mission.robots[0].note, mission.tasks[0].note) == ("leaks oil", "door 3")
    tree = mission_to_tree(mission)
    assert (tree["robots"][0]["note"], tree["tasks"][0]["note"]) == ("leaks oil", "door 3")
    assert "note" not in mission_to_tree(mission_from_tree(MISSION))["tasks"][0]
