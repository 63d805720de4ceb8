"""The world that simulated bodies share: robots walk, stand at tasks, do them, and carry loads.

Nothing happens between events, so places are worked out when they are asked for. Robots walk round
walls on a grid and straight on in a plane, at their own speed, through one another. Who carries a
load goes at the pace of the slowest who do, and stands still if one of them is stuck.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.fleet.messages import TaskFact
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.world.rules.constants import NOBODY

NEVER = float("inf")

OPENS, OFF = -1.0, -2.0
"""Stand at the end of events that are the begin of a task's window, and that it is called off."""

SERVICE, CARRIED, UNLOADING = range(3)
"""The parts of a service: the service itself, which for a load is taking it up, and what follows
where there is one."""


@dataclass(slots=True)
class Leg:
    """A way through points, each `time` seconds after the one before."""

    points: list[Place]
    begin: float
    time: float

    def reached(self, now: float) -> int:
        """Return which point was reached last."""
        if self.time == NEVER:
            return 0
        passed = math.floor((now - self.begin) / self.time + 1e-9)
        return min(max(0, passed), len(self.points) - 1)

    def place(self, now: float, is_grid: bool) -> Place:
        """Return where a robot is on its way: in a cell of a grid, anywhere in a plane."""
        at = self.reached(now)
        here = self.points[at]
        if is_grid or at == len(self.points) - 1:
            return here
        there, part = self.points[at + 1], (now - self.begin) / self.time - at
        return here[0] + part * (there[0] - here[0]), here[1] + part * (there[1] - here[1])

    @property
    def end(self) -> float:
        """Return when the last point is reached."""
        return self.begin + (len(self.points) - 1) * self.time


@dataclass(slots=True)
class SimulatedRobot:
    """A robot as it really is."""

    leg: Leg
    command: Command = field(default_factory=Command)
    is_dead: bool = False
    is_stuck: bool = False
    carries: int = NOBODY  # the task whose load it carries or unloads


class Walked(NamedTuple):
    """A robot set out through places, each `time` seconds after the one before."""

    at: float
    robot: int
    points: tuple[Place, ...]
    begin: float
    time: float


class Lifted(NamedTuple):
    """A load was taken up by robots at a place, or, by nobody, set down there."""

    at: float
    task: int
    robots: tuple[int, ...]
    place: Place


class WorkUnderWay(NamedTuple):
    """A team is at work on a task; the part at hand ends at a time."""

    team: int
    end: float
    part: int = SERVICE


@dataclass(frozen=True)
class Done:
    """A task was done at a time by a team: those robots were at work on it."""

    at: float
    key: int
    team: int
    robots: tuple[int, ...]


class FleetWorld:
    """All robots and tasks; `advance` lets time pass, which must never run backwards.

    `truth` is the mission as it really is, where something of it is uncertain.
    """

    def __init__(self, mission: FleetMission, truth: Mission | None = None) -> None:
        self.mission = mission
        self.now = 0.0
        self._is_grid = isinstance(mission.source.world, Grid)
        facts = mission.tasks if truth is None else mission.facts_of(truth)
        self.tasks: dict[int, TaskFact] = {task.key: task for task in facts}
        self.done: dict[int, Done] = {}
        self.over: set[int] = set()  # what is done or called off
        self.robots = [
            SimulatedRobot(Leg([robot.at], 0.0, NEVER)) for robot in mission.source.robots
        ]
        self.moves: list[Walked | Lifted] = []
        self._lies: dict[int, Place] = {}  # loads that were moved, by task
        self._ways_of_loads: dict[int, Leg] = {}  # of those that are carried
        self._services: dict[int, WorkUnderWay] = {}  # by task
        # When, robot or -1, task, stamp.
        self._events = [(at, NOBODY, key, OPENS) for key, at in mission.opens.items()]
        self._events += [(at, NOBODY, key, OFF) for key, at in mission.off_at.items()]
        heapq.heapify(self._events)

    def add_task(self, task: TaskFact) -> None:
        """Let there be another task."""
        self.tasks.setdefault(task.key, task)

    def call_off(self, key: int) -> None:
        """Let a task be called off: what comes after it may begin; who does not know may do it."""
        self._end(key)

    def _end(self, key: int) -> None:
        self.over.add(key)
        for other, before in self.mission.before.items():
            if key in before:
                self._look_at_services(other)

    @property
    def is_over(self) -> bool:
        """Say whether every task is done or called off."""
        return self.tasks.keys() <= self.over

    @property
    def next_event(self) -> float:
        """Return when a robot arrives or a task is done next; inf for never."""
        return self._events[0][0] if self._events else NEVER

    def advance(self, now: float) -> set[int]:
        """Let time pass; return the robots that sense something new."""
        touched: set[int] = set()
        while self._events and self._events[0][0] <= now:
            self.now, robot, task, stamp = heapq.heappop(self._events)
            if robot != NOBODY:
                if self.robots[robot].leg.end == stamp:
                    touched.add(robot)
                    self._look_at_services(self.robots[robot].command.task)
            elif stamp == OPENS:
                self._look_at_services(task)
            elif stamp == OFF:
                self.call_off(task)
            elif task in self._services and self._services[task].end == stamp:
                self._go_on(task, touched)
        self.now = now
        return touched

    def command(self, robot: int, command: Command) -> set[int]:
        """Let a robot obey from now on; return the robots that sense something new."""
        body = self.robots[robot]
        touched: set[int] = set()
        if body.is_dead or command == body.command:
            return touched
        old, body.command = body.command, command
        if body.carries != NOBODY and not self._is_at_work(robot, body.carries):
            self._let_go(robot, touched)
        if (command.leg, command.place) != (old.leg, old.place) and body.carries == NOBODY:
            self._walk(robot)
            touched.add(robot)
        for task in {old.task, command.task}:
            self._look_at_services(task)
        return touched

    def report(self, robot: int) -> Report:
        """Return what a robot senses now."""
        body = self.robots[robot]
        x, y = self.place(robot)
        command = body.command
        task, number = self.tasks.get(command.task), 1 + round(1000 * self.now)  # milliseconds
        if task is None:
            return Report(x, y, command.leg, number=number)
        at, service = self.place_of(task.key), self._services.get(task.key)
        is_here = self.mission.is_same_place(x, y, *at)
        is_done = is_here and task.key in self.done
        is_busy = is_here and service is not None and service.team != command.team
        report = Report(x, y, command.leg, is_done, is_busy, number)
        if is_here and task.key in self.mission.unsure:
            report = report._replace(needs=task.needs)
        if task.key in self.mission.hidden:
            is_seen = math.dist((x, y), at) <= self.mission.source.finding_radius
            return report._replace(load=at if is_seen else None, is_gone=not is_here)
        if task.to is None:
            return report
        if body.carries == task.key:
            return report._replace(carries=True)
        if task.key in self._ways_of_loads:  # others have it
            return report._replace(is_gone=True)
        is_seen = is_here or math.dist((x, y), at) <= self.mission.sight
        return report._replace(load=at if is_seen else None, is_gone=not is_here)

    def place(self, robot: int) -> Place:
        """Return where a robot is now."""
        return self.robots[robot].leg.place(self.now, self._is_grid)

    def place_of(self, key: int) -> Place:
        """Return where a task is, or where its load is now."""
        if key in self._ways_of_loads:
            return self._ways_of_loads[key].place(self.now, self._is_grid)
        task = self.tasks[key]
        return self._lies.get(key, (task.x, task.y))

    def kill(self, robot: int) -> set[int]:
        """Let a robot break down where it is."""
        return self._set_still(robot, is_dead=True)

    def revive(self, robot: int) -> None:
        """Let a robot start anew where it broke down."""
        body = self.robots[robot]
        body.is_dead, body.command = False, Command()

    def hold_fast(self, robot: int) -> set[int]:
        """Let a robot be unable to move."""
        return self._set_still(robot, is_dead=self.robots[robot].is_dead, is_stuck=True)

    def let_go(self, robot: int) -> None:
        """Let a robot move again, on to where it was told to go."""
        self.robots[robot].is_stuck = False
        if self.robots[robot].carries != NOBODY:
            self._carry(self.robots[robot].carries)
        elif not self.robots[robot].is_dead:
            self._walk(robot)

    def at_work(self, key: int) -> Iterator[int]:
        """Return the robots that stand at a task or carry its load, alive and told to serve it."""
        at = self.place_of(key)
        is_up = key in self._ways_of_loads
        for robot, body in enumerate(self.robots):
            if not self._is_at_work(robot, key):
                continue
            is_at_it = self.mission.is_same_place(*self.place(robot), *at)
            if body.carries == key if is_up else is_at_it:
                yield robot

    def _is_at_work(self, robot: int, key: int) -> bool:
        body = self.robots[robot]
        return body.command.serve and body.command.task == key and not body.is_dead

    def _set_still(self, robot: int, is_dead: bool, is_stuck: bool = False) -> set[int]:
        body = self.robots[robot]
        place, touched = self.place(robot), set[int]()
        body.is_dead, body.is_stuck = is_dead, body.is_stuck or is_stuck
        self._set_leg(robot, [place], NEVER)
        if body.carries != NOBODY and is_dead:
            self._let_go(robot, touched)
        elif body.carries != NOBODY:
            self._carry(body.carries)
        self._look_at_services(body.command.task)
        return touched

    def _carry(self, key: int) -> None:
        """Have those who carry a load go on with it from where it is."""
        who, here, to = list(self.at_work(key)), self.place_of(key), self.tasks[key].to
        assert to is not None
        team, pace = self.robots[who[0]].command.team, min(self.mission.paces[r] for r in who)
        if here == to or self._services[key].part == UNLOADING:
            return
        points = [here, *(self.mission.ways.cells(here, to) if self._is_grid else [to])]
        time = 1.0 / pace if self._is_grid else math.dist(here, to) / pace
        if any(self.robots[robot].is_stuck for robot in who):
            points, time = [here], NEVER
        self._ways_of_loads[key] = way = Leg(points, self.now, time)
        for robot in who:
            at = self.place(robot)
            self._set_leg(robot, [at, *points[1:]], time)
        self._begin(key, WorkUnderWay(team, NEVER if time == NEVER else way.end, CARRIED))

    def _let_go(self, robot: int, touched: set[int]) -> None:
        """Let a robot carry no more: the others go on if they can, or set the load down."""
        key, body = self.robots[robot].carries, self.robots[robot]
        body.carries = NOBODY
        self._set_leg(robot, [self.place(robot)], NEVER)
        who = [other for other, each in enumerate(self.robots) if each.carries == key]
        touched.update((robot, *who))
        if self.mission.covers(who, self.tasks[key].needs):
            self._carry(key)
            return
        self._lies[key] = self.place_of(key)
        del self._ways_of_loads[key], self._services[key]
        for other in who:
            self.robots[other].carries = NOBODY
            self._set_leg(other, [self.place(other)], NEVER)
        self.moves.append(Lifted(self.now, key, (), self._lies[key]))

    def _begin(self, key: int, service: WorkUnderWay) -> None:
        """Begin a part of a service."""
        self._services[key] = service
        if service.end < NEVER:
            heapq.heappush(self._events, (service.end, NOBODY, key, service.end))

    def _walk(self, robot: int) -> None:
        """Begin the way to where the command says; half a cell is lost where it turns."""
        body, goal = self.robots[robot], self.robots[robot].command.place
        here, pace = self.place(robot), self.mission.paces[robot]
        if body.is_stuck:
            self._set_leg(robot, [here], NEVER)
        elif not self._is_grid:
            points = [here] if goal is None or goal == here else [here, goal]
            self._set_leg(robot, points, math.dist(here, goal or here) / pace)
        else:
            way = [] if goal is None else self.mission.ways_of(robot).cells(here, goal)
            leg, at, begin = body.leg, body.leg.reached(self.now), self.now
            if way and at + 1 < len(leg.points) and way[0] == leg.points[at + 1]:
                begin = leg.begin + at * leg.time  # on the way there already
            self._set_leg(robot, [here, *way], 1.0 / pace, begin)

    def _set_leg(
        self, robot: int, points: list[Place], time: float, begin: float | None = None
    ) -> None:
        leg = Leg(points, self.now if begin is None else begin, time if len(points) > 1 else NEVER)
        self.robots[robot].leg = leg
        self.moves.append(Walked(self.now, robot, tuple(points), leg.begin, leg.time))
        if leg.time != NEVER:
            heapq.heappush(self._events, (leg.end, robot, NOBODY, leg.end))

    def _look_at_services(self, key: int) -> None:
        """Begin or break off the service of a task, by who is at work on it now."""
        if key not in self.tasks or key in self.done or key in self._ways_of_loads:
            return
        teams: dict[int, list[int]] = {}
        for robot in self.at_work(key):
            teams.setdefault(self.robots[robot].command.team, []).append(robot)
        needs = self.tasks[key].needs
        able = [team for team, who in sorted(teams.items()) if self.mission.covers(who, needs)]
        going = self._services.get(key)
        if going is not None and going.team not in able:
            del self._services[key]
            going = None
        if going is None and able and self.mission.may_begin(key, self.over, self.now):
            self._begin(key, WorkUnderWay(able[0], self.now + self.tasks[key].duration))

    def _go_on(self, key: int, touched: set[int]) -> None:
        """Go on with what follows a part of a service."""
        task, (team, _, part) = self.tasks[key], self._services[key]
        if part == SERVICE and task.to is not None:
            self._take_up(key, touched)
        if task.to is None or part == UNLOADING:
            self._finish(key, touched)
        elif self.place_of(key) == task.to:
            self._begin(key, WorkUnderWay(team, self.now + task.unload, UNLOADING))

    def _take_up(self, key: int, touched: set[int]) -> None:
        """Let those who have taken up a load set out with it; all who are there sense it."""
        team, here = self._services[key].team, self.place_of(key)
        who = tuple(r for r in self.at_work(key) if self.robots[r].command.team == team)
        self._touch(here, touched)
        self._ways_of_loads[key] = Leg([here], self.now, NEVER)
        for robot in who:
            self.robots[robot].carries = key
        self.moves.append(Lifted(self.now, key, who, here))
        self._carry(key)

    def _finish(self, key: int, touched: set[int]) -> None:
        team, place = self._services.pop(key).team, self.place_of(key)
        who = tuple(r for r in self.at_work(key) if self.robots[r].command.team == team)
        self.done[key] = Done(self.now, key, team, who)
        self._end(key)
        if self._ways_of_loads.pop(key, None) is not None:
            self._lies[key] = place
            for robot in who:
                self.robots[robot].carries = NOBODY
        self._touch(place, touched)

    def _touch(self, place: Place, touched: set[int]) -> None:
        """Let all sense something new who are at a place."""
        for robot in range(len(self.robots)):
            if self.mission.is_same_place(*self.place(robot), *place):
                touched.add(robot)
