"""What happened in a rehearsal, as plain rows in order of time: for the checker and for records."""

from __future__ import annotations

from collections.abc import Set
from typing import NamedTuple

from teamformer.fleet.bodies.walking import Lifted, Walked
from teamformer.fleet.messages import MOST_MOVES, LoadFact
from teamformer.mission.parts.grid import Place
from teamformer.world.continuous.events import Event as ServiceEvent
from teamformer.world.rules.constants import NOBODY


class Said(NamedTuple):
    """A robot told the others something new about itself."""

    at: float
    robot: int
    team: int
    goal: int
    phase: int
    hold: float  # seconds for which it promises to stay, by its own clock
    charger: int = NOBODY  # at which it is to charge, or charges


class Worked(NamedTuple):
    """A robot began to serve a task with a team, or stopped (task is NOBODY)."""

    at: float
    robot: int
    task: int
    team: int


class Followed(NamedTuple):
    """A robot follows another plan from now on, which counts on some robots."""

    at: float
    robot: int
    live: frozenset[int]


class Finished(NamedTuple):
    """A task was done."""

    at: float
    task: int


class Broke(NamedTuple):
    """Something befell a robot: crash, restart, pause, resume, stuck, free, drain."""

    at: float
    robot: int
    what: str


class Accepted(NamedTuple):
    """An operator was told that its task is accepted; those robots hold it."""

    at: float
    task: int
    holders: tuple[int, ...]


class Noticed(NamedTuple):
    """A robot has come to know that a task is called off, or what it really needs."""

    at: float
    robot: int
    task: int
    what: str


OFF, NEEDS = "off", "needs"
"""What robots learn of a task."""


class Believed(NamedTuple):
    """A robot has come to know that a task is elsewhere than was believed, or has found it."""

    at: float
    task: int
    place: Place
    is_found: bool


class Sent(NamedTuple):
    """A message got from one robot to another; its kind is in lower case, without `Note`."""

    at: float
    sender: int
    receiver: int
    kind: str


Event = (
    Said
    | Worked
    | Followed
    | Walked
    | Finished
    | Lifted
    | ServiceEvent
    | Broke
    | Accepted
    | Noticed
    | Believed
    | Sent
)


class Trace:
    """The rows of one rehearsal; messages only if asked for."""

    def __init__(self, with_messages: bool = False) -> None:
        self.events: list[Event] = []
        self.with_messages = with_messages
        self._places: dict[int, LoadFact] = {}
        self._knows: dict[int, set[tuple[int, str]]] = {}  # of tasks, by robot

    def note_knowledge(self, now: float, robot: int, called_off: Set[int], needs: Set[int]) -> None:
        """Write down of which tasks a robot has come to know that they are off, or their needs."""
        knows = {(key, OFF) for key in called_off} | {(key, NEEDS) for key in needs}
        new = sorted(knows - self._knows.get(robot, set()))
        self.events += [Noticed(now, robot, *each) for each in new]
        self._knows[robot] = knows

    def note_place(self, now: float, load: LoadFact) -> None:
        """Write down where a hidden task is believed to be, if that is newer than before."""
        if load > self._places.get(load.key, LoadFact(load.key, 0, 0.0, 0.0)):
            self._places[load.key] = load
            is_found = load.version == MOST_MOVES
            self.events.append(Believed(now, load.key, (load.x, load.y), is_found))

    def forget(self, robot: int) -> None:
        """Take it that a robot knows nothing: it starts anew."""
        self._knows.pop(robot, None)
