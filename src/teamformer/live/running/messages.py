"""What pages say to a live mission: one JSON object a message, checked before anything is done."""

from __future__ import annotations

import json
from base64 import b64decode
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.files.mission_files import mission_from_tree, mission_to_tree
from teamformer.live.running.incidents import (
    CancelledTask,
    Incident,
    LostRobot,
    NewTask,
    NewWeight,
    RobotBack,
    free_name,
)
from teamformer.mission.keys.task_keys import LARGEST_WEIGHT, SMALLEST_WEIGHT
from teamformer.mission.model import Mission

LARGEST = 4_000_000  # bytes of a message
COMMANDS = (
    *("play", "pause", "step", "speed", "happen", "what_if", "replan", "take_over", "save"),
    *("stop", "undo", "restart", "edit", "acknowledge"),
    *("check", "open", "new", "run"),
)
SLOWEST, FASTEST = 0.1, 1000.0  # steps a second
LEAST_RATE, HIGHEST_RATE = 1e-6, 1e6  # units of time a second
LONGEST_SEARCH = 120.0  # seconds

WITH_A_NAME: Mapping[str, Callable[[str], Incident]] = {
    "lost": LostRobot,
    "back": RobotBack,
    "cancelled": CancelledTask,
}
"""The incidents whose message holds the name of a robot or a task."""

Message = Mapping[str, Any]


def read_message(text: str) -> Message:
    """Return a message; TeamformerError says what is wrong with it."""
    if len(text) > LARGEST:
        raise TeamformerError(f"the message is larger than {LARGEST // 1_000_000} MB")
    try:
        message = json.loads(text)
    except (ValueError, RecursionError):
        raise TeamformerError("the message is no JSON") from None
    if not isinstance(message, dict) or message.get("do") not in COMMANDS:
        raise TeamformerError(f"the message has no 'do' that is one of {', '.join(COMMANDS)}")
    return message


def read_speed(message: Message, time: str) -> float:
    """Return the steps a second that a message asks for, in continuous time the units."""
    bounds = (SLOWEST, FASTEST) if time == "steps" else (LEAST_RATE, HIGHEST_RATE)
    return _read_number(message, "speed", *bounds)


def read_search(message: Message) -> float:
    """Return for how many seconds a message wants a plan to be searched for."""
    return _read_number({"seconds": 10} | dict(message), "seconds", 0.0, LONGEST_SEARCH)


def _read_number(message: Message, key: str, least: float, most: float) -> float:
    number = message.get(key)
    if isinstance(number, int | float) and not isinstance(number, bool) and least <= number <= most:
        return float(number)
    raise TeamformerError(f"{key} must be a number from {least:g} to {most:g}")


def read_files(message: Message) -> dict[str, bytes]:
    """Return the files that a message brings besides its own, `{"beside": {NAME: BASE64}}`."""
    beside = message.get("beside", {})
    try:
        return {
            str(Path(name).name): b64decode(text, validate=True) for name, text in beside.items()
        }
    except (AttributeError, TypeError, ValueError):
        raise TeamformerError("'beside' must hold files by name, in base64") from None


class TaskRefusedError(TeamformerError):
    """A new task is wrong; `keys` are the parts of it that are, as in a file."""

    def __init__(self, message: str, keys: Sequence[str]) -> None:
        super().__init__(message)
        self.keys = tuple(keys)


def read_incident(message: Message, mission: Mission) -> Incident:
    """Return the incident of a message: `{"lost": NAME}`, `{"back": NAME}`, `{"cancelled": NAME}`,
    `{"weighs": NAME, "weight": NUMBER}` or `{"task": TREE}`.

    A task is written as in a file, with any of its keys but `appears`, as it appears now; without a
    name it gets one that is free.
    """
    for key, incident in WITH_A_NAME.items():
        if isinstance(message.get(key), str):
            return incident(message[key])
    if isinstance(message.get("weighs"), str):
        weight = _read_number(message, "weight", SMALLEST_WEIGHT, LARGEST_WEIGHT)
        return NewWeight(message["weighs"], weight)
    if not isinstance(message.get("task"), dict):
        names = ", ".join(f"'{key}'" for key in (*WITH_A_NAME, "weighs"))
        raise TeamformerError(f"an incident needs {names}: a name, or 'task': a mapping")
    if "appears" in message["task"]:
        raise TaskRefusedError("a new task appears now; leave 'appears' out", ("appears",))
    task_tree = {"name": free_name(mission)} | message["task"]
    tree = mission_to_tree(mission)
    try:
        task = mission_from_tree(tree | {"tasks": [*tree["tasks"], task_tree]}).tasks[-1]
    except MissionError as error:
        text = "; ".join(problem.message for problem in error.problems)
        keys = dict.fromkeys(str(key) for it in error.problems for key in it.where[2:3])
        raise TaskRefusedError(text, tuple(keys)) from None
    return NewTask(task)
