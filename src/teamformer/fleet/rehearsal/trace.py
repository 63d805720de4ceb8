"""What happened in a rehearsal, as plain rows in order of time: for the checker and for records."""

from __future__ import annotations

from typing import NamedTuple

from teamformer.fleet.bodies.world import Lifted, Walked


class Said(NamedTuple):
    """A robot told the others something new about itself."""

    at: float
    robot: int
    team: int
    goal: int
    phase: int
    hold: float  # seconds for which it promises to stay, by its own clock


class Worked(NamedTuple):
    """A robot began to serve a task with a team, or stopped (task is NOBODY)."""

    at: float
    robot: int
    task: int
    team: int


class Finished(NamedTuple):
    """A task was done."""

    at: float
    task: int


class Broke(NamedTuple):
    """Something befell a robot: crash, restart, pause, resume, stuck, free."""

    at: float
    robot: int
    what: str


class Accepted(NamedTuple):
    """An operator was told that its task is accepted; those robots hold it."""

    at: float
    task: int
    holders: tuple[int, ...]


class Sent(NamedTuple):
    """A message got from one robot to another; its kind is in lower case, without `Note`."""

    at: float
    sender: int
    receiver: int
    kind: str


Event = Said | Worked | Walked | Finished | Lifted | Broke | Accepted | Sent


class Trace:
    """The rows of one rehearsal; messages only if asked for."""

    def __init__(self, with_messages: bool = False) -> None:
        self.events: list[Event] = []
        self.with_messages = with_messages
