"""The seam between a mind and what moves: what an agent commands, and what a body reports."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from teamformer.mission.parts.grid import Place
from teamformer.world.rules.constants import NOBODY


class Command(NamedTuple):
    """What a body is to do; a new `leg` for each new place or task."""

    leg: int = 0
    place: Place | None = None  # None: stay
    task: int = NOBODY  # what it goes there for
    team: int = NOBODY  # with whom it serves
    serve: bool = False
    duration: float = 0.0  # seconds that the service of the task takes
    pace: float = 0.0  # of its team with a load, cells or metres a second; 0 for no load
    charge: bool = False  # it is at a charger and is to charge


class Report(NamedTuple):
    """What a body senses; `leg` is the last command that it has taken up.

    `number` grows from report to report, so that one that comes late or twice is known as such.
    `is_done` says that the task of that command is done, as far as one sees who stands there, and
    `is_busy` that another team is at work on it. A body that sees only its own part reports
    `has_served` when that is over; agents then say so to one another, and the task is done when the
    parts of robots are over that together have what it needs. Where it can see what an uncertain
    task really needs, it reports that in `needs`, in the order of the mission's capabilities.

    A body that serves a task with a load takes it up, carries it to where it is to be brought, and
    unloads it there; it sets it down where it is told to stop. Where it can see loads it also says
    where that of the task lies, and whether none lies where it stands. It says the same of a task
    whose place is not known, once it is near enough to see it.
    """

    x: float
    y: float
    leg: int = 0
    is_done: bool = False
    is_busy: bool = False
    number: int = 0
    carries: bool = False  # the load of the task
    load: Place | None = None  # where it sees the load of the task lie
    is_gone: bool = False  # it sees that the load of the task does not lie where it stands
    is_unfit: bool = False  # it cannot do what it is told, and nobody is to count on it for now
    has_served: bool = False  # its own part of the task is over
    needs: tuple[float, ...] | None = None  # of the task, where it stands there and can see them
    charge: float | None = None  # how full its battery is, 0 to 1; None if it does not know


FULL = 0.98
"""A real battery that says that it has so much is as full as it gets."""


def charge_of(share: float) -> float:
    """Return how full a real battery is that says so, 0 to 1."""
    return 1.0 if share >= FULL else max(0.0, share)


class Body(Protocol):
    """A robot's body. It obeys the last command, and reports whenever it is asked."""

    def command(self, command: Command) -> None:
        """Take up a command; the same one may come again."""

    def report(self) -> Report | None:
        """Return what it senses now; None while it is out of reach."""

    def close(self) -> None:
        """Come to a stop."""
