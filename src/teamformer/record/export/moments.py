"""A record unrolled: where every robot is after each step, in which team, and what it did."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from teamformer.mission.parts.grid import Place
from teamformer.record.export.services import Services
from teamformer.record.phases import IDLE, is_same_place, phase_of
from teamformer.record.record import Record, Step
from teamformer.record.teams import Teams
from teamformer.world.rules.constants import NOBODY


@dataclass(frozen=True)
class Moment:
    """How everybody stands after a step; every tuple has one entry a robot.

    `phase` says what the robot did in that step; at the start, before step 1, it is idle.
    """

    step: int
    team: tuple[int, ...]  # slot, or NOBODY once lost
    place: tuple[Place, ...]  # of a lost robot, where it was last
    task: tuple[int, ...]  # that its team heads for, or NOBODY
    pursued: tuple[int, ...]  # that its team was about in the step, or NOBODY
    phase: tuple[str, ...]
    task_at: tuple[Place, ...]  # one a task: where it is, a load that is carried with its team


def moments(record: Record) -> Iterator[Moment]:
    """Yield the moments of a record, the start first."""
    count = len(record.mission.robots)
    activities = _Activities(record)
    yield activities.moment(0, [NOBODY] * count, [IDLE] * count)
    for number, step in enumerate(record.steps, start=1):
        yield activities.moment(number, *activities.make(step, number))


class _Activities:
    """What each robot was about in a step."""

    def __init__(self, record: Record) -> None:
        self._mission = record.true_mission
        self.teams = Teams(record)
        self._services = Services(record, self.teams)

    def moment(self, number: int, pursued: list[int], phase: list[str]) -> Moment:
        slots = tuple(self.teams.slot)
        told, task_at = (tuple(pursued), tuple(phase)), self._services.task_places()
        return Moment(number, slots, self._places(), self._tasks(), *told, task_at)

    def _places(self) -> tuple[Place, ...]:
        return tuple(self.teams.place(robot) for robot in range(len(self.teams.slot)))

    def _tasks(self) -> tuple[int, ...]:
        task = self.teams.task
        return tuple(NOBODY if slot == NOBODY else task[slot] for slot in self.teams.slot)

    def make(self, step: Step, number: int) -> tuple[list[int], list[str]]:
        """Make a step; return the task that each robot was about in it, and what it did."""
        was_at, was_for = self._places(), self._tasks()
        forming = self.teams.follow(step)
        by_slot = self._services.work(number)
        work = [by_slot.get(slot) for slot in self.teams.slot]
        self._services.go_on(step, number)
        phases, told = [], dict(step.pursued)
        pursued = [
            NOBODY if slot == NOBODY else told.get(slot, before if now == NOBODY else now)
            for slot, before, now in zip(self.teams.slot, was_for, self._tasks(), strict=True)
        ]
        for robot, (slot, task) in enumerate(zip(self.teams.slot, pursued, strict=True)):
            place = self.teams.place(robot)
            is_lost = slot == NOBODY or robot in step.back
            phases.append(
                phase_of(
                    *(is_lost, robot in forming, work[robot], place != was_at[robot], task),
                    is_there=self._is_at(place, task),
                )
            )
        return pursued, phases

    def _is_at(self, place: Place, task: int) -> bool:
        """Say whether a place is where a team heads for that is to do a task."""
        if task == NOBODY:
            return False
        return is_same_place(self._mission, place, self._services.goal_of(task))
