"""What every body keeps, whoever wrote it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.grid import Grid, Place

if TYPE_CHECKING:
    from teamformer.fleet.bodies.body import Body, Report
    from teamformer.fleet.fleet_mission import FleetMission

PAUSE = 0.05
"""Seconds between two looks at a body, as an agent looks."""

AWAY: Place = (3, 0)
"""Where the task of the check is; its robot starts in the corner."""


def check_body(
    make: Callable[[FleetMission, int], Body],
    mission: FleetMission | None = None,
    seconds: float = 60.0,
    near: float = 0.5,
) -> None:
    """Check that what `make` returns is a body; raises `AssertionError` with what it is not.

    It reports where it is, in numbers, and which command it has taken up; it goes where it is sent,
    serves the task there, obeys the last command, and can be closed. `make` is given a mission and
    robot 0: `mission`, or one with a robot at (0, 0) and a task at (3, 0) on a grid. The body has
    `seconds` for each thing that it is told, and arrives if it is so `near`, in cells or metres.
    """
    from teamformer.fleet.fleet_mission import FleetMission

    mission = FleetMission(_one_robot()) if mission is None else mission
    body = make(mission, 0)
    for part in ("command", "report", "close"):
        has_it = callable(getattr(body, part, None))
        assert has_it, f"a body has a method '{part}', and this has none"
    _Check(body, mission, seconds, near).run()


def _one_robot() -> Mission:
    robot = Robot("r0", (0, 0), {"lift": 1}, speed=1)
    task = Task("t0", AWAY, {"lift": 1})
    return Mission("a robot and a task", Grid(5, 1), ("lift",), (robot,), (task,))


class _Check:
    """A body, and what it is told, one thing after another."""

    def __init__(self, body: Body, mission: FleetMission, seconds: float, near: float) -> None:
        self._body, self._mission, self._seconds, self._near = body, mission, seconds, near
        self._number = -math.inf

    def run(self) -> None:
        """Send it to the task, have it serve, send it back, and close it."""
        from teamformer.fleet.bodies.body import Command

        mission = self._mission.source
        task, home = mission.tasks[0].at, mission.robots[0].at
        self._until("reports where it is", lambda report: True, Command())
        there = Command(1, task, 0, 0)
        self._until(f"takes up leg 1 and goes to {task}", self._is_at(task, 1), there)
        serving = there._replace(serve=True, duration=1.0)
        self._until(
            "says that its task is done, or its part of it",
            lambda report: report.is_done or report.has_served,
            serving,
        )
        back = Command(2, home)
        self._until(f"takes up leg 2 and goes to {home}", self._is_at(home, 2), back)
        self._body.close()

    def _is_at(self, place: Place, leg: int) -> Callable[[Report], bool]:
        def is_there(report: Report) -> bool:
            return report.leg == leg and math.dist(report[:2], place) <= self._near

        return is_there

    def _until(self, what: str, is_so: Callable[[Report], bool], command: object) -> None:
        """Tell it again and again, as an agent does, and wait until it is so."""
        end, report = time.monotonic() + self._seconds, None
        while time.monotonic() < end:
            self._body.command(command)  # type: ignore[arg-type]
            report = self._body.report()
            if report is not None:
                self._check_report(report)
                if is_so(report):
                    return
            time.sleep(PAUSE)
        raise AssertionError(
            f"a body {what}, and after {self._seconds:g} s of {command} this reports {report}"
        )

    def _check_report(self, report: Report) -> None:
        from teamformer.fleet.bodies.body import Report

        assert isinstance(report, Report), (
            f"report() returns a Report or None, and this returned {type(report).__name__}"
        )
        assert _are_numbers(report[:2]), (
            f"a body reports its place in numbers, and this reports {report[:2]}"
        )
        assert report.number >= self._number, (
            f"'number' grows from report to report, and after {self._number} came {report.number}"
        )
        self._number = report.number


def _are_numbers(place: Sequence[float]) -> bool:
    try:
        return all(math.isfinite(part) for part in place)
    except TypeError:
        return False
