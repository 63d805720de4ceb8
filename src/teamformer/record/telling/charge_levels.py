"""How full batteries are after each step, by what the robots of a record did in it."""

from __future__ import annotations

from teamformer.mission.parts.charging import Battery
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.record.phases import (
    CHARGING,
    FORMING,
    LOADING,
    SERVING,
    UNLOADING,
    WAITING,
    is_same_place,
)
from teamformer.record.record import FLEET, Record
from teamformer.record.telling.unrolled import Unrolled
from teamformer.record.told.told_record import Level
from teamformer.world.reference.ways import PlainWays, apart
from teamformer.world.rules.constants import NOBODY

UNSEEN = 2.0
"""Steps of charging at most that snapshots of a fleet do not show."""


class LevelsInSteps:
    """How full each battery is since when, and how much that changes in a step; by robot."""

    def __init__(self, record: Record, now: Unrolled) -> None:
        self._mission, world = record.true_mission, record.mission.world
        assert isinstance(world, Grid | Plane)
        self._is_plane, self._ways = isinstance(world, Plane), PlainWays(world)
        robots = self._mission.robots
        self._batteries = {n: robot.battery for n, robot in enumerate(robots) if robot.battery}
        self._left = {n: own.starts * own.lasts for n, own in self._batteries.items()}
        self._places = {robot: now.teams.place(robot) for robot in self._batteries}
        self._charging: set[int] = set()
        self._is_seen = record.method == FLEET
        self.rows: list[list[Level]] = [[] for _ in robots]

    def go_on(self, now: Unrolled) -> None:
        """Take in the step that the unrolled has gone on to."""
        for robot, battery in self._batteries.items():
            before, self._places[robot] = self._places[robot], now.teams.place(robot)
            if self._is_seen and self._is_full_now(now, robot, battery):
                self._left[robot] = battery.lasts
            change = self._change(now, robot, battery, before)
            full, row = self._left[robot] / battery.lasts, self.rows[robot]
            self._left[robot] = min(battery.lasts, max(0.0, self._left[robot] + change))
            rate = (self._left[robot] / battery.lasts) - full
            if not row or abs(row[-1].rate - rate) > 1e-9:
                row.append(Level(now.steps - 1, full, rate))

    def _is_full_now(self, now: Unrolled, robot: int, battery: Battery) -> bool:
        """Say whether a robot of a fleet has just been charged.

        What a fleet is seen to do begins and ends within steps, so two of them may be lacking.
        """
        was_charging = robot in self._charging
        is_charging = now.at_chargers.get(robot) == CHARGING
        (self._charging.add if is_charging else self._charging.discard)(robot)
        lacks = battery.time_to_full(self._left[robot])
        return was_charging and not is_charging and lacks <= UNSEEN

    def _change(self, now: Unrolled, robot: int, battery: Battery, before: Place) -> float:
        """Return by how much what a robot has left has changed in a step."""
        if now.teams.slot[robot] == NOBODY:
            return 0.0
        doing, task = now.phases.of(now.teams, robot)
        at, it = self._places[robot], self._mission.robots[robot]
        if at != before:
            length = apart(before, at) if self._is_plane else self._ways.length(before, at, False)
            return -length / self._mission.world.pace(it.speed)
        if doing == CHARGING:
            return battery.lasts / battery.fills if battery.fills else battery.lasts
        if doing in (SERVING, LOADING, UNLOADING):
            return -battery.serving
        mates = now.teams.robots[now.teams.slot[robot]]
        if doing not in (WAITING, FORMING) or not now.at_chargers.keys().isdisjoint(mates):
            return 0.0
        is_there = task != NOBODY and is_same_place(self._mission, at, now.goals[task])
        return -battery.waiting if is_there else 0.0
