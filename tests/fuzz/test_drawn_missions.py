"""What is drawn: good files, with every key that there is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from hypothesis import given, settings

from missions import continuous_missions, missions
from teamformer.scenarios.files import scenario_from_tree
from teamformer.scenarios.trees.mission import ARRIVALS_KEYS, TOP_KEYS
from teamformer.scenarios.trees.robots import BREAKS_KEYS, DELAYS_KEYS, ROBOT_KEYS
from teamformer.scenarios.trees.tasks import TASK_KEYS
from teamformer.scenarios.trees.world import KEYS as WORLD_KEYS

IN_ANOTHER_FILE = {"world map", "world cell"}
"""Keys that `test_files.py` writes."""


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

    @settings(max_examples=150, derandomize=True, database=None)
    @given(mission=missions(), continuous=continuous_missions())
    def look(mission: Any, continuous: Any) -> None:
        for tree in (mission, continuous):
            scenario_from_tree(tree)
            drawn.update(keys_of(tree))

    look()
    known = {"file": TOP_KEYS, "world": WORLD_KEYS, "robot": ROBOT_KEYS, "task": TASK_KEYS}
    known |= {"arrivals": ARRIVALS_KEYS, "breaks": BREAKS_KEYS, "delays": DELAYS_KEYS}
    expected = {f"{group} {key}" for group, keys in known.items() for key in keys}
    assert drawn == expected - IN_ANOTHER_FILE
