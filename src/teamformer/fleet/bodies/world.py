"""The world that simulated bodies share: robots walk, stand at tasks and do them.

Nothing happens between events, so places are worked out when they are asked for. Robots walk round
walls on a grid and straight on in a plane, at their own speed, through one another.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from teamformer.fleet.bodies.body import Command, Report
from teamformer.fleet.fleet_mission import Mission
from teamformer.fleet.messages import TaskFact
from teamformer.grid import Grid, Place
from teamformer.rules.constants import NOBODY
from teamformer.rules.distances import Distances, distance_fields

NEVER = float("inf")


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


@dataclass(frozen=True)
class Done:
    """A task was done at a time by a team: those robots were at work on it."""

    at: float
    key: int
    team: int
    robots: tuple[int, ...]


class FleetWorld:
    """All robots and tasks; `advance` lets time pass, which must never run backwards."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.now = 0.0
        self._is_grid = isinstance(mission.scenario.world, Grid)
        self.tasks: dict[int, TaskFact] = {task.key: task for task in mission.tasks}
        self.done: dict[int, Done] = {}
        self.robots = [
            SimulatedRobot(Leg([robot.at], 0.0, NEVER)) for robot in mission.scenario.robots
        ]
        self.walks: list[tuple[float, int, tuple[Place, ...], float, float]] = []
        self._services: dict[int, tuple[int, float]] = {}  # task: team at work, when it ends
        self._events: list[tuple[float, int, int, float]] = []  # when, robot or -1, task, stamp
        self._fields: dict[Place, Distances] = _fields_of(mission)

    def add_task(self, task: TaskFact) -> None:
        """Let there be another task."""
        self.tasks.setdefault(task.key, task)

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
                    self._look_at_services(self.robots[robot].command.task, touched)
            elif self._services.get(task, (0, NEVER))[1] == stamp:
                self._finish(task, touched)
        self.now = now
        return touched

    def command(self, robot: int, command: Command) -> set[int]:
        """Let a robot obey from now on; return the robots that sense something new."""
        body = self.robots[robot]
        touched: set[int] = set()
        if body.is_dead or command == body.command:
            return touched
        old, body.command = body.command, command
        if command.leg != old.leg or command.place != old.place:
            self._walk(robot)
            touched.add(robot)
        for task in {old.task, command.task}:
            self._look_at_services(task, touched)
        return touched

    def report(self, robot: int) -> Report:
        """Return what a robot senses now."""
        body = self.robots[robot]
        x, y = self.place(robot)
        command = body.command
        task, number = self.tasks.get(command.task), 1 + round(1000 * self.now)  # milliseconds
        if task is None or not self.mission.is_same_place(x, y, task.x, task.y):
            return Report(x, y, command.leg, number=number)
        team, _ = self._services.get(task.key, (command.team, 0.0))
        is_busy = team != command.team
        return Report(x, y, command.leg, task.key in self.done, is_busy, number)

    def place(self, robot: int) -> Place:
        """Return where a robot is now."""
        return self.robots[robot].leg.place(self.now, self._is_grid)

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
        if not self.robots[robot].is_dead:
            self._walk(robot)

    def at_work(self, key: int) -> Iterator[int]:
        """Return the robots that stand at a task, alive and told to serve it."""
        task = self.tasks[key]
        for robot, body in enumerate(self.robots):
            is_at_it = body.command.serve and body.command.task == key and not body.is_dead
            if is_at_it and self.mission.is_same_place(*self.place(robot), task.x, task.y):
                yield robot

    def _set_still(self, robot: int, is_dead: bool, is_stuck: bool = False) -> set[int]:
        body = self.robots[robot]
        place = self.place(robot)
        body.is_dead, body.is_stuck = is_dead, body.is_stuck or is_stuck
        self._set_leg(robot, [place], NEVER)
        touched: set[int] = set()
        self._look_at_services(body.command.task, touched)
        return touched

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
            way = [] if goal is None else self._way(here, goal)
            leg, at, begin = body.leg, body.leg.reached(self.now), self.now
            if way and at + 1 < len(leg.points) and way[0] == leg.points[at + 1]:
                begin = leg.begin + at * leg.time  # on the way there already
            self._set_leg(robot, [here, *way], 1.0 / pace, begin)

    def _set_leg(
        self, robot: int, points: list[Place], time: float, begin: float | None = None
    ) -> None:
        leg = Leg(points, self.now if begin is None else begin, time if len(points) > 1 else NEVER)
        self.robots[robot].leg = leg
        self.walks.append((self.now, robot, tuple(points), leg.begin, leg.time))
        if leg.time != NEVER:
            heapq.heappush(self._events, (leg.end, robot, NOBODY, leg.end))

    def _way(self, here: Place, goal: Place) -> list[Place]:
        """Return the cells of a shortest way, first along the axis with more to go."""
        if goal not in self._fields:
            world = self.mission.scenario.world
            assert isinstance(world, Grid)
            self._fields[goal] = distance_fields(world, [goal])[0]
        away = self._fields[goal]
        cells: list[Place] = []
        height, width = away.shape
        x, y = int(here[0]), int(here[1])
        goal_x, goal_y = int(goal[0]), int(goal[1])
        left = int(away[y, x])
        while left > 0 and left < 2**29:
            along_x, along_y = abs(goal_x - x) >= abs(goal_y - y), (goal_y > y) * 2 - 1
            towards_x = (goal_x > x) * 2 - 1
            sides = [(towards_x, 0), (0, along_y), (0, -along_y), (-towards_x, 0)]
            for dx, dy in sides if along_x else [sides[1], sides[0], sides[3], sides[2]]:
                to_x, to_y = x + dx, y + dy
                if 0 <= to_x < width and 0 <= to_y < height and away[to_y, to_x] == left - 1:
                    x, y, left = to_x, to_y, left - 1
                    cells.append((x, y))
                    break
        return cells

    def _look_at_services(self, key: int, touched: set[int]) -> None:
        """Begin or break off the service of a task, by who is at work on it now."""
        if key not in self.tasks or key in self.done:
            return
        teams: dict[int, list[int]] = {}
        for robot in self.at_work(key):
            teams.setdefault(self.robots[robot].command.team, []).append(robot)
        needs = self.tasks[key].needs
        able = [team for team, who in sorted(teams.items()) if self.mission.covers(who, needs)]
        going = self._services.get(key)
        if going is not None and going[0] not in able:
            del self._services[key]
            going = None
        if going is None and able:
            end = self.now + self.tasks[key].duration
            self._services[key] = (able[0], end)
            heapq.heappush(self._events, (end, NOBODY, key, end))

    def _finish(self, key: int, touched: set[int]) -> None:
        team, _ = self._services.pop(key)
        who = tuple(r for r in self.at_work(key) if self.robots[r].command.team == team)
        self.done[key] = Done(self.now, key, team, who)
        task = self.tasks[key]
        for robot, body in enumerate(self.robots):
            place = body.leg.place(self.now, self._is_grid)
            if self.mission.is_same_place(*place, task.x, task.y):
                touched.add(robot)


_FIELDS: dict[int, dict[Place, Distances]] = {}


def _fields_of(mission: Mission) -> dict[Place, Distances]:
    """Return the distance fields of a mission's map, shared by all its worlds."""
    return _FIELDS.setdefault(mission.number, {})
