"""The `tasks` of a mission file."""

from __future__ import annotations

from typing import Any

from teamformer.files.trees.pins import Pins
from teamformer.files.trees.values import Given, read_part
from teamformer.files.yaml.tree_reader import Reader
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.model import Task


def read_tasks(reader: Reader, value: Any, given: Given) -> tuple[list[Task], list[Pins]]:
    """Return the tasks and the pins of each; problems are noted in the reader."""
    tasks, pins = [], []
    for number, part in enumerate(reader.sequence(("tasks",), value)):
        said: dict[str, Any] = {"name": f"t{number + 1}"}
        said |= read_part(reader, ("tasks", number), part, TASK_KEYS, given)
        only, having = said.pop("only", ()), said.pop("with", ())
        pins.append(Pins(tuple(sorted(set(only))), tuple(sorted(set(having)))))
        if isinstance(said.get("duration"), tuple):  # what to expect follows from the range
            said["lasts"] = said.pop("duration")
        tasks.append(Task(**said))
    return tasks, pins
