"""A mission's tree as YAML that people like to read: a line for each robot and each task."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from teamformer.base.whole_files import own_number
from teamformer.files.yaml.words import scalar
from teamformer.mission.keys.kinds import INFINITE

PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_-]*( [A-Za-z0-9_-]+)*")
"""Texts that never need quotes, but for the few that YAML takes for something else."""


def to_text(tree: Mapping[str, Any]) -> str:
    """Return the text of a file with this tree."""
    return "".join(f"{line}\n" for key, value in tree.items() for line in _lines(key, value))


def _lines(key: str, value: Any) -> Iterator[str]:
    if key == "world" and "rows" in value:
        yield "world:"
        for name, part in value.items():
            yield from (f"  {line}" for line in _lines(name, part))
    elif key == "world" and "roads" in value:
        yield "world:"
        tables = value["roads"]
        if isinstance(tables, str):
            yield from _block("  roads", tables)
        else:
            yield "  roads:"
            for mover, table in tables.items():
                yield from _block(f"    {_flow(mover)}", table)
    elif key in ("rows", "robots", "tasks", "teams") and value:
        yield f"{key}:"
        yield from (f"  - {_flow(part)}" for part in value)
    elif key.endswith("_radius") and value == INFINITE:
        yield f"{key}: {INFINITE}"
    else:
        yield f"{key}: {_flow(value)}"


def _block(key: str, text: str) -> Iterator[str]:
    """Return a text of lines as it is, farther in than its key."""
    yield f"{key}: |"
    margin = " " * (len(key) - len(key.lstrip()) + 2)
    yield from (margin + line for line in text.splitlines())


def _flow(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_flow(key)}: {_flow(part)}" for key, part in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(part) for part in value) + "]"
    if isinstance(value, str) and _is_plain(value):
        return value
    return json.dumps(value, ensure_ascii=False, default=own_number)


def _is_plain(text: str) -> bool:
    return bool(PLAIN.fullmatch(text)) and isinstance(scalar(text), str)
