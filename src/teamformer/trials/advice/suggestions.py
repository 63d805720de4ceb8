"""What was found to help, as it is told: suggestions, the largest gain first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from teamformer.mission.model import Mission
from teamformer.trials.advice.changes import FEWER, Change
from teamformer.viewer.advice_page import advice_page
from teamformer.viewer.notebook_page import Page

DIGITS = 6
"""Places after the point that are told of a time."""


@dataclass(frozen=True)
class Suggestion:
    """A change of a mission, how long the mission then takes, and how much that gains.

    `makespan` is the median of `searches` searches. `gain` is how much less that is than without
    the change. Both are in the mission's unit of time; if the mission has a cost, they are costs.
    Chance alone hardly ever gives a gain above `noise`. `mission` is the changed mission.
    """

    change: str
    kind: str  # one of `changes.KINDS`
    makespan: float
    gain: float
    noise: float
    searches: int
    mission: Mission

    @property
    def is_sure(self) -> bool:
        """Say whether the gain is more than noise."""
        return self.gain > self.noise


@dataclass(frozen=True, repr=False)
class Advice:
    """What would help a mission, with the largest gain first.

    `makespan` is the median of `searches` searches for the unchanged mission, which ranged from
    `least` to `most`. `written` is the makespan of the first of them, which takes the file as it is
    written. `impossible` has the changes with which the mission cannot be done. `unmeasured` has
    those that there was no time for.
    """

    mission: Mission
    method: str
    makespan: float
    written: float
    least: float
    most: float
    searches: int
    suggestions: tuple[Suggestion, ...]
    impossible: tuple[Change, ...] = ()
    unmeasured: tuple[Change, ...] = ()

    def __repr__(self) -> str:
        return f"<advice on {self.mission.name}: {len(self.helpful)} changes help>"

    @property
    def helpful(self) -> tuple[Suggestion, ...]:
        """Return the suggestions whose gain is more than noise."""
        return tuple(it for it in self.suggestions if it.is_sure)

    @property
    def spare(self) -> tuple[Suggestion, ...]:
        """Return the robots without which the mission takes no longer, up to noise."""
        fewer = (it for it in self.suggestions if it.kind == FEWER)
        return tuple(it for it in fewer if -it.gain <= it.noise)

    def show(self, height: int = 620) -> Page:
        """Return it as a page; a notebook shows it in a frame `height` pixels high."""
        return Page(advice_page(self.row), height)

    @property
    def row(self) -> dict[str, Any]:
        """Return what `teamformer advise --json` prints."""
        return {
            "mission": self.mission.name,
            "method": self.method,
            "measure": "makespan" if self.mission.cost is None else "cost",
            "makespan": _told(self.makespan),
            "written": _told(self.written),
            "range": [_told(self.least), _told(self.most)],
            "searches": self.searches,
            "advice": [
                {
                    "change": it.change,
                    "kind": it.kind,
                    "makespan": _told(it.makespan),
                    "gain": _told(it.gain),
                    "noise": _told(it.noise),
                    "sure": it.is_sure,
                    "searches": it.searches,
                }
                for it in self.suggestions
            ],
            "impossible": [change.what for change in self.impossible],
            "unmeasured": [change.what for change in self.unmeasured],
        }


def _told(value: float) -> float:
    """Return a number as it is told: a whole one without a point."""
    return int(value) if value == int(value) else round(value, DIGITS)
