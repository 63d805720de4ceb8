"""Robots that walk in the world that simulated bodies share, and stand still.

They go the ways of the mission's world, at their own speed, through one another; who is delayed
stands still now and then. On roads nobody turns round between two places.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

from teamformer.fleet.bodies.journey import Journey
from teamformer.fleet.bodies.simulated import SimulatedRobot
from teamformer.fleet.fleet_mission import FleetMission
from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.continuous.delays import StandingStill
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.continuous.pauses import with_pauses
from teamformer.world.continuous.ways import Stage
from teamformer.world.rules.constants import NOBODY

NEVER = float("inf")


class Walked(NamedTuple):
    """A robot set out on a way, or stays where it is: at a place, or stopped between two."""

    at: float
    robot: int
    journey: Journey
    carries: int = NOBODY  # the task whose load it carries


class Lifted(NamedTuple):
    """A load was taken up by robots at a place, or, by nobody, set down there."""

    at: float
    task: int
    robots: tuple[int, ...]
    place: Place


class WalkingWorld:
    """All robots on their ways; `moves` has what they did, for who writes it down."""

    def __init__(self, mission: FleetMission, truth: Mission | None) -> None:
        self.mission = mission
        self.now = 0.0
        self._map = mission.source.world
        self._still = StandingStill((truth or mission.source).robots)
        self.robots = [
            SimulatedRobot(Journey((Passed(0.0, robot.at),))) for robot in mission.source.robots
        ]
        self.moves: list[Walked | Lifted | Event] = []  # events are those of services
        self._events: list[tuple[float, int, int, float]] = []  # when, robot or -1, task, stamp

    def place(self, robot: int) -> Place:
        """Return where a robot is now."""
        return self.robots[robot].journey.place(self.now, self._map)

    def walk(self, robot: int) -> None:
        """Begin the way to where the command says; half a cell is lost where it turns.

        On roads it goes on to the next place first, even if it is to stay.
        """
        body, goal = self.robots[robot], self.robots[robot].command.place
        if body.is_stuck:
            self.stop(robot)
            return
        begin = body.journey.beginning(self.now, self._map)
        here, mover = begin[-1].place, self.mission.source.robots[robot]
        stages: list[Stage] = []
        if goal is not None and self.mission.leads(robot, here, goal):
            stages = self.mission.ways.stages(here, goal, mover.moves)
        way, at = body.journey.way, body.journey.passed(self.now)
        is_grid = isinstance(self._map, Grid)
        if is_grid and stages and at + 1 < len(way) and stages[0][0] == way[at + 1].place:
            begin = (way[at],)  # on the way there already
        pace = self.mission.paces[robot]
        rest = self.passing((robot,), begin[-1].at, [(p, d / pace) for p, d in stages])
        self.set_out(robot, Journey((*begin, *self._with_pauses(robot, begin[-1], tuple(rest)))))

    def _with_pauses(self, robot: int, start: Passed, ahead: Sequence[Passed]) -> list[Passed]:
        """Return a way with its pauses between shifts; nothing if the last is over before."""
        real = self.mission.source.robots[robot]
        if not ahead or not math.isfinite(ahead[-1].at):
            return []
        step, is_even = self.mission.step, isinstance(self._map, Plane) and real.delays is None
        start, *rest = (passed._replace(at=passed.at / step) for passed in (start, *ahead))
        paused = with_pauses(real.rota, start, rest, is_even)
        return (
            [passed._replace(at=passed.at * step) for passed in paused] if real.rota else [*ahead]
        )

    def passing(
        self, who: Sequence[int], begin: float, stages: Iterable[Stage]
    ) -> Iterator[Passed]:
        """Yield when robots that go together pass places; delays come in whole steps."""
        step, robots = self.mission.step, [self.mission.source.robots[robot] for robot in who]
        for place, spent in stages:
            at = begin + spent
            if any(robot.delays or robot.rota for robot in robots):
                at = step * self._still.after(who, begin / step, spent / step)
            yield Passed(at, place)

    def stop(self, robot: int) -> None:
        """Let a robot stay where it is."""
        self.set_out(robot, self.robots[robot].journey.stop(self.now, self._map))

    def set_out(self, robot: int, journey: Journey) -> None:
        """Let a robot be on a way from now on."""
        self.robots[robot].journey = journey
        self.moves.append(Walked(self.now, robot, journey, self.robots[robot].carries))
        if journey.end < NEVER:
            heapq.heappush(self._events, (journey.end, robot, NOBODY, journey.end))
