"""Incidents: what happens to a mission from outside while it runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from teamformer.capabilities import describe
from teamformer.errors import ScenarioError, TeamformerError
from teamformer.grid import Place
from teamformer.model import Scenario, Task


@dataclass(frozen=True)
class NewTask:
    """A task that everybody learns of now; an empty name is replaced by a free one."""

    at: Place
    needs: Mapping[str, int]
    name: str = ""
    duration: int = 0

    def apply(self, scenario: Scenario, steps: int) -> Scenario:
        """Return the scenario in which this has happened when `steps` steps were made."""
        name = self.name or _free_name(scenario)
        task = Task(name, self.at, dict(self.needs), self.duration, steps)
        return _checked(scenario, tasks=(*scenario.tasks, task))

    def text(self) -> str:
        """Return the incident as words."""
        what = f"task {self.name}" if self.name else "a task"
        return f"{what} at [{self.at[0]}, {self.at[1]}] that needs {describe(self.needs)}"


@dataclass(frozen=True)
class LostRobot:
    """A robot that counts for nothing from the next step on."""

    robot: str

    def apply(self, scenario: Scenario, steps: int) -> Scenario:
        """Return the scenario in which the robot is lost in the step after `steps`."""
        number = next((r for r, it in enumerate(scenario.robots) if it.name == self.robot), None)
        if number is None:
            raise TeamformerError(f"there is no robot '{self.robot}'")
        robot = scenario.robots[number]
        if robot.lost is not None and robot.lost <= steps:
            raise TeamformerError(f"robot '{self.robot}' was lost in step {robot.lost} already")
        robots = list(scenario.robots)
        robots[number] = replace(robot, lost=steps + 1)
        return _checked(scenario, robots=tuple(robots))

    def text(self) -> str:
        """Return the incident as words."""
        return f"robot {self.robot} lost"


Incident = NewTask | LostRobot


def _checked(scenario: Scenario, **changes: object) -> Scenario:
    """Return a changed scenario; TeamformerError says why it cannot be."""
    try:
        return replace(scenario, **changes)  # type: ignore[arg-type]
    except ScenarioError as error:
        raise TeamformerError("; ".join(problem.message for problem in error.problems)) from None


def _free_name(scenario: Scenario) -> str:
    names = {task.name for task in scenario.tasks}
    number = len(names) + 1
    while f"t{number}" in names:
        number += 1
    return f"t{number}"
