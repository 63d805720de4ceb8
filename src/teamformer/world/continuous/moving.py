"""Robots that walk, and what happens to them, written down: the ground floor of the world."""

from __future__ import annotations

import heapq
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.shifts import rotas_of
from teamformer.mission.parts.zones import AtWork, loads_at_zones, rooms_of
from teamformer.world.continuous.body import (
    QUEUEING,
    SERVING,
    UNLOADING,
    RealRobot,
    TeamWork,
    turning,
)
from teamformer.world.continuous.delays import StandingStill
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.continuous.pauses import with_pauses
from teamformer.world.continuous.ways import Ways
from teamformer.world.rules.constants import NOBODY

LOSE, BRING_BACK, CALL_OFF, APPEAR, OPEN, ARRIVE, FINISH, EXPECT, LOOK, WAKE = range(10)
REST, WORK, FULL, CLOSE = range(10, 14)
"""What can be on the agenda; of what is due at one moment, what comes from outside is first, but
for the ends and beginnings of shifts: what is done then is done within them. That the mission
closes is last."""

Entry = tuple[float, int, int, int]
"""When something is due, what, whom or which task it is about, and the event that it belongs to."""


@dataclass
class Happened:
    """What a moment has brought: news, and what robots and tasks have to be looked at."""

    news: dict[str, None] = field(default_factory=dict)  # in the order in which they came
    robots: set[int] = field(default_factory=set)
    tasks: set[int] = field(default_factory=set)

    def __bool__(self) -> bool:
        """Say whether anything has to be looked at."""
        return bool(self.news or self.robots or self.tasks)


class MovingWorld(ABC):
    """Where robots are and go, what is on the agenda, and what has happened."""

    def __init__(self, mission: Mission, truth: Mission, is_all_known: bool = False) -> None:
        self.mission, self.truth = mission, truth
        self.now = 0.0
        self.events: list[Event] = []
        self.bodies = [RealRobot((Passed(0.0, r.at),), r.at) for r in truth.robots]
        self.works: dict[int, TeamWork] = {}  # by task
        self.over: dict[int, int] = {}  # tasks that are done, called off or missed, with the event
        self.done: set[int] = set()
        self.missed: list[int] = []
        self.started: dict[int, float] = {}  # when the latest service of each began
        self.served_by: dict[int, int] = {}  # the event with which it did
        self.appeared = {
            number for number, task in enumerate(truth.tasks) if task.appears == 0 or is_all_known
        }
        self.lies: dict[int, Place] = {}  # where loads were set down, by task
        self.travel = 0.0  # time that robots have spent on their ways
        self.ways, self.still = Ways(truth.world), StandingStill(truth.robots)
        self.rotas = rotas_of(truth.robots)  # by robot; empty where all always work
        self.may_queue = loads_at_zones(rooms_of(mission))  # loads that need room to be unloaded
        self.is_plane = isinstance(truth.world, Plane)
        self.happened = Happened()
        self.agenda: list[Entry] = []

    @property
    def next_time(self) -> float:
        """Return when something happens next; infinite if nothing ever does."""
        return self.next_due

    @property
    def next_due(self) -> float:
        """Return when something on the agenda is due next; infinite if nothing ever is."""
        while self.agenda and not self.is_due(self.agenda[0]):
            heapq.heappop(self.agenda)
        return self.agenda[0][0] if self.agenda else math.inf

    @property
    def next_but_shifts(self) -> float:
        """Return when something is due next but the ends and beginnings of shifts; or infinity."""
        due = (it[0] for it in self.agenda if it[1] not in (REST, WORK) and self.is_due(it))
        return min(due, default=math.inf)

    @property
    def is_busy(self) -> bool:
        """Say whether somebody is on the way, forms or is at work."""
        return bool(self.works) or any(b.is_walking and not b.is_lost for b in self.bodies)

    @property
    def under_way(self) -> set[int]:
        """Return the tasks that have begun and are not over."""
        return {task for task, work in self.works.items() if work.is_service}

    @property
    def at_work(self) -> AtWork:
        """Return what takes room in zones, or waits for it with a load."""
        doing = {part: [k for k, work in self.works.items() if work.part == part]
                 for part in (SERVING, UNLOADING, QUEUEING)}  # fmt: skip
        came = {task: self.works[task].way[0].at for task in doing[QUEUEING]}
        queue = sorted(came, key=lambda task: (came[task], task))
        return AtWork(doing[SERVING], doing[UNLOADING], queue)

    def take_happened(self) -> Happened:
        """Return what has happened since this was last asked."""
        happened, self.happened = self.happened, Happened()
        return happened

    def place_of(self, task: int) -> Place:
        """Return where a task is, or its load lies."""
        return self.lies.get(task, self.truth.tasks[task].at)

    def is_at(self, robot: int, place: Place) -> bool:
        """Say whether a robot stands at a place, and is neither lost nor at work."""
        body = self.bodies[robot]
        is_free = not body.is_lost and body.work == NOBODY and body.charger == NOBODY
        return is_free and not body.is_walking and body.way[0].place == place

    def next_place(self, robot: int) -> Passed:
        """Return where a robot can turn next, and when; where it is if it stands."""
        return turning(self.bodies[robot].way, self.now, self.is_plane)[-1]

    def set_out(self, robot: int, goal: Place | None, task: int, cause: int) -> None:
        """Have a robot go to a task, home or, without a goal, to where it can stop next.

        It stays if it is there already, or if no way leads there.
        """
        body = self.bodies[robot]
        body.task = task
        stub = turning(body.way, self.now, self.is_plane)
        goal = stub[-1].place if goal is None else goal
        if body.is_walking and body.way[-1].place == goal and self._heads_for(body) == task:
            return
        self.go(robot, stub, goal, cause)

    def go(self, robot: int, stub: tuple[Passed, ...], goal: Place, cause: int) -> None:
        """Have a robot go to its task or elsewhere, from the next place of the way it is on."""
        body, real = self.bodies[robot], self.truth.robots[robot]
        task, start = body.task, stub[-1]
        if not math.isfinite(self.ways.length(start.place, goal, real.moves)):
            goal = start.place
        stages = self.ways.stages(start.place, goal, real.moves)
        ahead = self.passing((robot,), start.at, [(p, d / real.speed) for p, d in stages])
        if ahead and math.isinf(ahead[-1].at):  # its shifts are over before
            goal, ahead = start.place, ()
        is_even = self.is_plane and real.delays is None
        way = (*stub, *with_pauses(real.rota, start, ahead, is_even))
        if len(way) == 1:
            stops = body.is_walking
            self.stop_walking(robot)
            body.way = way
            if task != NOBODY or stops:
                body.since = self.tell("arrive", (robot,), task, cause, place=goal)
                self.sense(robot)
            return
        self.stop_walking(robot)
        body.way = way
        number = self.tell("walk", (robot,), task, cause, until=way[-1].at, way=way)
        body.since = body.set_out = number
        self.put(way[-1].at, ARRIVE, robot, number)

    def tell(self, kind: str, robots: Sequence[int], task: int, cause: int, **said: Any) -> int:
        """Write down an event of this moment, and return its number."""
        event = Event(self.now, kind, tuple(robots), task, cause=cause)
        self.events.append(event._replace(**said))
        return len(self.events) - 1

    def wake(self, at: float, task: int) -> None:
        """Have a task looked at again at a moment."""
        self.put(at, WAKE, task, NOBODY)

    def cause_among(self, candidates: Iterable[int]) -> int:
        """Return on which of some events something hangs that begins now: on the latest one.

        If none of them is of this moment, it hangs on what has happened last.
        """
        latest = max(candidates, default=NOBODY)
        is_now = latest != NOBODY and self.events[latest].at == self.now
        return latest if is_now or not self.events else len(self.events) - 1

    def put(self, at: float, what: int, which: int, stamp: int) -> None:
        """Put something on the agenda."""
        heapq.heappush(self.agenda, (at, what, which, stamp))

    def note(self, news: str = "", robots: Iterable[int] = (), tasks: Iterable[int] = ()) -> None:
        """Note what has happened at this moment, and what has to be looked at."""
        if news:
            self.happened.news[news] = None
        self.happened.robots.update(robots)
        self.happened.tasks.update(tasks)

    def passing(
        self, who: Sequence[int], begin: float, stages: Iterable[tuple[Place, float]]
    ) -> tuple[Passed, ...]:
        """Return when robots that go together pass places, each with the time on the way to it."""
        after = self.still.after
        return tuple(Passed(after(who, begin, spent), place) for place, spent in stages)

    def _heads_for(self, body: RealRobot) -> int:
        """Return the task that a robot has set out for."""
        return self.events[body.set_out].task

    def stop_walking(self, robot: int) -> None:
        """Count how long a robot has walked that walks no more, or another way."""
        body = self.bodies[robot]
        if body.is_walking:
            set_out = self.events[body.set_out].at
            self.travel += self.truth.robots[robot].rota.worked(set_out, self.now)

    def arrive(self, robot: int) -> None:
        """Let a robot be where it was going."""
        body = self.bodies[robot]
        self.stop_walking(robot)
        body.way = (body.way[-1],)
        place, cause = body.way[0].place, body.set_out
        body.since = self.tell("arrive", (robot,), body.task, cause, place=place)
        self.note(robots=(robot,))
        self.sense(robot)

    @abstractmethod
    def sense(self, robot: int) -> None:
        """Let it be known what a robot finds where it is."""

    def times(self, robot: int, here: Place, goal: Place) -> list[tuple[Place, float]]:
        """Return the places on a robot's way, each with the time it takes there."""
        real = self.truth.robots[robot]
        stages = self.ways.stages(here, goal, real.moves)
        return [(place, length / real.speed) for place, length in stages]

    @abstractmethod
    def is_due(self, entry: Entry) -> bool:
        """Say whether an entry of the agenda still holds."""
