"""Reading values out of a tree: what is wrong is noted by place, and reading goes on."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from typing import Any

from teamformer.model import Place
from teamformer.scenarios.yaml_tree import Misread, Tree, Where, describe, misread

LARGEST_NUMBER = 1_000_000
"""Counts, coordinates and steps beyond this are slips of the keyboard."""


class Reader:
    """Checks values one by one and notes problems; a wrong value is replaced by a harmless one."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree

    def refuse(self, where: Where, message: str) -> None:
        """Note that something is wrong at a place."""
        self.tree.problems.append((self.tree.line(where), message))

    def mapping(self, where: Where, value: Any, keys: Mapping[str, bool]) -> dict[str, Any]:
        """Return a mapping with only the known keys; True marks a key that must be there."""
        what = _name(where)
        if not isinstance(value, dict):
            self.refuse(where, f"{what} is {describe(value)}; write a mapping of {_list(keys)}")
            return {}
        for key in value:
            if key not in keys:
                near = difflib.get_close_matches(str(key), list(keys), 1)
                hint = f"did you mean '{near[0]}'?" if near else f"known are {_list(keys)}"
                self.refuse((*where, key), f"{what} has no key '{key}'; {hint}")
        for key, is_required in keys.items():
            if is_required and key not in value:
                self.refuse(where, f"{what} lacks '{key}'; add it")
        return {key: part for key, part in value.items() if key in keys}

    def sequence(self, where: Where, value: Any) -> list[Any]:
        """Return a list."""
        if isinstance(value, list):
            return value
        self.refuse(where, f"{_name(where)} is {describe(value)}; write a list")
        return []

    def text(self, where: Where, value: Any) -> str:
        """Return a text that a person can read on one line."""
        if isinstance(value, str) and value.strip() and value.isprintable():
            return value
        if isinstance(value, str):
            self.refuse(where, f"{_name(where)} is empty or cannot be printed; write a name")
        elif isinstance(value, list | dict):
            self.refuse(where, f"{_name(where)} is {describe(value)}; write a name")
        elif isinstance(value, Misread):
            self.refuse(where, misread(value.text, value.kind))
        else:
            word = "" if value is None else str(value).lower()
            self.refuse(where, misread(word, describe(value)))
        return "?"

    def names(self, where: Where, value: Any) -> list[str]:
        """Return a list of texts."""
        parts = self.sequence(where, value)
        return [self.text((*where, number), part) for number, part in enumerate(parts)]

    def number(self, where: Where, value: Any, can_be_infinite: bool = False) -> float:
        """Return a number that is finite, or infinity where that has a meaning."""
        if isinstance(value, int | float) and not isinstance(value, bool):
            if abs(value) <= LARGEST_NUMBER or (can_be_infinite and value == math.inf):
                return float(value)
            self.refuse(where, f"{_name(where)} is {value}; write a number up to {LARGEST_NUMBER}")
        else:
            self.refuse(where, f"{_name(where)} is {describe(value)}; write a number")
        return 1.0

    def whole(self, where: Where, value: Any, least: int | None = None) -> int:
        """Return a whole number, at least as large as given."""
        if not isinstance(value, int | float) or isinstance(value, bool):
            self.refuse(where, f"{_name(where)} is {describe(value)}; write a whole number")
        elif value != value or value in (math.inf, -math.inf) or value != int(value):
            self.refuse(where, f"{_name(where)} is {value}; write a whole number")
        elif abs(value) > LARGEST_NUMBER:
            self.refuse(where, f"{_name(where)} is {value}; write a number up to {LARGEST_NUMBER}")
        elif least is not None and value < least:
            self.refuse(where, f"{_name(where)} is {value}; write {least} or more")
        else:
            return int(value)
        return 1 if least is None else max(least, 1)

    def place(self, where: Where, value: Any) -> Place:
        """Return a cell, `[x, y]`."""
        if not isinstance(value, list) or len(value) != 2:
            self.refuse(where, f"{_name(where)} is {describe(value)}; write a cell as [x, y]")
            return (0, 0)
        x, y = (self.whole((*where, axis), part) for axis, part in enumerate(value))
        return (x, y)

    def counts(self, where: Where, value: Any) -> dict[str, int]:
        """Return capability counts: a list of names, once each, or a mapping to counts."""
        if isinstance(value, dict):
            return {
                self.text((*where, name), name): self.whole((*where, name), count)
                for name, count in value.items()
            }
        if not isinstance(value, list):
            what = f"{_name(where)} is {describe(value)}"
            self.refuse(where, f"{what}; write a list of capabilities or a mapping to counts")
            return {"?": 1}
        counts: dict[str, int] = {}
        for number, name in enumerate(self.names(where, value)):
            if name in counts and name != "?":
                self.refuse(
                    (*where, number),
                    f"'{name}' stands twice in this list; to ask for two write {{{name}: 2}}",
                )
            counts[name] = 1
        return counts


def _name(where: Where) -> str:
    """Name a place for people: `at of robot 3`."""
    if not where:
        return "the file"
    if isinstance(where[-1], int):
        around = str(where[-2]) if len(where) > 1 else "entry"
        return f"{around.removesuffix('s')} {where[-1] + 1}"
    if len(where) >= 2:
        return f"{where[-1]} of {_name(where[:-1])}"
    return str(where[-1])


def _list(keys: Mapping[str, bool]) -> str:
    return ", ".join(keys)
