"""Judging the record of a fleet in continuous time: what its events can show of what robots did.

Robots go and wait as they decide for themselves, so no plan says what they have to do. They are
where their ways lead, no sooner than they can be; teams bring what tasks need, and stay as long as
these take; and everything comes after what it has to.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from teamformer.mission.checks.windows import release_of
from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import Roads
from teamformer.mission.precedence import tasks_before
from teamformer.record.event_rules.lengths import Lengths
from teamformer.record.event_rules.names import InWords
from teamformer.record.record import Record
from teamformer.record.snapshots.events_seen import lateness
from teamformer.record.snapshots.fleet_rules import (
    A_MOMENT,
    CLOCKS,
    is_in_shift,
    is_too_late,
    may_miss,
    wrong_status,
)
from teamformer.world.continuous.events import WHY_MISSED, Event, Passed

WORK = ("serve", "lift", "unload", "done")
ALLOWED = {
    *("plan", "walk", "arrive", "serve", "lift", "unload", "done", "broken"),
    *("lost", "back", "appear", "cancel", "missed", "know", "found", "moved", "over"),
    *("charge", "charged", "empty"),
}
"""Kinds of events that a fleet tells."""


def judge_fleet_events(record: Record) -> Iterator[tuple[float, str]]:
    """Yield what cannot be of a fleet's record, each with its time, up to the first event."""
    seen = _Seen(record)
    for number, event in enumerate(record.events):
        wrong = list(seen.go_on(event, number))
        yield from ((event.at, what) for what in wrong)
        if wrong:
            return
    last = record.events[-1] if record.events else None
    if last is None or last.kind != "over":
        yield 0.0, "the record does not say how the mission ended"
        return
    yield from ((0.0, what) for what in seen.wrong_ending(last))


class _Seen:
    """How everybody stands by the events so far."""

    def __init__(self, record: Record) -> None:
        self._record, self._mission = record, record.true_mission
        self._names, self._lengths = InWords(record.mission), Lengths(self._mission)
        self._before = tasks_before(self._mission.tasks)
        starts = enumerate(self._mission.robots)
        self._ways: dict[int, tuple[Passed, ...]] = {  # the latest of each
            robot: (Passed(0.0, it.at),) for robot, it in starts
        }
        self._works: dict[int, Event] = {}  # the event with which the part at hand began, by task
        self._began: dict[int, float] = {}
        self._lost: set[int] = set()
        self._charging: dict[int, Place] = {}  # by robot
        self._over: dict[int, float] = {}
        self._done: set[int] = set()
        self._missed: set[int] = set()
        self._appeared = {n for n, task in enumerate(self._mission.tasks) if task.appears == 0}
        self._reach = 0.0
        if isinstance(self._mission.world, Plane):
            self._reach = self._mission.world.arrival_radius + A_MOMENT

    def go_on(self, event: Event, number: int) -> Iterator[str]:
        """Take in an event; yield what is wrong with it."""
        if event.kind not in ALLOWED:
            yield f"no fleet tells that {event.kind}"
            return
        if event.cause >= number:
            yield f"{event.kind} hangs on what comes later"
        for robot in event.robots:
            if robot in self._lost and event.kind != "back":
                yield f"{self._names.robot(robot)} is lost, and {event.kind}s"
        for robot in event.robots:  # whatever it does, it charges no more
            self._charging.pop(robot, None)
        if event.kind == "walk":
            yield from self._walk(event)
        elif event.kind == "arrive":
            yield from self._arrive(event)
        elif event.kind in WORK:
            yield from self._work(event)
        elif event.kind == "broken":
            self._works.pop(event.task, None)
        elif event.kind == "appear":
            self._appeared.add(event.task)
        elif event.kind == "cancel" and event.task not in self._over:
            self._over[event.task] = event.at
            self._works.pop(event.task, None)
        elif event.kind == "missed":
            yield from self._miss(event)
        elif event.kind == "lost":
            yield from self._lose(event)
        elif event.kind == "charge":
            yield from self._charge(event)
        elif event.kind == "empty":
            self._lost.update(event.robots)
        elif event.kind == "back":
            self._lost.difference_update(event.robots)

    def _miss(self, event: Event) -> Iterator[str]:
        """Check that a task may be missed: the mission is over, or it is given up in the end."""
        task, is_last = event.task, event.at == self._record.events[-1].at
        if task in self._over or not may_miss(self._mission, task, event.at, is_last):
            yield f"{self._names.task(task)} can still be done, or is over"
        if event.why not in WHY_MISSED:
            yield f"{self._names.task(task)} is missed, and no word says why"
        self._over[task] = event.at
        self._missed.add(task)
        self._works.pop(task, None)

    def _charge(self, event: Event) -> Iterator[str]:
        """Check that a robot charges at a charger with room for it."""
        [robot], place = event.robots, event.place
        assert place is not None, "it has been read"
        room = sum(it.room for it in self._mission.chargers if it.at == place)
        yield from self._is_there(robot, place, event.at)
        self._charging[robot] = place
        if list(self._charging.values()).count(place) > room:
            yield f"{self._names.robot(robot)} charges where there is no room to"

    def _lose(self, event: Event) -> Iterator[str]:
        """Note that a robot is lost where it is; on roads perhaps not yet at the place told."""
        [robot] = event.robots
        if event.place is not None and not isinstance(self._mission.world, Roads):
            yield from self._is_there(robot, event.place, event.at)
        self._lost.add(robot)

    def _walk(self, event: Event) -> Iterator[str]:
        """Check that a robot goes where ways lead, and no faster than it can."""
        [robot] = event.robots
        who = self._names.robot(robot)
        if event.until != event.way[-1].at:
            yield f"{who} is there at {event.way[-1].at:g}, and the record says {event.until}"
        at, place = self._passed(robot, event.at, event.way[0].place)
        for one in event.way:
            least = self._least_on_way(robot, place, one.place)
            if one.at - at < least * (1 - CLOCKS) - A_MOMENT:
                yield (
                    f"{who} is at {self._names.place(one.place)} at {one.at:g}, and takes "
                    f"{least:g} there from {self._names.place(place)}"
                )
                return
            at, place = max(at, one.at), one.place
        self._ways[robot] = event.way
        for task, work in self._works.items():  # whoever leaves is at work no more
            left = tuple(other for other in work.robots if other != robot)
            self._works[task] = work._replace(robots=left)

    def _passed(self, robot: int, now: float, place: Place | None = None) -> Passed:
        """Return the place that a robot passed last, or a certain one if it passed that.

        Who was stuck on its way is further back than that says.
        """
        way = self._ways[robot]
        passed = [way[0], *(one for one in way if one.at <= now)]
        return next((one for one in passed[::-1] if one.place == place), passed[-1])

    def _least(self, robot: int, here: Place, there: Place) -> float:
        """Return how long a robot takes at least; nothing where it is near enough."""
        length = self._lengths.between(here, there, robot)
        return max(0.0, length - 2 * self._reach) / self._mission.robots[robot].speed

    def _least_on_way(self, robot: int, here: Place, there: Place) -> float:
        """Return how long a part of a way takes at least; who let a load go may be on another's."""
        parts = pairwise(self._ways[robot])
        took = (b.at - a.at for a, b in parts if (a.place, b.place) == (here, there))
        return min([self._least(robot, here, there), *took])

    def _arrive(self, event: Event) -> Iterator[str]:
        [robot] = event.robots
        assert event.place is not None, "it has been read"
        yield from self._is_there(robot, event.place, event.at)

    def _is_there(self, robot: int, there: Place, now: float) -> Iterator[str]:
        """Say so if a robot cannot be in a place yet, and note that it is."""
        at, place = self._passed(robot, now)
        least = self._least(robot, place, there)
        if now - at < least * (1 - CLOCKS) - A_MOMENT:
            yield f"{self._names.robot(robot)} cannot be at {self._names.place(there)} yet"
        self._ways[robot] = (Passed(now, there),)

    def _work(self, event: Event) -> Iterator[str]:
        """Check that a team may do a part of a task, and has been at it for as long as it takes."""
        task, place = event.task, event.place
        assert place is not None, "it has been read"
        name, real = self._names.task(task), self._mission.tasks[task]
        if task in self._done or (task in self._over and event.kind == "serve"):
            yield f"{name} is over"
        if task not in self._appeared:
            yield f"{name} is not known yet"
        have = total(self._mission.robots[robot].can for robot in event.robots)
        is_known = event.robots or event.kind != "done"  # or nobody knows by whom it is done
        if is_known and (lacks := missing(have, real.needs)):
            yield f"the team of {name} lacks {describe(lacks)}"
        for robot in event.robots:
            if event.kind == "serve" or (event.kind == "done" and real.to is None):
                yield from self._is_there(robot, place, event.at)
            else:
                self._ways[robot] = (Passed(event.at, place),)
        elsewhere = [k for k, work in self._works.items() if k != task]
        busy = {robot for k in elsewhere for robot in self._works[k].robots}
        for robot in busy.intersection(event.robots):
            yield f"{self._names.robot(robot)} is at work elsewhere"
        parts = {"serve": self._serve, "lift": self._lift, "unload": self._unload}
        yield from parts.get(event.kind, self._end)(event)

    def _serve(self, event: Event) -> Iterator[str]:
        task = event.task
        early = release_of(self._mission.tasks[task]) * (1 - CLOCKS) - A_MOMENT
        waits = [k for k in self._before.get(task, ()) if k not in self._over]
        if event.at < early or waits:
            yield f"{self._names.task(task)} may not begin yet"
        if is_too_late(self._mission, event.at):
            yield f"{self._names.task(task)} begins when the mission is over"
        self._began[task], self._works[task] = event.at, event

    def _lift(self, event: Event) -> Iterator[str]:
        task = event.task
        real, work = self._mission.tasks[task], self._works.get(task)
        name = self._names.task(task)
        if real.to is None or work is None or work.kind == "unload":
            yield f"nobody takes {name} up"
            return
        if work.kind == "serve":
            yield from self._lasts(event, real.duration)
        ahead = [one for one in event.way if one.at >= event.at]
        for robot in event.robots if ahead else ():  # the places between are one mover's
            least = self._least(robot, ahead[0].place, ahead[-1].place)
            if ahead[-1].at - ahead[0].at < least * (1 - CLOCKS) - A_MOMENT:
                yield f"{name} is carried faster than {self._names.robot(robot)} can go"
        self._works[task] = event
        self._ways |= dict.fromkeys(event.robots, event.way)

    def _unload(self, event: Event) -> Iterator[str]:
        task = event.task
        work = self._works.get(task)
        if work is None or event.place != self._mission.tasks[task].to:
            yield f"{self._names.task(task)} is not where it goes"
        self._works[task], self._began[task] = event, event.at

    def _end(self, event: Event) -> Iterator[str]:
        task = event.task
        real = self._mission.tasks[task]
        if event.at < real.appears + real.duration + real.unload - A_MOMENT:
            yield f"{self._names.task(task)} is done sooner than it can be"
        for robot in event.robots if real.to is None else ():
            rota, begin = self._mission.robots[robot].rota, self._began.get(task, event.at)
            if not is_in_shift(rota, begin, event.at):
                name = self._names.task(task)
                yield f"{self._names.robot(robot)} does {name}, and no shift of it is so long"
        if event.robots and self._began.get(task) != event.at:  # else nobody saw it begin
            yield from self._lasts(event, real.duration if real.to is None else real.unload)
        self._works.pop(task, None)
        self._over[task] = event.at
        self._done.add(task)

    def _lasts(self, event: Event, due: float) -> Iterator[str]:
        """Say so if a part of a task was shorter than it has to be."""
        lasted = event.at - self._began.get(event.task, event.at)
        if lasted < due * (1 - CLOCKS) - A_MOMENT:
            name = self._names.task(event.task)
            yield f"{event.kind} of {name} comes after {lasted:.9g}, and takes {due:.9g}"

    def wrong_ending(self, last: Event) -> Iterator[str]:
        """Yield what a record says otherwise of its ending than its events."""
        end, mission = self._record.end, self._mission
        undone = {task.name for n, task in enumerate(mission.tasks) if n not in self._over}
        is_complete = end.status == "completed"
        facts = {
            "status": (end.status, last.status),
            "makespan": (end.makespan, last.at if is_complete else None),
            "tasks_done": (end.tasks_done, len(self._done)),
            "missed": (end.missed, tuple(mission.tasks[k].name for k in sorted(self._missed))),
            "late": (dict(end.late), lateness(mission, self._over, self._done)),
        }
        for name, (said, found) in facts.items():
            if said != found:
                yield f"the record says {name} {said}; it is {found}"
        yield from wrong_status(mission, end, undone, self._missed)
