"""What stands under a key: a number within bounds, a place, some names, a part with own keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teamformer.mission.keys.key import Key

LARGEST_NUMBER = 10**9
"""Of steps, and along an axis; beyond lie slips of the keyboard, and what 32 bits cannot hold."""

LATEST_RETURN = 2 * LARGEST_NUMBER
"""The step in which a robot may be back: lost as late as can be, and away as long as can be."""

LARGEST_COUNT = 100_000
LONGEST_TEXT = 200
INFINITE = ".inf"
"""Infinity as text: JSON has no number for it."""


@dataclass(frozen=True)
class Text:
    """A text of one line that can be printed."""

    longest: int = LONGEST_TEXT


@dataclass(frozen=True)
class Number:
    """A number within bounds, both included unless it `is_above` the least or below the most."""

    least: float | None = None
    most: float = LARGEST_NUMBER
    is_above: bool = False
    is_below: bool = False
    can_be_infinite: bool = False


@dataclass(frozen=True)
class Whole:
    """A whole number within bounds, both included.

    If it `is_checked_later`, the checks of missions tell what is wrong, by the name of the thing.
    """

    least: int | None = None
    most: int = LARGEST_NUMBER
    is_checked_later: bool = False


@dataclass(frozen=True)
class Time:
    """A span from 0, or more than 0: in steps a whole number, in continuous time any number."""

    is_above: bool = False


@dataclass(frozen=True)
class Moments:
    """A step, or a list of steps; in continuous time a time after the start, or a list."""

    least: int
    most: int


@dataclass(frozen=True)
class Range:
    """The least and the most of a span, as for `Time`; `remedy` says how it is written."""

    least: int
    remedy: str = "write it as [least, most]"


@dataclass(frozen=True)
class Window:
    """Two times, the first one before the second; `form` says how it is written."""

    form: str = "[begin, end]"


@dataclass(frozen=True)
class Shifts:
    """A list of at least one window, in the order of time."""


@dataclass(frozen=True)
class StartLinks:
    """How long after others something starts: the least and the most, by the others' names."""


@dataclass(frozen=True)
class Counts:
    """How much of each capability: a list of names, or a mapping to counts."""


@dataclass(frozen=True)
class Chances:
    """A probability for each of some capabilities."""


@dataclass(frozen=True)
class Names:
    """A list of names, each once."""


@dataclass(frozen=True)
class RobotNames:
    """A list of at least one robot, by name; the name of an entry with `count` is all of its."""


@dataclass(frozen=True)
class TeamLists:
    """Lists of robots, by name."""


@dataclass(frozen=True)
class Place:
    """`[x, y]`: a cell, on a plane a point; on roads the name of a place."""


@dataclass(frozen=True)
class Places:
    """A list of at least one place."""


@dataclass(frozen=True)
class OneOf:
    """One of a few words."""

    choices: tuple[str, ...]


@dataclass(frozen=True)
class Truth:
    """`true` or `false`."""


@dataclass(frozen=True)
class Moves:
    """How a robot moves: one of a few words; on roads the name of one of their tables."""

    choices: tuple[str, ...]


@dataclass(frozen=True)
class KeyedPart:
    """A mapping with keys of its own.

    `makes` is the class of the model that it becomes; `alone` the key whose value may stand alone
    for the part.
    """

    keys: tuple[Key, ...]
    makes: str = ""
    alone: str = ""


@dataclass(frozen=True)
class KeyedParts:
    """A list of at least one mapping, all with the same keys.

    `makes` is the class of the model that each becomes, if they are read like other keys.
    """

    keys: tuple[Key, ...]
    makes: str = ""


@dataclass(frozen=True)
class NamedParts:
    """A mapping from names to mappings, all with the same keys.

    `makes` is the class of the model that each becomes, with its name.
    """

    keys: tuple[Key, ...]
    makes: str


@dataclass(frozen=True)
class Either:
    """One of two kinds: a number or a word, or what is written as a list."""

    plain: Kind
    listed: Kind


@dataclass(frozen=True)
class Sides:
    """A width and a height."""

    of: Whole | Number


@dataclass(frozen=True)
class Rows:
    """A map drawn in the file: a list of texts, or a text of several lines."""


@dataclass(frozen=True)
class Tables:
    """A file, or the text of one; or a file for each kind of mover."""


@dataclass(frozen=True)
class Origin:
    """`[x, y, yaw]` in metres and radians; the yaw may be left out."""


@dataclass(frozen=True)
class Forms:
    """A mapping in one of several forms, each named by the key that it must have."""

    keys: Mapping[str, tuple[Key, ...]]


Kind = (
    Text
    | Number
    | Whole
    | Time
    | Moments
    | Range
    | Window
    | Shifts
    | StartLinks
    | Counts
    | Chances
    | Names
    | RobotNames
    | TeamLists
    | Place
    | Places
    | OneOf
    | Truth
    | Moves
    | KeyedPart
    | KeyedParts
    | NamedParts
    | Either
    | Sides
    | Rows
    | Tables
    | Origin
    | Forms
)
