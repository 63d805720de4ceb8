"""The record of a trial: what it began with, what happened, how it ended.

A mission in steps has `start`, `steps`, `orders` and what is planned and decided beside them; one
in continuous time has `events` instead of all these.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from teamformer.mission.model import Mission
from teamformer.world.continuous.events import Event

VERSION = 3
FLEET = "fleet"
"""The method in records of fleets, whose robots decide for themselves and keep no steps."""
HEARD = ("beat", "facts", "plan")
"""What the agents of a rehearsed fleet say to one another."""
STATUSES = ("completed", "step limit", "infeasible", "too late", "interrupted")


StartingTeam = tuple[int, tuple[int, ...], float, float]
"""Slot, robots, x and y of a team before the first step."""


class TeamAt(NamedTuple):
    """Where a team is after a step and what it heads for."""

    slot: int
    x: float  # a whole number on a grid
    y: float
    task: int | None


class TaskAt(NamedTuple):
    """Where a task is believed to be from a step on."""

    task: int
    x: float  # a whole number on a grid
    y: float


class SharedPlanMade(NamedTuple):
    """A shared plan: why it was made, and who does each open task, in the order then."""

    reasons: tuple[str, ...]
    coalitions: tuple[tuple[int, ...], ...]


class Wants(NamedTuple):
    """What a team decides in a step: the counts to have, by capability, and the task that it names.

    Counts of None are its own: it stays as it is. The number of a task may be none that there is.
    """

    slot: int
    counts: tuple[float, ...] | None = None
    task: int | None = None


@dataclass(frozen=True)
class Step:
    """What one step changed; robots, tasks and slots are numbers."""

    joins: tuple[tuple[int, int], ...] = ()  # joiner, partner
    splits: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...] = ()  # who stays, who leaves
    lost: tuple[int, ...] = ()
    back: tuple[int, ...] = ()  # each is a team of its own, where it was lost
    teams: tuple[TeamAt, ...] = ()  # whose slot, place or assignment changed
    done: tuple[tuple[int, int | None], ...] = ()
    """Task, team that did it; of fleets also None: it is done by then, and nobody knows by whom."""
    named: tuple[int, ...] = ()  # teams whose decision named their task, where tasks are shared out
    took: tuple[tuple[int, int], ...] = ()  # like robots that exchanged their parts of the plan
    heard: tuple[tuple[int, int, str], ...] = ()  # sender, receiver, what: one of HEARD
    shown: tuple[int, ...] = ()  # tasks whose needs have become known
    found: tuple[int, ...] = ()  # tasks whose place has become known
    moved: tuple[TaskAt, ...] = ()  # tasks that are elsewhere than believed, or believed elsewhere
    taken: tuple[tuple[int, int], ...] = ()  # loads taken up: task, team that carries it then
    left: tuple[TaskAt, ...] = ()  # loads that were set down on their way, and lie there
    pursued: tuple[tuple[int, int], ...] = ()  # slot, task that news took back before it was told
    served: tuple[tuple[int, tuple[int, ...]], ...] = ()
    """Task, robots that serve it from then on: they began, or are others; nobody: broken off."""
    unloads: tuple[int, ...] = ()  # loads that are where they go: to be unloaded from then on
    missed: tuple[tuple[int, str], ...] = ()  # tasks that are not done any more, and why
    charge: tuple[tuple[int, str], ...] = ()
    """Robots at chargers that do something else there than in the step before: one of `CHARGE`."""


@dataclass(frozen=True)
class Ending:
    """How a trial ended; in continuous time there are no steps, joins, splits and decisions.

    `cost`, `late` and `broken_links` are told in continuous time; in steps `task_times` has them.
    """

    status: str
    makespan: float | None  # in steps, or in the mission's unit of time
    steps: int = 0
    tasks_done: int = 0
    joins: int = 0
    splits: int = 0
    illegal_decisions: int = 0
    blocked_tasks: tuple[str, ...] = ()
    cost: float | None = None  # of a mission that has one, if it was completed
    late: Mapping[str, float] = field(default_factory=dict)  # by how much, by the tasks' names
    broken_links: tuple[tuple[str, str], ...] = ()
    """Tasks whose gap to another's start was not kept: its name, and that of the other."""
    missed: tuple[str, ...] = ()  # tasks that were not done by the end, or given up


@dataclass(frozen=True)
class Record:
    """A whole trial; mission, method and seed determine the rest."""

    mission: Mission
    method: str
    seed: int
    orders: tuple[tuple[int, tuple[int, ...]], ...] = ()  # steps made, open tasks in order
    start: tuple[StartingTeam, ...] = ()
    steps: tuple[Step, ...] = ()
    end: Ending = field(kw_only=True)
    events: tuple[Event, ...] = ()  # of a mission in continuous time, in the order of time
    lower_bound: float | None = None
    plans: tuple[tuple[int, SharedPlanMade], ...] = ()  # steps made, the shared plan from then on
    truth: Mission | None = None  # what an uncertain mission really was
    scouts: tuple[tuple[int, tuple[tuple[int, int], ...]], ...] = ()
    """Steps made, and robots by the plan made then that look first what a task needs."""
    foresight: str = "scouting"  # how needs were treated that nobody knew
    heeds: tuple[str, ...] = ()  # the news after which the coordinator is asked, if there is one
    decisions: tuple[tuple[int, tuple[Wants, ...]], ...] = ()
    """Steps by number, and what teams want from each on that do not want it already."""

    told: Any = field(default=None, repr=False, compare=False)
    """What its file says that all this comes to, for the referee to compare; None: no file does."""

    memo: dict[str, object] = field(default_factory=dict, init=False, repr=False, compare=False)
    """What has been worked out of the rest, which `telling` keeps here."""

    @property
    def is_continuous(self) -> bool:
        """Say whether it is of a mission in continuous time, and tells events."""
        return self.mission.time == "continuous"

    @property
    def length(self) -> float:
        """Return how many steps were made, or at what time the last event happened."""
        if self.is_continuous:
            return self.events[-1].at if self.events else 0
        return len(self.steps)

    @property
    def is_coordinated(self) -> bool:
        """Say whether robots went by plans; else by the paper's order and allocator."""
        return bool(self.plans or self.heeds)

    @property
    def true_mission(self) -> Mission:
        """Return the mission as it really was."""
        return self.mission if self.truth is None else self.truth
