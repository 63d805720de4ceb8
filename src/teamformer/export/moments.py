"""A record unrolled: where every robot is after each step, in which team, and what it did."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from teamformer.capabilities import covers, total
from teamformer.grid import Place
from teamformer.model import Scenario
from teamformer.plane import Plane
from teamformer.rules.constants import NOBODY
from teamformer.sim.replay.record import Replay, Step
from teamformer.sim.replay.task_times import opening_steps
from teamformer.sim.replay.teams import Teams

PHASES = ("walking", "waiting", "forming", "serving", "idle", "lost")
WALKING, WAITING, FORMING, SERVING, IDLE, LOST = PHASES


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


def moments(replay: Replay) -> Iterator[Moment]:
    """Yield the moments of a record, the start first."""
    count = len(replay.scenario.robots)
    activities = _Activities(replay)
    yield activities.moment(0, [NOBODY] * count, [IDLE] * count)
    for number, step in enumerate(replay.steps, start=1):
        yield activities.moment(number, *activities.make(step, number))


class _Activities:
    """Who serves which task, and what each robot was about in a step."""

    def __init__(self, replay: Replay) -> None:
        self._mission = replay.mission
        self.teams = Teams(replay)
        self._serving: dict[int, set[int]] = {}  # task -> robots that began it
        self._opens = opening_steps(replay)
        self._is_done = [False] * len(self._mission.tasks)

    def moment(self, number: int, pursued: list[int], phase: list[str]) -> Moment:
        slots = tuple(self.teams.slot)
        return Moment(number, slots, self._places(), self._tasks(), tuple(pursued), tuple(phase))

    def _places(self) -> tuple[Place, ...]:
        return tuple(self.teams.place(robot) for robot in range(len(self.teams.slot)))

    def _tasks(self) -> tuple[int, ...]:
        task = self.teams.task
        return tuple(NOBODY if slot == NOBODY else task[slot] for slot in self.teams.slot)

    def make(self, step: Step, number: int) -> tuple[list[int], list[str]]:
        """Make a step; return the task that each robot was about in it, and what it did."""
        was_at, was_for = self._places(), self._tasks()
        forming = self.teams.follow(step)
        slots = self.teams.slot
        at_work = {slots[robot] for robots in self._serving.values() for robot in robots}
        serving = {robot for robot, slot in enumerate(slots) if slot in at_work - {NOBODY}}
        self._serve(step, number)
        phases, told = [], dict(step.pursued)
        pursued = [
            NOBODY if slot == NOBODY else told.get(slot, before if now == NOBODY else now)
            for slot, before, now in zip(self.teams.slot, was_for, self._tasks(), strict=True)
        ]
        for robot, slot in enumerate(self.teams.slot):
            if slot == NOBODY or robot in step.back:
                phases.append(LOST)
            elif robot in forming:
                phases.append(FORMING)
            elif robot in serving:
                phases.append(SERVING)
            else:
                phases.append(self._way(was_at[robot], self.teams.place(robot), pursued[robot]))
        return pursued, phases

    def _way(self, before: Place, after: Place, task: int) -> str:
        """Return what a robot did that neither formed nor served."""
        if before != after:
            return WALKING
        if task == NOBODY:
            return IDLE
        there = is_same_place(self._mission, after, self._mission.tasks[task].at)
        return WAITING if there else WALKING

    def _serve(self, step: Step, number: int) -> None:
        """Bring up to date who serves which task; a record says only when one is done."""
        for task, _ in step.done:
            self._is_done[task] = True
            self._serving.pop(task, None)
        for task, robots in list(self._serving.items()):
            left = [robot for robot in robots if self.teams.slot[robot] != NOBODY]
            slot = self.teams.slot[min(left)] if left else NOBODY
            if slot == NOBODY or not self._covers(slot, task):
                del self._serving[task]
        slots = sorted(self.teams.robots)
        for task, wanted in enumerate(self._mission.tasks):
            if wanted.duration == 0 or self._is_done[task] or self._opens[task] >= number:
                continue
            if task not in self._serving:
                able = next((slot for slot in slots if self._covers(slot, task)), NOBODY)
                if able != NOBODY:
                    self._serving[task] = set(self.teams.robots[able])

    def _covers(self, slot: int, task: int) -> bool:
        wanted = self._mission.tasks[task]
        if not is_same_place(self._mission, self.teams.at[slot], wanted.at):
            return False
        robots = (self._mission.robots[robot] for robot in self.teams.robots[slot])
        return covers(total(robot.can for robot in robots), wanted.needs)


def is_same_place(scenario: Scenario, one: Place, other: Place) -> bool:
    """Say whether two places are one: the same cell, or points within the arrival radius."""
    if isinstance(scenario.world, Plane):
        return math.dist(one, other) <= scenario.world.arrival_radius + 1e-9
    return one == other
