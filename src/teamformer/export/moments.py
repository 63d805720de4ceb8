"""A record unrolled: where every robot is after each step, in which team, and what it did."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from teamformer.capabilities import covers, total
from teamformer.grid import Place
from teamformer.model import Scenario
from teamformer.plane import Plane
from teamformer.sim.replay.record import Replay, Step
from teamformer.sim.replay.task_times import opening_steps

NOBODY = -1
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
    state = _State(replay)
    yield state.moment(0, [NOBODY] * len(state.team), [IDLE] * len(state.team))
    for number, step in enumerate(replay.steps, start=1):
        yield state.moment(number, *state.make(step, number))


class _State:
    def __init__(self, replay: Replay) -> None:
        self._scenario = replay.mission
        count = len(self._scenario.robots)
        self.team = [NOBODY] * count
        self._place: list[Place] = [robot.at for robot in self._scenario.robots]
        self._at: dict[int, Place] = {}  # by slot
        self._task: dict[int, int] = {}
        for slot, robots, x, y in replay.start:
            for robot in robots:
                self.team[robot] = slot
            self._at[slot], self._task[slot] = (x, y), NOBODY
        self._serving: dict[int, set[int]] = {}  # task -> robots that began it
        self._opens = opening_steps(replay)
        self._is_done = [False] * len(self._scenario.tasks)

    def moment(self, number: int, pursued: list[int], phase: list[str]) -> Moment:
        team, place = tuple(self.team), tuple(self._place)
        return Moment(number, team, place, self._tasks(), tuple(pursued), tuple(phase))

    def _tasks(self) -> tuple[int, ...]:
        return tuple(NOBODY if slot == NOBODY else self._task[slot] for slot in self.team)

    def make(self, step: Step, number: int) -> tuple[list[int], list[str]]:
        """Make a step and return what each robot was about in it, and what it did."""
        was_at, was_for = list(self._place), self._tasks()
        forming = self._form(step)
        self._lose(step.lost)
        for robot in step.back:
            self.team[robot] = robot
        for slot, x, y, task in step.teams:
            self._at[slot], self._task[slot] = (x, y), NOBODY if task is None else task
        for robot, slot in enumerate(self.team):
            if slot != NOBODY:
                self._place[robot] = self._at[slot]
        serving = {robot for robots in self._serving.values() for robot in robots}
        self._serve(step, number)
        phases, told = [], dict(step.pursued)
        pursued = [
            told.get(slot, before if now == NOBODY else now)
            for slot, before, now in zip(self.team, was_for, self._tasks(), strict=True)
        ]
        for robot, slot in enumerate(self.team):
            if slot == NOBODY or robot in step.back:
                phases.append(LOST)
            elif robot in forming:
                phases.append(FORMING)
            elif robot in serving:
                phases.append(SERVING)
            else:
                phases.append(self._way(was_at[robot], self._place[robot], pursued[robot]))
        return pursued, phases

    def _way(self, before: Place, after: Place, task: int) -> str:
        """Return what a robot did that neither formed nor served."""
        if before != after:
            return WALKING
        if task == NOBODY:
            return IDLE
        there = is_same_place(self._scenario, after, self._scenario.tasks[task].at)
        return WAITING if there else WALKING

    def _form(self, step: Step) -> set[int]:
        """Make splits and joins; return the robots of the teams that are formed."""
        formed: set[int] = set()
        for parts in step.splits:
            slot = self.team[parts[0][0]]
            for robots in parts:
                self._found(min(robots), slot, robots)
                formed.update(robots)
        for pair in step.joins:
            slot = min(pair)
            robots = tuple(robot for robot, team in enumerate(self.team) if team in pair)
            self._found(slot, slot, robots)
            formed.update(robots)
        return formed

    def _found(self, slot: int, before: int, robots: tuple[int, ...]) -> None:
        """Make robots the team of a slot, at the place of the team they come from."""
        self._at[slot] = self._at[before]
        self._task[slot] = self._task[before] if slot == before else NOBODY
        for robot in robots:
            self.team[robot] = slot

    def _lose(self, lost: tuple[int, ...]) -> None:
        for robot in lost:
            slot, self.team[robot] = self.team[robot], NOBODY
            rest = tuple(mate for mate, team in enumerate(self.team) if team == slot)
            if slot == robot and rest:
                task = self._task[slot]
                self._found(min(rest), slot, rest)
                self._task[min(rest)] = task

    def _serve(self, step: Step, number: int) -> None:
        """Bring up to date who serves which task; a record says only when one is done."""
        for task, _ in step.done:
            self._is_done[task] = True
            self._serving.pop(task, None)
        for task, robots in list(self._serving.items()):
            left = {robot for robot in robots if self.team[robot] != NOBODY}
            slot = self.team[min(left)] if left else NOBODY
            if slot == NOBODY or not self._covers(slot, task):
                del self._serving[task]
        slots = sorted(set(self.team) - {NOBODY})
        for task, wanted in enumerate(self._scenario.tasks):
            if wanted.duration == 0 or self._is_done[task] or self._opens[task] >= number:
                continue
            if task not in self._serving:
                able = next((slot for slot in slots if self._covers(slot, task)), NOBODY)
                if able != NOBODY:
                    self._serving[task] = set(self._robots(able))

    def _covers(self, slot: int, task: int) -> bool:
        wanted = self._scenario.tasks[task]
        if not is_same_place(self._scenario, self._at[slot], wanted.at):
            return False
        return covers(
            total(self._scenario.robots[robot].can for robot in self._robots(slot)), wanted.needs
        )

    def _robots(self, slot: int) -> list[int]:
        return [robot for robot, team in enumerate(self.team) if team == slot]


def is_same_place(scenario: Scenario, one: Place, other: Place) -> bool:
    """Say whether two places are one: the same cell, or points within the arrival radius."""
    if isinstance(scenario.world, Plane):
        return math.dist(one, other) <= scenario.world.arrival_radius + 1e-9
    return one == other


def seconds_a_step(scenario: Scenario) -> float:
    """Return how long a step takes; on grids, whose steps have no length, one second."""
    return scenario.world.step if isinstance(scenario.world, Plane) else 1.0
