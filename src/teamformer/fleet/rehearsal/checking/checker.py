"""Judges a rehearsal by its trace alone, from what a fleet promises; it shares no code with agents.

The promises:

- nobody serves in two teams: a robot at work is so for one task, with the team that its last word
  names, standing at that task;
- nobody begins to serve a task that is open unless robots that stand there, itself included, have
  what it needs and have said that they will stay; nor to serve one that is done, but for the
  moment that a body which reports late does not know that it is done, in which nothing happens;
- nobody begins to serve a task before those that come before it are over, nor before its window, by
  more than clocks may differ; and what is done within has its whole duration after that;
- nobody begins in a zone without room, unless those at work there and who begins do not both count
  on one another in the plans that they follow;
- nobody serves a task that it knows is called off;
- nobody begins to serve a task that could not end before the mission is over, or its shift, by more
  than clocks may differ, unless it has lost its memory in a crash;
- nobody goes through a wall who does not fly, nor on roads where no way leads, or faster than it
  can;
- who says that it stays, stays: until the time is over or the task is done;
- no task is done twice, and none without a team that was at work on it for its whole duration and
  had what it needs all the while;
- a load is taken up in the same way, and moves only with those who took it up, no faster than the
  slowest of them; it is done where it is to be brought, after the time that unloading takes, if
  those who carry it still have what it needs; else it is set down where they are;
- no task is forgotten that was accepted, or that the mission began with, if it can be done.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from teamformer.fleet.bodies.journey import Journey
from teamformer.fleet.bodies.walking import Lifted, Walked
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import HERE, READY, TaskFact
from teamformer.fleet.rehearsal.checking.moments import MomentChecker
from teamformer.fleet.rehearsal.checking.trace import (
    OFF,
    Accepted,
    Broke,
    Event,
    Finished,
    Followed,
    Noticed,
    Said,
    Worked,
)
from teamformer.fleet.rehearsal.checking.ways import WayChecker
from teamformer.fleet.rehearsal.checking.zones import ZoneChecker
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.world.continuous.events import Passed
from teamformer.world.rules.constants import NOBODY

DRIFT = 0.06
"""The part of a promise by which clocks may differ."""

A_TICK = 0.05
"""Seconds in which things count as happening at once."""


LATEST = 3.0
"""Seconds that a body may take to report at most: twice what a schedule lets it be late."""


@dataclass
class TracedRobot:
    """What the trace says of a robot so far."""

    walk: Walked
    word: Said | None = None
    stays_at: int = NOBODY  # the task at which it has promised to stay
    stays_until: float = -1.0
    hold: float = 0.0  # the seconds of that promise
    work: tuple[int, int] = (NOBODY, NOBODY)
    is_dead: bool = False
    has_forgotten: bool = False  # its promise, in a crash; the others cannot know
    has_restarted: bool = False
    resumed: float = -math.inf  # when it was frozen last, until when
    off: dict[int, float] = field(default_factory=dict)  # since when it knows of tasks that are off


@dataclass
class Load:
    """What the trace says of the load of a task so far."""

    at: Place
    carriers: set[int] = field(default_factory=set)
    taken_at: float = 0.0
    comes: float = 0.0  # when those who carry it are where they go
    left: list[tuple[float, Place]] = field(default_factory=list)  # where it lay, until when
    carried_until: dict[int, float] = field(default_factory=dict)  # by robots that let go of it


@dataclass
class Checker:
    """Goes through a trace once; `violations` says what was promised and not kept."""

    mission: FleetMission
    tasks: dict[int, TaskFact]
    violations: list[str] = field(default_factory=list)
    _robots: list[TracedRobot] = field(default_factory=list)
    _done: dict[int, float] = field(default_factory=dict)
    _accepted: dict[int, float] = field(default_factory=dict)
    _able_since: dict[tuple[int, int], float] = field(default_factory=dict)
    _loads: dict[int, Load] = field(default_factory=dict)

    def __post_init__(self) -> None:
        starts = [robot.at for robot in self.mission.source.robots]
        self._robots = [
            TracedRobot(Walked(0.0, number, Journey((Passed(0.0, at),))))
            for number, at in enumerate(starts)
        ]
        self._map, self._ways = self.mission.source.world, WayChecker(self.mission)
        self._moments = MomentChecker(self.mission, self.tasks)
        self._zones = ZoneChecker(self.mission, self.tasks)
        for key, task in self.tasks.items():
            if task.to is not None:
                self._loads[key] = Load((task.x, task.y))

    def check(self, events: Sequence[Event], undone: Iterable[int]) -> list[str]:
        """Return all violations; `undone` are tasks that can be done and were not in the end."""
        for event in sorted(events, key=lambda event: event.at):
            if isinstance(event, Walked):
                self._walk(event)
            elif isinstance(event, Said):
                self._say(event)
            elif isinstance(event, Worked):
                self._work(event)
            elif isinstance(event, Lifted):
                self._lift(event)
            elif isinstance(event, Finished):
                self._finish(event)
            elif isinstance(event, Broke):
                self._break(event)
            elif isinstance(event, Noticed) and event.what == OFF:
                self._robots[event.robot].off[event.task] = event.at
            elif isinstance(event, Followed):
                self._zones.follow(event)
            elif isinstance(event, Accepted):
                self._accepted[event.task] = event.at
        for key in undone:
            accepted = f", accepted at {self._accepted[key]:.2f} s" if key in self._accepted else ""
            self._blame(f"task '{self._name(key)}' is forgotten{accepted}")
        return self.violations

    def _blame(self, what: str) -> None:
        self.violations.append(what)

    def _name(self, key: int) -> str:
        return self.tasks[key].name

    def _who(self, robot: int) -> str:
        return f"'{self.mission.source.robots[robot].name}'"

    def _walk(self, event: Walked) -> None:
        robot = self._robots[event.robot]
        points = [passed.place for passed in event.journey.way]
        leaves = len(points) > 1 and not robot.has_forgotten
        if robot.stays_at in self._loads:  # it stays with the load, wherever that goes
            is_by = self._is_by(event.robot, robot.stays_at, event.at)
            leaves = leaves and is_by and event.robot not in self._loads[robot.stays_at].carriers
        slack = event.at + A_TICK + DRIFT * robot.hold
        is_early = leaves and robot.stays_until > slack and robot.stays_at not in self._done
        if is_early and not all(self._is_near(place, robot.stays_at) for place in points):
            left = robot.stays_until - event.at
            task = self._name(robot.stays_at)
            self._blame(
                f"{event.at:.2f} s: {self._who(event.robot)} leaves task '{task}' {left:.2f} s "
                "before the time that it said it would stay"
            )
        carried = [key for key, load in self._loads.items() if event.robot in load.carriers]
        is_on_roads = isinstance(self._map, Roads)  # where a load goes by the ways of one mover
        if not (carried and is_on_roads) and (blocked := self._ways.blocked(event)):
            self._blame(f"{event.at:.2f} s: {self._who(event.robot)} walks through {blocked}")
        robot.walk = event
        for key in carried if len(points) > 1 else ():
            self._loads[key].comes = event.journey.way[-1].at
            if not self._ways.can_carry(event, self._loads[key].carriers):
                who, task = self._who(event.robot), self._name(key)
                self._blame(f"{event.at:.2f} s: {who} carries '{task}' faster than all can who do")
        self._count(event.at)

    def _lift(self, event: Lifted) -> None:
        """Check that a load is taken up by who may, or set down where those are who carried it."""
        load, task = self._loads[event.task], self._name(event.task)
        if event.robots:
            worked = self._worked(event.task, event.at)
            is_there = all(self._is_by(robot, event.task, event.at) for robot in event.robots)
            if load.carriers or event.task in self._done or not is_there:
                self._blame(f"{event.at:.2f} s: '{task}' is taken up where it does not lie")
            if worked + A_TICK < self.tasks[event.task].duration:
                self._blame(f"{event.at:.2f} s: '{task}' is taken up without its service")
            load.left.append((event.at, load.at))
            load.carriers, load.taken_at, load.comes = set(event.robots), event.at, event.at
        else:
            if not self._is_with(load, event.place, event.at):
                self._blame(f"{event.at:.2f} s: '{task}' is set down where nobody carried it to")
            load.carried_until |= dict.fromkeys(load.carriers, event.at)
            load.carriers, load.at = set(), event.place
        for each in [each for each in self._able_since if each[0] == event.task]:
            del self._able_since[each]
        self._count(event.at)

    def _is_with(self, load: Load, place: Place, now: float) -> bool:
        """Say whether those who carry a load, or carried it a moment ago, are at a place."""
        reach = self.mission.radius + 1e-6
        walks = [self._robots[robot].walk for robot in load.carriers]
        if isinstance(self._map, Roads):  # it lies where they passed last
            passed = (walk.journey.way[walk.journey.passed(now)].place for walk in walks)
            return all(at == place for at in passed)
        return all(math.dist(self._ways.place(walk, now), place) <= reach for walk in walks)

    def _say(self, event: Said) -> None:
        robot = self._robots[event.robot]
        robot.word = event
        if event.phase >= READY:
            robot.stays_at, robot.stays_until = event.goal, event.at + event.hold
            robot.hold, robot.has_forgotten = event.hold, False
            if not self._stands_at(event.robot, event.goal, event.at):
                self._blame(
                    f"{event.at:.2f} s: {self._who(event.robot)} says it is at task "
                    f"'{self._name(event.goal)}', and is not"
                )

    def _work(self, event: Worked) -> None:
        robot = self._robots[event.robot]
        robot.work = (event.task, event.team)
        self._drop(event.at, event.robot, event.task)
        if event.task != NOBODY:
            self._begin(event, robot)
        self._count(event.at)

    def _begin(self, event: Worked, robot: TracedRobot) -> None:
        """Check that it makes sense for a robot to begin, by what the others there have said."""
        who, task = self._who(event.robot), self._name(event.task)
        if not self._stands_at(event.robot, event.task, event.at):
            self._blame(f"{event.at:.2f} s: {who} serves task '{task}' without being there")
        early = self._moments.opens(event.task) - event.at
        if early > A_TICK + DRIFT * self._moments.opens(event.task):
            self._blame(f"{event.at:.2f} s: {who} serves '{task}' {early:.2f} s before its window")
        late = event.at - self._moments.latest_start(event.task)
        slack = A_TICK + DRIFT * event.at
        if late > slack and not robot.has_restarted:
            self._blame(f"{event.at:.2f} s: {who} serves '{task}' {late:.2f} s too late to end it")
        is_in_shift = self._moments.is_in_shift(event.robot, event.task, event.at, slack)
        if not robot.has_restarted and not is_in_shift:
            self._blame(f"{event.at:.2f} s: {who} serves '{task}', for which its shift has no time")
        at_work = {n: it.work[0] for n, it in enumerate(self._robots) if not it.is_dead}
        off = {key for it in self._robots for key in it.off}
        if full := self._zones.full(event, at_work, off | self._done.keys()):
            self._blame(f"{event.at:.2f} s: {who} serves '{task}' without room in {full}")
        for other in self.mission.before.get(event.task, ()):
            if other not in self._done and other not in robot.off:
                self._blame(
                    f"{event.at:.2f} s: {who} serves '{task}' before '{self._name(other)}' is over"
                )
        if robot.off.get(event.task, event.at) + A_TICK < event.at:
            self._blame(f"{event.at:.2f} s: {who} serves '{task}' and knows that it is called off")
        if robot.word is not None and robot.word.phase >= HERE:
            said = (robot.word.goal, robot.word.team)
            if said[0] != event.task:
                self._blame(f"{event.at:.2f} s: {who} serves '{task}' but says it does another")
        bound = [
            number
            for number, other in enumerate(self._robots)
            if number == event.robot
            or (
                other.stays_at == event.task
                and other.stays_until + DRIFT * other.hold + A_TICK >= event.at
                and (other.has_forgotten or self._stands_at(number, event.task, event.at))
            )
        ]
        done_at = self._done.get(event.task)
        is_just_done = done_at is not None and event.at - done_at <= LATEST
        if not is_just_done and not self._covers(bound, event.task):
            self._blame(
                f"{event.at:.2f} s: {who} begins to serve task '{task}' although not all that it "
                "needs is bound to be there"
            )

    def _worked(self, key: int, now: float) -> float:
        """Return for how long an able team has been at work on a task that may begin."""
        since = [at for (task, _), at in self._able_since.items() if task == key]
        before = [self._done[k] for k in self.mission.before.get(key, ()) if k in self._done]
        return now - max([min(since, default=now + 1e9), self._moments.opens(key), *before])

    def _count(self, now: float) -> None:
        """Note since when each team has been able to do its task."""
        able = set(self._teams_at_work(now))
        for key in list(self._able_since):
            if key not in able:
                del self._able_since[key]
        for key in able:
            self._able_since.setdefault(key, now)

    def _teams_at_work(self, now: float) -> Iterator[tuple[int, int]]:
        """Return each (task, team) that has what the task needs, at work and there."""
        teams: dict[tuple[int, int], list[int]] = {}
        for number, robot in enumerate(self._robots):
            task = robot.work[0]
            if task != NOBODY and not robot.is_dead and self._is_by(number, task, now):
                teams.setdefault(robot.work, []).append(number)
        return (key for key, robots in teams.items() if self._covers(robots, key[0]))

    def _finish(self, event: Finished) -> None:
        task = self._name(event.task)
        if event.task in self._done:
            self._blame(f"{event.at:.2f} s: task '{task}' is done a second time")
        self._done[event.task] = event.at
        for number, robot in enumerate(self._robots):
            knows_since = robot.off.get(event.task, event.at)
            if robot.work[0] == event.task and event.at - knows_since > LATEST:
                who = self._who(number)
                self._blame(f"{event.at:.2f} s: {who} does '{task}' and knows that it is off")
        if event.task in self._loads:
            self._unload(event, self._loads[event.task])
            return
        if self._worked(event.task, event.at) + A_TICK < self.tasks[event.task].duration:
            self._blame(f"{event.at:.2f} s: task '{task}' is done without its service")

    def _unload(self, event: Finished, load: Load) -> None:
        """Check that a load is where it is to be brought, and was for the time of unloading."""
        task = self.tasks[event.task]
        assert task.to is not None
        if not self._covers(load.carriers, event.task) or not self._is_with(
            load, task.to, event.at
        ):
            self._blame(f"{event.at:.2f} s: load '{task.name}' is done and was not brought")
        if event.at - max(load.taken_at, load.comes) + A_TICK < task.unload:
            self._blame(f"{event.at:.2f} s: load '{task.name}' is done before it is unloaded")
        load.carriers, load.at = set(), task.to

    def _break(self, event: Broke) -> None:
        robot = self._robots[event.robot]
        if event.what == "crash":
            robot.is_dead = True
            self._drop(event.at, event.robot)
        elif event.what == "restart":
            robot.is_dead = False
            robot.work, robot.word = (NOBODY, NOBODY), None
            robot.has_forgotten = robot.has_restarted = True
            robot.off.clear()
        elif event.what == "resume":
            robot.resumed = event.at
        self._count(event.at)

    def _drop(self, now: float, robot: int, but: int = NOBODY) -> None:
        """Let a robot carry nothing more, but the load of a task; what it held is with the rest."""
        for key, load in self._loads.items():
            if key != but and robot in load.carriers and len(load.carriers) > 1:
                load.carriers.discard(robot)
                load.carried_until[robot] = now

    def _stands_at(self, number: int, key: int, now: float) -> bool:
        """Say whether a robot is at a task; at a load also if that has left not long ago.

        On roads a load lies behind those who set it down, as they go on to the next place.
        """
        left = self._loads[key].left if key in self._loads else []
        if isinstance(self._map, Roads) and key in self._loads and self._is_ahead(number, key, now):
            return True
        x, y = self._ways.place(self._robots[number].walk, now)
        reach = (self.mission.radius + 1e-9) ** 2
        was_here = any(
            (x - was_x) ** 2 + (y - was_y) ** 2 <= reach
            for until, (was_x, was_y) in left
            if now - max(until, self._robots[number].resumed) <= LATEST
        )
        return was_here or self._is_by(number, key, now)

    def _is_ahead(self, number: int, key: int, now: float) -> bool:
        """Say whether a robot has carried a load not long ago, and is no place further on."""
        load, way = self._loads[key], self._robots[number].walk.journey.way
        is_next = way[0].place == load.at and len(way) <= 2
        return is_next and now - load.carried_until.get(number, -2 * LATEST) <= LATEST

    def _is_by(self, number: int, key: int, now: float) -> bool:
        """Say whether a robot is at a task, or carries its load."""
        load = self._loads.get(key)
        if load is not None and load.carriers:
            return number in load.carriers
        return self._is_near(self._ways.place(self._robots[number].walk, now), key)

    def _is_near(self, place: Place, key: int) -> bool:
        """Say whether a place is at a task, or where its load lies."""
        load, (x, y) = self._loads.get(key), place
        to_x, to_y = (self.tasks[key].x, self.tasks[key].y) if load is None else load.at
        return (x - to_x) ** 2 + (y - to_y) ** 2 <= (self.mission.radius + 1e-9) ** 2

    def _covers(self, robots: Iterable[int], key: int) -> bool:
        counts = [self.mission.counts[robot] for robot in robots]
        has = [sum(column) for column in zip(*counts, strict=True)] if counts else []
        needs = self.tasks[key].needs
        return bool(has) and all(round(h - n, 3) >= 0 for h, n in zip(has, needs, strict=True))
