"""Batteries and chargers, and how far it is between chargers and where robots go."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING

from teamformer.mission.parts.grid import FREE, Grid, Place
from teamformer.mission.parts.places import possible_places
from teamformer.mission.parts.regions import walks
from teamformer.mission.parts.roads import AIR, Roads

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Robot, Task, World

ROUNDING = 1e-9
"""By such a share of a full battery what is left may be short, as sums are rounded."""


@dataclass(frozen=True)
class Battery:
    """What a robot has to spend, in units of time that it walks alone: full it `lasts` so long.

    From empty to full takes `fills`. A unit of time at a task takes `serving`, one in which it
    waits or forms at a task `waiting`. It `starts` with a share of what it holds.
    """

    lasts: float
    fills: float
    starts: float = 1.0
    serving: float = 0.0
    waiting: float = 0.0

    def in_longer_units(self, times: float) -> Battery:
        """Return the battery of a robot that is slower by a factor and still gets as far."""
        lasts, serving, waiting = (
            times * spent for spent in (self.lasts, self.serving, self.waiting)
        )
        return replace(self, lasts=lasts, serving=serving, waiting=waiting)

    def time_to_full(self, left: float) -> float:
        """Return how long it charges with so much left."""
        return (self.lasts - left) / self.lasts * self.fills

    def spent_on(self, task: Task, carried: float = 0.0) -> float:
        """Return what a task takes, as long as it is believed to last, its load carried so long."""
        return self.serving * (task.duration + task.unload) + carried

    def suffices(self, left: float, spent: float) -> bool:
        """Say whether what is left is enough for something."""
        return spent <= left + ROUNDING * self.lasts


@dataclass(frozen=True)
class Charger:
    """A place at which so many robots charge at once as it has `room` for."""

    at: Place
    room: int = 1


@dataclass(frozen=True)
class Charging:
    """Which tasks the robots of a mission with batteries can do, if they charge where they may."""

    mission: Mission

    @cached_property
    def _places(self) -> list[Place]:
        return [charger.at for charger in self.mission.chargers]

    @cached_property
    def _ways(self) -> Mapping[str, ChargerWays]:
        return {
            moves: self._ways_of(moves)
            for moves in {robot.moves for robot in self.mission.robots if robot.battery}
        }

    def _ways_of(self, moves: str) -> ChargerWays:
        world = self.mission.world
        begins, ends = [spot[1] for spot in self._spots], [spot[2] for spot in self._spots]
        starts = [robot.at for robot in self.mission.robots]
        homes = starts if not isinstance(self.mission.ends, tuple) else [self.mission.ends]
        places = self._places
        return ChargerWays(
            between=lengths(world, moves, places, places),
            to_spot=lengths(world, moves, places, begins),
            from_spot=lengths(world, moves, ends, places),
            from_start=lengths(world, moves, starts, places),
            to_home=lengths(world, moves, places, homes),
        )

    def in_reach(self, number: int) -> set[int]:
        """Return the chargers that a robot gets to from where it starts, from one to the next."""
        robot = self.mission.robots[number]
        battery, ways = robot.battery, self._ways[robot.moves]
        assert battery is not None
        left = battery.starts * battery.lasts
        start = ways.from_start[number]
        found = {
            c
            for c, way in enumerate(start)
            if battery.suffices(left, way / walks_at(self.mission, robot))
        }
        fresh = set(found)
        while fresh:
            fresh = {
                other
                for charger in fresh
                for other, way in enumerate(ways.between[charger])
                if battery.suffices(battery.lasts, way / walks_at(self.mission, robot))
            } - found
            found |= fresh
        return found

    @cached_property
    def _able(self) -> list[set[int]]:
        """Return by robot the tasks that it can do and then get to a charger, from full."""
        return [
            set(range(len(self.mission.tasks))) if robot.battery is None else self._doable(number)
            for number, robot in enumerate(self.mission.robots)
        ]

    def _doable(self, number: int) -> set[int]:
        robot = self.mission.robots[number]
        battery, ways, chargers = robot.battery, self._ways[robot.moves], self.in_reach(number)
        assert battery is not None
        undoable = set()
        for spot, (task, _, _) in enumerate(self._spots):
            there = min((ways.to_spot[charger][spot] for charger in chargers), default=math.inf)
            way = there + min(ways.from_spot[spot], default=math.inf)
            spent = battery.spent_on(self.mission.tasks[task], self._carried[spot])
            if not battery.suffices(battery.lasts, way / walks_at(self.mission, robot) + spent):
                undoable.add(task)
        return set(range(len(self.mission.tasks))) - undoable

    @cached_property
    def _spots(self) -> list[tuple[int, Place, Place]]:
        """Return the places that each task may be at, with its number and where it ends then."""
        world = self.mission.world
        return [
            (number, place, task.to or place)
            for number, task in enumerate(self.mission.tasks)
            for place in (
                possible_places(world, task.at, task.within) if task.within else (task.at,)
            )
        ]

    @cached_property
    def _carried(self) -> list[float]:
        """Return how long loads are on their way at most, by spot; 0 for what is no load."""
        world = self.mission.world
        far = cache(lambda moves, here, goal: lengths(world, moves, [here], [goal])[0][0])

        def way(robot: int, here: Place, goal: Place) -> float:
            mover = self.mission.robots[robot]
            return float(far(mover.moves, here, goal)) / walks_at(self.mission, mover)

        tasks = self.mission.tasks
        return [longest_carry(self.mission, tasks[k], at, way) for k, at, _ in self._spots]

    def carried(self, task: int) -> float:
        """Return how long the load of a task is on its way at most; 0 for what is no load."""
        rows = zip(self._spots, self._carried, strict=True)
        return max((takes for (number, _, _), takes in rows if number == task), default=0.0)

    def is_able(self, robot: int, task: int) -> bool:
        """Say whether a robot can do a task and get to a charger, if it begins with a full one."""
        return task in self._able[robot]

    def wanted(self, number: int) -> list[float]:
        """Return what a robot has to have left at each task, wherever it is, to do it and charge.

        All is 0 for one without a battery.
        """
        robot, tasks = self.mission.robots[number], self.mission.tasks
        least = [0.0] * len(tasks)
        if robot.battery is None:
            return least
        ways, pace = self._ways[robot.moves], walks_at(self.mission, robot)
        spots = zip(self._spots, self._carried, ways.from_spot, strict=True)
        for (task, _, _), carried, away in spots:
            spent = robot.battery.spent_on(tasks[task], carried)
            least[task] = max(least[task], spent + min(away, default=math.inf) / pace)
        return least

    def able(self, robots: Iterable[int], task: int) -> list[int]:
        """Return those of some robots that can do a task."""
        return [robot for robot in robots if self.is_able(robot, task)]

    def gets_home(self, number: int) -> bool:
        """Say whether a full robot gets from some charger to where it ends."""
        robot = self.mission.robots[number]
        battery, homes = robot.battery, self._ways[robot.moves].to_home
        assert battery is not None
        home = 0 if isinstance(self.mission.ends, tuple) else number
        ways = (homes[charger][home] for charger in self.in_reach(number))
        return any(
            battery.suffices(battery.lasts, way / walks_at(self.mission, robot)) for way in ways
        )


def walks_at(mission: Mission, robot: Robot) -> float:
    """Return how far a robot walks in a unit of time, or in a step."""
    return mission.world.pace(robot.speed) if mission.time == "steps" else robot.speed


@dataclass(frozen=True)
class ChargerWays:
    """How far it is for robots that move alike, infinite where no way leads; rows are origins."""

    between: Sequence[Sequence[float]]
    to_spot: Sequence[Sequence[float]]
    from_spot: Sequence[Sequence[float]]
    from_start: Sequence[Sequence[float]]
    to_home: Sequence[Sequence[float]]


def longest_carry(
    mission: Mission, task: Task, here: Place, way: Callable[[int, Place, Place], float]
) -> float:
    """Return how long a load is on its way that the slowest carries who may take part.

    It lies `here`, and `way(robot, here, goal)` is how long a robot takes. 0 for what is no load.
    """
    if task.to is None:
        return 0.0
    able = [n for n, robot in enumerate(mission.robots) if task.needs.keys() & robot.can.keys()]
    takes = (way(robot, here, task.to) for robot in able)
    return max((one for one in takes if math.isfinite(one)), default=0.0)


def lengths(
    world: World, moves: str, origins: Sequence[Place], goals: Sequence[Place]
) -> list[list[float]]:
    """Return how far it is from each origin to each goal, infinite where no way leads."""
    if isinstance(world, Roads):
        rows = world.ways[moves]
        return [[rows[int(a)][int(b)] for b, _ in goals] for a, _ in origins]
    if not isinstance(world, Grid):
        return [[math.dist(a, b) for b in goals] for a in origins]
    if moves == AIR or not world.rows:
        return [[float(abs(a[0] - b[0]) + abs(a[1] - b[1])) for b in goals] for a in origins]
    is_turned = len(origins) > len(goals)  # a walk is as long there as back
    begins, ends = (goals, origins) if is_turned else (origins, goals)
    cells = [(int(x), int(y)) for x, y in ends]
    table = [walks(world.rows, FREE, (int(x), int(y)), cells) for x, y in begins]
    return [list(column) for column in zip(*table, strict=True)] if is_turned else table


def who_is_able(mission: Mission, robots: Sequence[int], task: int) -> Sequence[int]:
    """Return those of some robots whose batteries suffice for a task; in steps those of all do."""
    charging = mission.charging
    if charging is None or mission.time == "steps":
        return robots
    return charging.able(robots, task)


def has_batteries(robots: Iterable[Robot]) -> bool:
    """Say whether any robot has a battery."""
    return any(robot.battery is not None for robot in robots)
