"""What each robot of a record did in any step, kept by the steps in which something changed.

`export.moments` tells the same of all robots step by step; here a few robots are asked about, in
records of a thousand robots too.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.record.phases import (
    CARRYING,
    LOADING,
    SERVING,
    UNLOADING,
    believed_places,
    is_same_place,
    phase_of,
)
from teamformer.record.record import Record, Step
from teamformer.record.teams import Teams
from teamformer.world.rules.constants import NOBODY

Value = TypeVar("Value")

Robots = tuple[int, ...]
"""Numbers of robots, ascending."""


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
class TeamService:
    """What a team did for a task: from the end of step `begun` to the end of step `ended`.

    A load has several: each time that it is loaded and carried, and at last unloaded.
    """

    task: int
    doing: str  # one of AT_WORK
    begun: int
    ended: int
    begun_by: tuple[int, ...]  # the robots of the team that was there then
    robots: tuple[int, ...]  # those of the team that ended it


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
    services: list[TeamService] = field(default_factory=list)


class Courses:
    """What the robots of a record did."""

    def __init__(self, record: Record) -> None:
        self.mission: Mission = record.true_mission
        self.services: dict[int, TeamService] = {}  # the last one of each task
        self.done_in: dict[int, list[int]] = {}  # tasks by the step in which they were done
        self.set_down_in: dict[int, list[tuple[int, Robots]]] = {}  # step -> loads and carriers
        self._up: dict[int, tuple[int, Robots]] = {}  # load -> step, carriers
        self._goal = [Changing(at) for at in believed_places(record)]  # where teams head for
        teams = Teams(record.mission.robots, record.start)
        self._of = [
            _Course(
                Changing(teams.place(robot)),
                Changing(teams.robots.get(teams.slot[robot], ())),
                Changing(NOBODY),
            )
            for robot in range(len(teams.slot))
        ]
        for number, step in enumerate(record.steps, start=1):
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
        for task, x, y in step.moved:
            self._goal[task].set(number, (x, y))
        for task, x, y in step.left:
            robots = self._carried(task, number, ())
            self._goal[task].set(number, (x, y))
            self.set_down_in.setdefault(number, []).append((task, robots))
        for task, slot in step.taken:
            wanted, robots = self.mission.tasks[task], teams.robots[slot]
            self._write_service(task, LOADING, number - int(wanted.duration), number, robots)
            self._up[task] = number, robots
            self._goal[task].set(number, wanted.to or wanted.at)
        for task, doer in step.done:
            wanted, robots = self.mission.tasks[task], teams.doers(doer)
            if wanted.to is None:
                self._write_service(task, SERVING, number - int(wanted.duration), number, robots)
            else:
                arrived = number - int(wanted.unload)
                self._carried(task, arrived, robots)
                self._write_service(task, UNLOADING, arrived, number, robots)
            self.done_in.setdefault(number, []).append(task)

    def _carried(self, task: int, ended: int, by: Robots) -> Robots:
        """Record the carrying of a load, which ends here; return the robots that carried it.

        `by` are those that had it in the end; where nobody is told, all that took it up did.
        """
        if task not in self._up:
            return ()
        since, taken_by = self._up.pop(task)
        robots = by or taken_by
        self._write_service(task, CARRYING, since, ended, robots)
        return robots

    def _write_service(
        self, task: int, doing: str, begun: int, ended: int, robots: tuple[int, ...]
    ) -> None:
        beginners = self._beginners(task, begun, robots)
        service = TeamService(task, doing, begun, ended, beginners, robots)
        self.services[task] = service
        for robot in {*robots, *beginners}:
            self._of[robot].services.append(service)

    def _beginners(self, task: int, begun: int, robots: tuple[int, ...]) -> tuple[int, ...]:
        """Return the team of one of these robots that had all that a task needs when it began."""
        fleet, needs = self.mission.robots, self.mission.tasks[task].needs
        for robot in robots:
            team = self.team(robot, begun)
            if covers(total(fleet[mate].can for mate in team), needs):
                return team
        return robots

    def news_in(self, step: int) -> Iterator[tuple[int, Robots]]:
        """Yield tasks that were done or loads that were set down in a step, and who did it."""
        for task in self.done_in.get(step, ()):
            yield task, self.services[task].robots
        for task, robots in self.set_down_in.get(step, ()):
            yield task, robots

    def team(self, robot: int, steps: int) -> tuple[int, ...]:
        """Return the robots of a robot's team after so many steps; of a lost one, nobody."""
        return self._of[robot].team.after(steps)

    def service_in(self, robot: int, step: int) -> TeamService | None:
        """Return the service that a robot took part in during a step, if it did."""
        team = set(self.team(robot, step))
        for service in self._of[robot].services:
            is_with_it = team & set(service.begun_by) and team & set(service.robots)
            if is_with_it and service.begun < step <= service.ended:
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
        course, task = self._of[robot], self.pursued(robot, step)
        service, place = self.service_in(robot, step), course.place.after(step)
        is_there = task != NOBODY and is_same_place(
            self.mission, place, self._goal[task].after(step)
        )
        return phase_of(
            is_lost=not course.team.after(step) or step in course.back,
            has_formed=step in course.formed,
            work=None if service is None else service.doing,
            has_moved=step in course.walked,
            task=task,
            is_there=is_there,
        )
