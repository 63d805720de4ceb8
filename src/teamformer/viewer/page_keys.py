"""What pages know of the keys of robots and tasks: what their details show, the editor's fields."""

from __future__ import annotations

import json
from typing import Any

from teamformer.mission.keys import kinds
from teamformer.mission.keys.key import Key
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS


def keys_script() -> str:
    """Return the script that has the keys with a label, by the list that has the things."""
    tables = {"robots": ROBOT_KEYS, "tasks": TASK_KEYS}
    trees = {name: [_tree(key) for key in keys if key.label] for name, keys in tables.items()}
    return f"const FILE_KEYS = {json.dumps(trees, ensure_ascii=True)};\n"


def _tree(key: Key) -> dict[str, Any]:
    about = {"name": key.name, "label": key.label, "help": key.in_words.replace("`", "")}
    return about | {"field": _field(key.kind), "isInDetails": key.is_in_details}


def _field(kind: kinds.Kind) -> str:
    """Return what the editor has a key written in."""
    match kind:
        case kinds.Text():
            return "text"
        case kinds.Moments():
            return "steps"
        case kinds.Moves():
            return "flight"
    return "number"
