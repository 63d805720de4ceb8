"""How full batteries are, by what events say that robots do: that changes evenly in between."""

from __future__ import annotations

from teamformer.mission.parts.charging import Battery
from teamformer.record.events.runs import Runs
from teamformer.record.phases import (
    AT_WORK,
    CARRYING,
    CHARGING,
    FORMING,
    WAITING,
    WALKING,
)
from teamformer.record.record import Record
from teamformer.record.told.told_record import Level
from teamformer.world.continuous.delays import StandingStill
from teamformer.world.continuous.events import Event


class ChargeLevels:
    """How full each battery is since when, and how fast that changes; no rows without a battery."""

    def __init__(self, record: Record, runs: Runs) -> None:
        robots = record.true_mission.robots
        self._batteries = {n: robot.battery for n, robot in enumerate(robots) if robot.battery}
        self._runs, self._still = runs, StandingStill(robots)
        self.rows: list[list[Level]] = [[] for _ in robots]
        for robot, battery in self._batteries.items():
            self.rows[robot].append(Level(0.0, battery.starts, 0.0))
        self._doing = {robot: runs.now(robot) for robot in self._batteries}

    def go_on(self, event: Event) -> None:
        """Take in an event that the runs have taken in."""
        for robot, battery in self._batteries.items():
            run = self._runs.now(robot)
            if run == self._doing[robot] and robot not in event.robots:
                continue
            full = self.at(robot, event.at)
            if event.kind in ("charged", "empty") and robot in event.robots:
                full = 1.0 if event.kind == "charged" else 0.0
            self._doing[robot] = run
            row = self.rows[robot]
            if row[-1].begun == event.at:
                row.pop()
            row.append(Level(event.at, full, _rate(battery, run.phase)))

    def at(self, robot: int, moment: float) -> float:
        """Return how full the battery of a robot is at a moment from its latest row on, 0 to 1."""
        begun, full, rate = self.rows[robot][-1]
        run = self._doing[robot]
        passed = moment - begun
        if run.phase in (WALKING, CARRYING):
            crew = self._runs.crew(run.task) if run.phase == CARRYING else (robot,)
            passed = self._still.walked(crew, begun, moment)
        return min(1.0, max(0.0, full + rate * passed))


def _rate(battery: Battery, phase: str | None) -> float:
    """Return which share of a full battery comes in a unit of time, less than 0 if it goes."""
    if phase == CHARGING:
        return 1 / battery.fills if battery.fills else 0.0
    if phase in (WALKING, CARRYING):
        return -1 / battery.lasts
    if phase in (WAITING, FORMING):
        return -battery.waiting / battery.lasts
    if phase in AT_WORK:
        return -battery.serving / battery.lasts
    return 0.0
