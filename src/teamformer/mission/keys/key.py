"""A key of the mission file: what stands under it, what it means, and what holds without it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any, Final

from teamformer.mission.keys.kinds import Kind

REQUIRED: Final = "must be there"
"""What stands for the default of a key that has none."""

FIRST_VERSION = "0.1.0"

STEPS, CONTINUOUS = "steps", "continuous time"
FLEETS, ROBOTARIUM = "fleets of processes", "the Robotarium"
BEFOREHAND = "plans made beforehand"
"""Who may not know a key."""


@dataclass(frozen=True)
class Unknown:
    """Who does not know what a key says, and what is said of a thing that has the key.

    `what` follows the name of the robot or the task, if the key is one of theirs. If it
    `is_surprise`, the value is open until it shows. `field` has the value if that is not the key's.
    """

    to: tuple[str, ...]
    what: str
    is_surprise: bool = False
    field: str = ""


@dataclass(frozen=True, eq=False)
class Key:
    """One key. `means` and `without` are Markdown; `without` says what holds if it is left out.

    `default` is what the model has then. `held_as` is the name of the field of the model, if that
    is another one. What `is_always_written` stands in written files even if it is the default.
    `since` is the version that has it first. `label` is what pages call it; a key with a label has
    a field in the editor. One that `is_in_details` is shown wherever its thing is in detail: in the
    page's side, in CSV tables.
    """

    name: str
    kind: Kind
    means: str
    default: Any = REQUIRED
    without: str = ""
    held_as: str = ""
    is_always_written: bool = False
    since: str = FIRST_VERSION
    label: str = ""
    is_in_details: bool = False
    example: Any = None
    unknown: Unknown | None = None

    @property
    def field(self) -> str:
        """Return the name of the field of the model that holds the value."""
        return self.held_as or self.name

    @property
    def in_words(self) -> str:
        """Return what the key means, without the links of Markdown."""
        return plain(self.means)

    @property
    def is_required(self) -> bool:
        """Say whether the key must be there."""
        return self.default is REQUIRED


def plain(text: str) -> str:
    """Return Markdown without its links."""
    return re.sub(r"\[([^]]+)\]\([^)]+\)", r"\1", re.sub(r" \(\[[^]]+\]\([^)]+\)\)", "", text))
