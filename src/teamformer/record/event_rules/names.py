"""Robots, tasks and places of a mission in words; and what is raised where a rule is broken."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.record.event_rules.outside import Due
from teamformer.world.continuous.events import Passed


class BrokenRuleError(Exception):
    """What the rules do not allow."""


def need(is_so: bool, message: str) -> None:
    """Raise `BrokenRuleError` unless something is so."""
    if not is_so:
        raise BrokenRuleError(message)


class InWords:
    """Names what a mission has."""

    def __init__(self, mission: Mission) -> None:
        self._mission = mission

    def task(self, task: int) -> str:
        """Name a task."""
        return f"task {self._mission.tasks[task].name}"

    def robot(self, robot: int) -> str:
        """Name a robot."""
        return f"robot {self._mission.robots[robot].name}"

    def robots(self, robots: Sequence[int]) -> str:
        """Return robots by name, in brackets."""
        return f"[{', '.join(self._mission.robots[robot].name for robot in robots)}]"

    def place(self, place: Place) -> str:
        """Write a place."""
        if isinstance(self._mission.world, Roads):
            return self._mission.world.name_of(place)
        return f"({place[0]:.9g}, {place[1]:.9g})"

    def passed(self, passed: Passed) -> str:
        """Write a place with its time."""
        return f"{self.place(passed.place)} at {passed.at:.9g}"

    def outside(self, due: Due) -> str:
        """Say what comes from outside."""
        _, kind, which = due
        if kind in ("lost", "back"):
            return f"{self.robot(which)} is {kind}"
        return f"{self.task(which)} {kind}s" if kind != "opens" else f"{self.task(which)} opens"
