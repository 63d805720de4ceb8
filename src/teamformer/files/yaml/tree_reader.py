"""Reading values out of a tree: what is wrong is noted by place, and reading goes on."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from typing import Any

from teamformer.files.yaml.reader import Tree, Where
from teamformer.files.yaml.words import Misread, describe, kind_of, misread, shorten
from teamformer.mission.checks.rules import counted_from
from teamformer.mission.keys.charging_keys import BATTERY_KEYS, CHARGER_KEYS
from teamformer.mission.keys.kinds import INFINITE, LARGEST_COUNT, LARGEST_NUMBER, LONGEST_TEXT
from teamformer.mission.keys.mission_keys import MISSION_KEYS
from teamformer.mission.keys.robot_keys import ROBOT_KEYS
from teamformer.mission.keys.task_keys import TASK_KEYS
from teamformer.mission.keys.zone_keys import ZONE_KEYS
from teamformer.mission.parts.capabilities import PLACES, exact, is_exact
from teamformer.mission.parts.grid import Place

TRUTHS = {"true": True, "false": False}

OWNERS = {
    "the file": MISSION_KEYS,
    "robots": ROBOT_KEYS,
    "tasks": TASK_KEYS,
    "batteries": BATTERY_KEYS,
    "chargers": CHARGER_KEYS,
    "zones": ZONE_KEYS,
}
"""Whose keys there are that somebody may have written elsewhere."""


class Reader:
    """Checks values one by one and notes problems; a wrong value is replaced by a harmless one.

    `is_faithful` tells whether everything that was read stands in the tree: it turns False when
    a value is replaced.
    """

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.is_faithful = True

    def refuse(self, where: Where, message: str) -> None:
        """Note that a value at a place is wrong and has to be replaced."""
        self.tree.refuse(where, message)
        self.is_faithful = False

    def mapping(self, where: Where, value: Any, keys: Mapping[str, bool]) -> dict[str, Any]:
        """Return a mapping with only the known keys; True marks a key that must be there."""
        what = name_of(where)
        if not isinstance(value, dict):
            self.refuse(where, f"{what} is {describe(value)}; write a mapping of {_list(keys)}")
            return {}
        for key in value:
            if key not in keys:
                self.tree.refuse((*where, key), f"{what} has no key {_suggest(key, keys)}")
        for key, is_required in keys.items():
            if is_required and key not in value:
                self.refuse(where, f"{what} lacks '{key}'; add it")
        return {key: part for key, part in value.items() if key in keys}

    def sequence(self, where: Where, value: Any) -> list[Any]:
        """Return a list."""
        if isinstance(value, list):
            return value
        self.refuse(where, f"{name_of(where)} is {describe(value)}; write a list")
        return []

    def text(self, where: Where, value: Any, longest: int = LONGEST_TEXT) -> str:
        """Return a text that a person can read on one line."""
        if not isinstance(value, str):
            return self._misread_text(where, value)
        if not value.strip() or not value.isprintable():
            self.refuse(where, f"{name_of(where)} is empty or cannot be printed; write a name")
        elif len(value) > longest:
            most = f"use {longest} letters at most"
            self.refuse(where, f"{name_of(where)} is {describe(value)}; {most}")
        else:
            return value
        return "?"

    def _misread_text(self, where: Where, value: Any) -> str:
        """Refuse what YAML took for something else, and go on with the word that was meant."""
        if value is None or isinstance(value, list | dict):
            self.refuse(where, f"{name_of(where)} is {kind_of(value)}; write a name")
            return "?"
        word = value.text if isinstance(value, Misread) else describe(value)
        self.tree.refuse(where, misread(word, kind_of(value), self.tree.language))
        return word

    def word(self, value: Any) -> str:
        """Return what stands where one of a few words belongs; the model says which they are."""
        text = value.text if isinstance(value, Misread) else value
        return shorten(text) if isinstance(text, str) else describe(text)

    def names(self, where: Where, value: Any, longest: int = LONGEST_TEXT) -> list[str]:
        """Return a list of texts."""
        parts = self.sequence(where, value)
        return [self.text((*where, number), part, longest) for number, part in enumerate(parts)]

    def number(self, where: Where, value: Any, can_be_infinite: bool = False) -> float:
        """Return a number that is finite, or infinity where that has a meaning."""
        if can_be_infinite and value in (math.inf, INFINITE):
            return math.inf
        if not _is_number(value):
            self.refuse(where, f"{name_of(where)} is {describe(value)}; write a number")
        elif not abs(value) <= LARGEST_NUMBER:  # nan too
            most = f"write a number up to {LARGEST_NUMBER:,}{counted_from(where)}"
            self.refuse(where, f"{name_of(where)} is {describe(value)}; {most}")
        else:
            return float(value)
        return 1.0

    def truth(self, where: Where, value: Any) -> bool:
        """Return true or false."""
        said = TRUTHS.get(value.text if isinstance(value, Misread) else str(value).lower())
        if said is None or isinstance(value, str):
            what = f"{name_of(where)} is {describe(value)}"
            self.refuse(where, f"{what}; write true or false")
        return bool(said)

    def whole(
        self, where: Where, value: Any, least: int | None = None, most: int = LARGEST_NUMBER
    ) -> int:
        """Return a whole number within bounds, both included."""
        what = f"{name_of(where)} is {describe(value)}"
        if not isinstance(value, int) or isinstance(value, bool):
            self.refuse(where, f"{what}; write a whole number")
        elif abs(value) > most:
            self.refuse(where, f"{what}; write a number up to {most:,}{counted_from(where)}")
        elif least is not None and value < least:
            self.refuse(where, f"{what}; write {least} or more")
        else:
            return value
        return 1 if least is None else max(least, 1)

    def place(self, where: Where, value: Any, is_point: bool = False) -> Place:
        """Return a cell or, in a plane, a point: `[x, y]`."""
        pair = self.pair(where, value, f"write a {'point' if is_point else 'cell'} as [x, y]")
        read = self.number if is_point else self.whole
        x, y = (read((*where, axis), part) for axis, part in enumerate(pair or [0, 0]))
        return (x, y)

    def pair(self, where: Where, value: Any, remedy: str) -> list[Any] | None:
        """Return a list of two; None after refusing anything else."""
        if isinstance(value, list) and len(value) == 2:
            return value
        self.refuse(where, f"{name_of(where)} {misshapen(value, 2)}; {remedy}")
        return None

    def count(self, where: Where, value: Any) -> float:
        """Return how much of a capability there is, a fraction or not."""
        if not _is_number(value):
            self.refuse(where, f"{name_of(where)} is {describe(value)}; write a number")
        elif not abs(value) <= LARGEST_COUNT:  # nan too
            most = f"write a number up to {LARGEST_COUNT:,}"
            self.refuse(where, f"{name_of(where)} is {describe(value)}; {most}")
        elif not is_exact(value):
            advice = f"round it to {PLACES} places"
            self.refuse(where, f"{name_of(where)} is {describe(value)}; {advice}")
        else:
            return exact(value)
        return 1

    def counts(self, where: Where, value: Any) -> dict[str, float]:
        """Return capability counts: a list of names, once each, or a mapping to counts."""
        if isinstance(value, dict):
            return {
                self.text((*where, name), name): self.count((*where, name), count)
                for name, count in value.items()
            }
        if not isinstance(value, list):
            what = f"{name_of(where)} is {describe(value)}"
            self.refuse(where, f"{what}; write a list of capabilities or a mapping to counts")
            return {"?": 1}
        counts: dict[str, float] = {}
        for number, name in enumerate(self.names(where, value)):
            if name in counts and name != "?":
                advice = f"to mean two write {{{shorten(name)}: 2}}"
                self.refuse((*where, number), f"'{name}' stands twice in this list; {advice}")
            counts[name] = 1
        return counts


def name_of(where: Where) -> str:
    """Name a place for people: `at of robot 3`."""
    if not where:
        return "the file"
    *around, last = where
    if not isinstance(last, int):
        key = shorten(str(last))
        return f"{key} of {name_of(tuple(around))}" if around else key
    if around in (["robots"], ["tasks"], ["teams"]):
        return f"{str(around[0])[:-1]} {last + 1}"
    return f"entry {last + 1} of {name_of(tuple(around))}"


def misshapen(value: Any, wanted: int) -> str:
    """Say of what is no list of so many numbers what is wrong with it."""
    if not isinstance(value, list):
        return f"is {describe(value)}"
    if len(value) > wanted:
        return f"has {len(value)} numbers instead of {wanted}"
    lacks = wanted - len(value)
    return "lacks one number" if lacks == 1 else f"lacks {lacks} numbers"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


MEANT = {
    **dict.fromkeys(("deadline", "due", "due_date", "window", "time_window"), "between"),
    **dict.fromkeys(("priority", "importance"), "weight"),
    **dict.fromkeys(("depends_on", "predecessors"), "after"),
    **dict.fromkeys(("position", "location", "pose", "start"), "at"),
    **dict.fromkeys(("skills", "abilities"), "can"),
    **dict.fromkeys(("requires", "requirements"), "needs"),
}
"""Keys by the words that others have for them."""

HOW = {
    "between": "between: [0, 20] if it is late after 20",
    "weight": "weight: 2 if its end and lateness count twice in the mission's cost",
}
"""What helps with a key besides its name."""


def _suggest(key: Any, keys: Mapping[str, bool]) -> str:
    shown = shorten(str(key))
    meant = MEANT.get(shown.lower())
    if meant is not None and meant in keys:
        return f"'{shown}'; write {HOW.get(meant, meant)}"
    owners = [owner for owner, own in OWNERS.items() if any(one.name == shown for one in own)]
    if len(owners) == 1:
        return f"'{shown}', which is a key of {owners[0]}; move it there"
    near = difflib.get_close_matches(shown, list(keys), 1)
    return f"'{shown}'; " + (f"did you mean '{near[0]}'?" if near else f"known are {_list(keys)}")


def _list(keys: Mapping[str, bool]) -> str:
    return ", ".join(keys)
