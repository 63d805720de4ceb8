"""Turns the trace of a rehearsal in continuous time into a record of events."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import zip_longest

from teamformer.fleet.bodies.batteries import UNPLUGGED
from teamformer.fleet.bodies.journey import Journey
from teamformer.fleet.bodies.walking import Walked
from teamformer.fleet.fleet_mission import place_in
from teamformer.fleet.rehearsal.checking.trace import NEEDS, Believed, Broke, Event, Noticed, Said
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.at_chargers import CHARGES
from teamformer.fleet.rehearsal.records.in_steps import (
    STATUSES,
    blocked_of,
    tasks_of,
    true_tasks_of,
)
from teamformer.mission.model import Mission, as_believed
from teamformer.mission.parts.grid import Place
from teamformer.mission.truth import truth_until
from teamformer.record.record import Record
from teamformer.record.snapshots.events_seen import EventsSeen
from teamformer.world.continuous.events import Event as ServiceEvent
from teamformer.world.continuous.events import Passed
from teamformer.world.rules.constants import NOBODY

CLOSE = "close"
"""Stands for the kind of what lets all be missed that is not over."""

KINDS = {"crash": "lost", "restart": "back"}
"""What befalls robots that records tell of; who is stuck is seen not to get on."""


def record_in_time(
    rehearsal: Rehearsal, outcome: Outcome, events: Sequence[Event], seed: int
) -> Record:
    """Return the record of a rehearsal of a mission in continuous time."""
    tasks, number = tasks_of(rehearsal)
    source = replace(rehearsal.mission.source, tasks=tasks, teams=(), arrivals=None)
    truth = _truth_of(rehearsal, source, outcome.end)
    seen = EventsSeen()
    status, end = STATUSES[outcome.status], outcome.end
    if status == "completed":  # where it ends at home, some may be on their way there
        end = max(end, outcome.makespan or 0.0)
    _TellerInTime(rehearsal, truth, number, seen).tell_all(events, end)
    if source.until is not None and status in ("completed", "too late"):  # the rest is given up
        seen.miss_the_rest(end, truth)
    if status == "completed":
        end = max([outcome.makespan or 0.0, *seen.over.values()])
    known = truth if source.has_surprises else None
    return seen.record(source, end, status, seed, blocked_of(outcome, tasks), known)


def _truth_of(rehearsal: Rehearsal, source: Mission, end: float) -> Mission:
    """Return the mission as it really was, with the breakdowns until its end."""
    robots, tasks = rehearsal.truth.robots, true_tasks_of(rehearsal, source.tasks)
    return truth_until(source, as_believed(source, robots=robots, tasks=tasks), end)


class _TellerInTime:
    """Tells what a trace holds; `number` has the numbers of tasks by their keys."""

    def __init__(
        self, rehearsal: Rehearsal, mission: Mission, number: Mapping[int, int], seen: EventsSeen
    ) -> None:
        self._first, self._mission, self._number = rehearsal.plan, mission, number
        self._seen = seen
        robots = range(len(mission.robots))
        self._goals = dict.fromkeys(robots, NOBODY)  # by robots' words
        starts = (Journey((Passed(0.0, robot.at),)) for robot in mission.robots)
        self._journeys = dict(enumerate(starts))
        self._shown: set[int] = set()

    def tell_all(self, events: Sequence[Event], end: float) -> None:
        """Tell everything until the end, in the order of time; what comes from outside is first."""
        stops = [(self._number[key], robots) for key, robots in self._first.stops]
        self._seen.plan(0.0, stops)
        outside = [*self._from_outside(), *_arrivals(events)]
        if self._mission.until is not None:
            outside.append(ServiceEvent(self._mission.until, CLOSE))
        told = (event for event in [*outside, *events] if event.at <= end)
        for event in sorted(told, key=lambda event: event.at):
            self._tell(event)

    def _from_outside(self) -> Iterator[ServiceEvent]:
        for number, task in enumerate(self._mission.tasks):
            if task.appears:
                yield ServiceEvent(task.appears, "appear", (), number)
            if task.cancelled is not None:
                yield ServiceEvent(task.cancelled, "cancel", (), number)

    def _tell(self, event: Event) -> None:
        if isinstance(event, Said):
            self._goals[event.robot] = self._number.get(event.goal, NOBODY)
        elif isinstance(event, Walked):
            self._tell_walk(event)
        elif isinstance(event, ServiceEvent):
            self._tell_service(event)
        elif isinstance(event, Broke) and event.what in KINDS:
            world = self._mission.world
            place = place_in(world, self._journeys[event.robot].place(event.at, world))
            self._seen.tell(event.at, KINDS[event.what], (event.robot,), place=place)
        elif isinstance(event, Believed):
            kind = "found" if event.is_found else "moved"
            self._seen.tell(event.at, kind, (), self._number[event.task], place=event.place)
        elif isinstance(event, Noticed) and event.what == NEEDS and event.task not in self._shown:
            self._shown.add(event.task)
            number = self._number[event.task]
            needs = self._mission.tasks[number].needs
            self._seen.tell(event.at, "know", (event.robot,), number, needs=needs)

    def _heads_for(self, robot: int, place: Place | None) -> int:
        """Return the task that a robot goes to by its word, while that is not over.

        Who goes to a charger goes to none.
        """
        task = self._goals[robot]
        is_over = task == NOBODY or task in self._seen.over
        at_chargers = {charger.at for charger in self._mission.chargers}
        is_charger = place in at_chargers and not is_over and place != self._mission.tasks[task].at
        return NOBODY if is_over or is_charger else task

    def _tell_walk(self, walk: Walked) -> None:
        robot, way = walk.robot, walk.journey.way
        before, self._journeys[robot] = self._journeys[robot], walk.journey
        if len(way) == 1 and walk.at < before.way[-1].at:  # it stops on its way
            self._seen.tell(walk.at, "arrive", (robot,), NOBODY, place=way[0].place)
        elif walk.journey.end < math.inf and walk.carries == NOBODY:
            task = self._heads_for(robot, way[-1].place)
            self._seen.tell(walk.at, "walk", (robot,), task, until=way[-1].at, way=way)
            if walk.journey.end <= walk.at:  # the way takes no time
                self._seen.tell(walk.at, "arrive", (robot,), task, place=way[-1].place)

    def _tell_service(self, event: ServiceEvent) -> None:
        """Tell what the simulated world tells, with the numbers of its tasks."""
        task, robots, place = event.task, event.robots, event.place
        if event.kind == CLOSE:
            self._seen.miss_the_rest(event.at, self._mission)
            return
        if event.kind == UNPLUGGED:
            self._seen.tell(event.at, "arrive", robots, NOBODY, place=place)
            return
        if event.kind in CHARGES:
            self._seen.tell(event.at, event.kind, robots, place=place, until=event.until)
            return
        if event.kind == "arrive":
            task = self._heads_for(robots[0], place)
        elif event.kind not in ("appear", "cancel"):
            if task not in self._number:
                return  # an operator's, which nobody has accepted
            task = self._number[task]
        if event.kind == "broken":
            robots = self._seen.at_work.get(task, ())
            place = place if self._mission.tasks[task].to is not None else None
        said = {"place": place, "until": event.until, "way": event.way}
        self._seen.tell(event.at, event.kind, robots, task, **said)


def _arrivals(events: Sequence[Event]) -> Iterator[ServiceEvent]:
    """Yield the arrivals of robots that get where they set out to, on ways that take time."""
    walks: dict[int, list[Walked]] = {}
    for event in events:
        if isinstance(event, Walked):
            walks.setdefault(event.robot, []).append(event)
    for robot, own in walks.items():
        for walk, after in zip_longest(own, own[1:]):
            at = walk.journey.end
            is_there = walk.at < at < math.inf and (after is None or at <= after.at)
            if is_there and walk.carries == NOBODY:
                yield ServiceEvent(at, "arrive", (robot,), place=walk.journey.goal)
