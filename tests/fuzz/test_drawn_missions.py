"""What is drawn: good files, with every key that there is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hypothesis import given, settings

from missions import missions, optional_missions
from teamformer.files.mission_files import mission_from_tree
from teamformer.mission.keys.mission_keys import ARRIVALS_KEYS, MISSION_KEYS
from teamformer.mission.keys.robot_keys import BREAKS_KEYS, DELAYS_KEYS, ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.keys.world_keys import FORMS

IN_ANOTHER_FILE = {"world map", "world cell"}
"""Keys that `test_files.py` writes."""

OF_BATTERIES = {"robot battery", "file chargers"}
"""Keys of the missions of `charging_missions.py`."""


def keys_of(tree: dict[str, Any]) -> Iterator[str]:
    """Return what stands in a file, and under what."""
    groups = {"file": [tree], "world": [tree["world"]]}
    groups |= {
        "robot": tree["robots"],
        "task": tree["tasks"],
        "arrivals": [tree.get("arrivals", {})],
    }
    for key in ("breaks", "delays"):
        parts = (robot.get(key) for robot in tree["robots"])
        groups[key] = [part for part in parts if isinstance(part, dict)]
    return (f"{group} {key}" for group, parts in groups.items() for part in parts for key in part)


def test_every_key_of_the_format_is_drawn() -> None:
    drawn: set[str] = set()

    @settings(max_examples=250, derandomize=True, database=None)
    @given(mission=missions(), continuous=optional_missions())
    def look(mission: Any, continuous: Any) -> None:
        for tree in (mission, continuous):
            mission_from_tree(tree)
            drawn.update(keys_of(tree))

    look()
    of_worlds = (key for form in FORMS.values() for key in form)
    known = {"file": MISSION_KEYS, "world": of_worlds, "robot": ROBOT_KEYS, "task": TASK_KEYS}
    known |= {"arrivals": ARRIVALS_KEYS, "breaks": BREAKS_KEYS, "delays": DELAYS_KEYS}
    expected = {f"{group} {key.name}" for group, keys in known.items() for key in keys}
    assert drawn == expected - IN_ANOTHER_FILE - OF_BATTERIES
