"""What each robot of a record did in any step, kept by the steps in which something changed.

`export.moments` tells the same of all robots step by step; here a few robots are asked about, in
records of a thousand robots too.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from teamformer.capabilities import covers, total
from teamformer.critical_path.stretches import FORMING, IDLE, LOST, SERVING, WAITING, WALKING
from teamformer.grid import Place
from teamformer.model import Scenario
from teamformer.plane import Plane
from teamformer.rules.constants import NOBODY
from teamformer.sim.replay.record import Replay, Step
from teamformer.sim.replay.teams import Teams

Value = TypeVar("Value")


class Changing(Generic[Value]):
    """A value that holds after a number of steps until it changes."""

    def __init__(self, value: Value) -> None:
        self._since = [0]
        self._values = [value]

    def set(self, steps: int, value: Value) -> bool:
        """Have a value from a number of steps on; return whether it is another one."""
        last = self._values[-1]
        if last is value or last == value:  # large teams are compared only when they are others
            return False
        self._since.append(steps)
        self._values.append(value)
        return True

    def after(self, steps: int) -> Value:
        """Return the value after so many steps."""
        return self._values[bisect_right(self._since, steps) - 1]


@dataclass(frozen=True)
class Service:
    """A task that was done: from the end of step `begun` to the end of step `ended`."""

    task: int
    begun: int
    ended: int
    begun_by: tuple[int, ...]  # the robots of the team that was there then
    robots: tuple[int, ...]  # those of the team that did it


@dataclass
class _Course:
    """What one robot did."""

    place: Changing[Place]
    team: Changing[tuple[int, ...]]  # empty while it is lost
    heading: Changing[int]  # the task that its team heads for
    walked: set[int] = field(default_factory=set)  # the steps in which it got on
    formed: set[int] = field(default_factory=set)
    back: set[int] = field(default_factory=set)
    told: dict[int, int] = field(default_factory=dict)  # what it pursued where the record says it
    services: list[Service] = field(default_factory=list)


class Courses:
    """What the robots of a record did."""

    def __init__(self, replay: Replay) -> None:
        self.mission: Scenario = replay.mission
        self.services: dict[int, Service] = {}  # by task
        self.done_in: dict[int, list[int]] = {}  # tasks by the step in which they were done
        teams = Teams(replay)
        self._of = [
            _Course(
                Changing(teams.place(robot)),
                Changing(teams.robots.get(teams.slot[robot], ())),
                Changing(NOBODY),
            )
            for robot in range(len(teams.slot))
        ]
        for number, step in enumerate(replay.steps, start=1):
            self._follow(teams, step, number)

    def _follow(self, teams: Teams, step: Step, number: int) -> None:
        """Write down what a step changed."""
        changed = {mate for lost in step.lost for mate in self.team(lost, number)}
        formed = teams.follow(step)
        changed |= {*formed, *step.lost, *step.back}
        for slot, *_ in step.teams:
            changed.update(teams.robots.get(slot, ()))
        for robot in changed:
            course, slot = self._of[robot], teams.slot[robot]
            if course.place.set(number, teams.place(robot)):
                course.walked.add(number)
            course.team.set(number, teams.robots.get(slot, ()))
            course.heading.set(number, teams.task.get(slot, NOBODY))
        for robot in formed:
            self._of[robot].formed.add(number)
        for robot in step.back:
            self._of[robot].back.add(number)
        for slot, task in step.pursued:
            for robot in teams.robots.get(slot, ()):
                self._of[robot].told[number] = task
        for task, slot in step.done:
            self._write_service(task, number, teams.robots[slot])

    def _write_service(self, task: int, ended: int, robots: tuple[int, ...]) -> None:
        begun = ended - int(self.mission.tasks[task].duration)
        service = Service(task, begun, ended, self._beginners(task, begun, robots), robots)
        self.services[task] = service
        self.done_in.setdefault(ended, []).append(task)
        for robot in robots:
            self._of[robot].services.append(service)

    def _beginners(self, task: int, begun: int, robots: tuple[int, ...]) -> tuple[int, ...]:
        """Return the team of one of these robots that had all that a task needs when it began."""
        fleet, needs = self.mission.robots, self.mission.tasks[task].needs
        for robot in robots:
            team = self.team(robot, begun)
            if covers(total(fleet[mate].can for mate in team), needs):
                return team
        return robots

    def team(self, robot: int, steps: int) -> tuple[int, ...]:
        """Return the robots of a robot's team after so many steps; of a lost one, nobody."""
        return self._of[robot].team.after(steps)

    def service_in(self, robot: int, step: int) -> Service | None:
        """Return the service that a robot took part in during a step, if it did."""
        team = self.team(robot, step)
        for service in self._of[robot].services:
            if service.begun < step <= service.ended and set(team) & set(service.begun_by):
                return service
        return None

    def pursued(self, robot: int, step: int) -> int:
        """Return the task that a robot's team was about in a step, or NOBODY."""
        course = self._of[robot]
        if not course.team.after(step):
            return NOBODY
        told, now = course.told.get(step), course.heading.after(step)
        if told is not None:
            return told
        return course.heading.after(step - 1) if now == NOBODY else now

    def doing(self, robot: int, step: int) -> str:
        """Return what a robot did in a step."""
        course = self._of[robot]
        if not course.team.after(step) or step in course.back:
            return LOST
        if step in course.formed:
            return FORMING
        if self.service_in(robot, step) is not None:
            return SERVING
        if step in course.walked:
            return WALKING
        task = self.pursued(robot, step)
        if task == NOBODY:
            return IDLE
        there = self._stands_at(course.place.after(step), self.mission.tasks[task].at)
        return WAITING if there else WALKING

    def _stands_at(self, one: Place, other: Place) -> bool:
        world = self.mission.world
        if isinstance(world, Plane):
            return math.dist(one, other) <= world.arrival_radius + 1e-9
        return one == other
