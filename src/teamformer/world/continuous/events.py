"""What can happen in a mission in continuous time, and what is told of it.

Whoever makes something happen writes an `Event`. Everybody else reads events: nobody works out by
rules of their own what has happened.
"""

from __future__ import annotations

from typing import NamedTuple

from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.grid import Place
from teamformer.world.rules.constants import NOBODY


class Passed(NamedTuple):
    """A place on a way, and when it is passed if nothing happens."""

    at: float
    place: Place


class PlannedTask(NamedTuple):
    """Who is to do a task by a plan, and when it is expected to end."""

    task: int
    robots: tuple[int, ...]  # nobody: it waits for a later plan
    end: float | None = None


class PlanMade(NamedTuple):
    """Why a plan was made, out of `NEWS`, and its tasks in order."""

    reasons: tuple[str, ...]
    tasks: tuple[PlannedTask, ...]


class Event(NamedTuple):
    """One thing that happened, at a time in the mission's unit.

    `cause` is the number of the event that this one hung on: had that come later, so had this. A
    chain of causes leads from the end of a mission to its start, and is its critical path.
    """

    at: float
    kind: str  # a name of `KINDS`
    robots: tuple[int, ...] = ()
    task: int = NOBODY
    place: Place | None = None
    until: float | None = None  # when it is expected to end
    way: tuple[Passed, ...] = ()  # from where it begins to where it leads
    cause: int = NOBODY  # nothing: it came from outside, or the mission began with it
    plan: PlanMade | None = None
    needs: Counts | None = None  # what a task needs, once that is known
    status: str = ""  # how the mission ended
    why: str = ""  # a word of `WHY_MISSED`


WHY_MISSED = {
    "under way": "it was under way when the mission was over",
    "too late": "its team was there too late",
    "nobody able": "the robots do not bring what it needs",
    "too far": "nobody gets there in time",
    "too far for its battery": "it is too far from chargers for full batteries",
    "no shift": "the shifts of those who can do it leave no time for it",
    "not worth it": "it was not worth what it costs",
    "nobody free": "those who could do it had other things to do",
}
"""Why tasks are missed, and what is said of it."""


class EventKind(NamedTuple):
    """A kind of event: the fields that it uses besides `at` and `cause`, and what it says.

    Those that it `may_lack` have something to say in some events of the kind only.
    """

    fields: tuple[str, ...]
    says: str
    may_lack: tuple[str, ...] = ()


KINDS = {
    "plan": EventKind(
        ("plan",),
        "a plan is in force from now on: why it was made, and its tasks in order, each with the "
        "robots of its coalition and its expected end",
    ),
    "walk": EventKind(
        ("robots", "task", "way", "until"),
        "a robot sets out, to a task or (no task) home or to where it stops, and is there at until",
        may_lack=("task",),
    ),
    "arrive": EventKind(
        ("robots", "task", "place"), "a robot is where it was going", may_lack=("task",)
    ),
    "form": EventKind(
        ("robots", "task", "place", "until"), "a coalition that is all there begins to form"
    ),
    "formed": EventKind(("robots", "task", "place"), "a coalition has formed"),
    "opens": EventKind(
        ("task",),
        "a task may begin from now on: its window opens, or its linked start or its hold has come",
    ),
    "serve": EventKind(
        ("robots", "task", "place", "until"),
        "a team begins to serve a task, or to take up its load; until: when all of it is done",
    ),
    "lift": EventKind(
        ("robots", "task", "place", "way", "until"), "a team sets out with a load that it took up"
    ),
    "unload": EventKind(
        ("robots", "task", "place", "until"), "a team with a load is where it goes, and unloads it"
    ),
    "done": EventKind(
        ("robots", "task", "place"),
        "a task is done; without `robots` nobody knows by whom, in records of fleets",
        may_lack=("robots",),
    ),
    "broken": EventKind(
        ("robots", "task", "place"),
        "a service has broken off; robots: those of it that are left; place: where the load lies",
        may_lack=("robots", "place"),
    ),
    "lost": EventKind(("robots", "place"), "a robot is lost"),
    "back": EventKind(("robots", "place"), "a lost robot is back, where it was lost"),
    "rests": EventKind(("robots",), "a shift of a robot ends: it stands where it is"),
    "works": EventKind(("robots",), "a shift of a robot begins"),
    "appear": EventKind(("task",), "a task becomes known"),
    "cancel": EventKind(("task",), "a task is called off"),
    "missed": EventKind(
        ("task", "why"),
        "a task is not done any more: it is given up, or the mission is over at `until`; why: "
        + ", ".join(f"`{word}`" for word in WHY_MISSED),
    ),
    "know": EventKind(
        ("robots", "task", "needs"),
        "what a task needs becomes known, to robots that are there or to everybody",
        may_lack=("robots",),
    ),
    "found": EventKind(
        ("robots", "task", "place"),
        "where a task is becomes known, to robots that saw it",
        may_lack=("robots",),
    ),
    "moved": EventKind(
        ("task", "place"), "a task is believed elsewhere from now on: it was not there"
    ),
    "overdue": EventKind(
        ("task", "until"), "a service lasts longer than believed; until: its new expected end"
    ),
    "queue": EventKind(
        ("robots", "task", "place"),
        "a robot waits until there is room at a charger, or a team until there is room in a zone "
        "to unload",
        may_lack=("task",),
    ),
    "charge": EventKind(
        ("robots", "place", "until"), "a robot begins to charge, and is full at until"
    ),
    "charged": EventKind(("robots", "place"), "a robot is full, and leaves its place to others"),
    "empty": EventKind(
        ("robots", "place"), "a robot has run dry: it stands still for good, as one that is lost"
    ),
    "over": EventKind(("status",), "the mission is over, and how"),
}
"""Every kind of event, by name."""
