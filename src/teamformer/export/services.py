"""Who serves which task in a record, which says only when one is done, and where loads are."""

from __future__ import annotations

import math

from teamformer.capabilities import covers, total
from teamformer.grid import Place
from teamformer.rules.constants import NOBODY
from teamformer.sim.replay.phases import believed_places, is_same_place, work_on
from teamformer.sim.replay.record import Replay, Step
from teamformer.sim.replay.task_times import cancelled_steps, done_steps, opening_steps
from teamformer.sim.replay.teams import Teams


class Services:
    """Who serves which task after a step; `teams` are those of the same step."""

    def __init__(self, replay: Replay, teams: Teams) -> None:
        self._mission, self._teams = replay.mission, teams
        self._serving: dict[int, set[int]] = {}  # task -> robots that began it and stayed with it
        self._opens, self._done = opening_steps(replay), done_steps(replay)
        self._cancelled = cancelled_steps(replay)
        self._is_over = [False] * len(self._mission.tasks)
        self._lies = [task.at for task in self._mission.tasks]  # loads where they were taken up
        self._believed = believed_places(replay)  # where teams head for
        self.begun: dict[int, int] = {}  # task -> the step in which it was begun last
        self._up: dict[int, Place] = {}  # load that is carried -> where it is brought to

    def work(self, number: int) -> dict[int, str]:
        """Return what teams do for tasks in the step that comes, by slot."""
        work: dict[int, str] = {}
        loads_last = sorted(self._serving.items(), key=lambda it: (self._is_load(it[0]), it[0]))
        for task, robots in loads_last:
            wanted, done_in = self._mission.tasks[task], self._done.get(task, math.inf)
            doing = work_on(wanted, task in self._up, number, done_in)
            work |= dict.fromkeys((self._teams.slot[robot] for robot in robots), doing)
        return {slot: doing for slot, doing in work.items() if slot != NOBODY}

    def goal_of(self, task: int) -> Place:
        """Return where a team heads for that is to do a task."""
        return self._up.get(task, self._believed[task])

    def task_places(self) -> tuple[Place, ...]:
        """Return where every task is; a load that is carried is with its team."""
        places = list(self._lies)
        for task in self._up:
            slot = self._slot_of(task)
            if slot != NOBODY:
                places[task] = self._teams.at[slot]
        return tuple(places)

    def go_on(self, step: Step, number: int) -> None:
        """Go on to the end of a step."""
        for task, _ in step.done:
            self._end(task)
            self._is_over[task] = True
            self._lies[task] = self._mission.tasks[task].to or self._lies[task]
            self._believed[task] = self._lies[task]
        for task, x, y in step.moved:
            self._believed[task] = (x, y)
        for task, called_off in self._cancelled.items():
            if called_off == number:
                self._let_go(task)
                self._end(task)
                self._is_over[task] = True
        for task, x, y in step.left:
            self._end(task)
            self._lies[task] = self._believed[task] = (x, y)
        for task, robots in list(self._serving.items()):
            slots = [self._teams.slot[robot] for robot in sorted(robots)]
            able = [slot for slot in slots if slot != NOBODY and self._can_serve(slot, task)]
            if able:  # of a team that has parted, the first that can
                self._serving[task] = robots & set(self._teams.robots[able[0]])
            else:
                self._end(task)
        let_go = {row.task for row in step.left}
        for task in sorted(self._waiting(number) - let_go, key=lambda k: (not self._is_load(k), k)):
            self._begin(task, number)
        for task, _ in step.taken:
            to = self._mission.tasks[task].to
            if not self._is_over[task] and to is not None:
                self._up[task] = to

    def _let_go(self, task: int) -> None:
        """Leave a load that is called off on its way where its team is."""
        slot = self._slot_of(task)
        if task in self._up and slot != NOBODY:
            self._lies[task] = self._believed[task] = self._teams.at[slot]

    def _end(self, task: int) -> None:
        self._serving.pop(task, None)
        self._up.pop(task, None)

    def _slot_of(self, task: int) -> int:
        """Return the team of those who serve a task."""
        left = [r for r in self._serving.get(task, ()) if self._teams.slot[r] != NOBODY]
        return self._teams.slot[min(left)] if left else NOBODY

    def _is_load(self, task: int) -> bool:
        return self._mission.tasks[task].to is not None

    def _waiting(self, number: int) -> set[int]:
        """Return the open tasks that take a while and nobody serves."""
        return {
            task
            for task, wanted in enumerate(self._mission.tasks)
            if (wanted.duration > 0 or self._is_load(task))
            and not self._is_over[task]
            and self._opens[task] < number
            and task not in self._serving
        }

    def _begin(self, task: int, number: int) -> None:
        """Let the first team begin that can; who has a load does nothing else."""
        busy = {self._slot_of(other) for other in self._serving if self._is_load(other)}
        for slot in sorted(self._teams.robots.keys() - busy):
            is_meant = not self._is_load(task) or self._teams.task[slot] == task
            if is_meant and self._can_serve(slot, task):
                self._serving[task] = set(self._teams.robots[slot])
                self.begun[task] = number
                return

    def _can_serve(self, slot: int, task: int) -> bool:
        if self._is_load(task) and self._teams.task[slot] not in (task, NOBODY):
            return False
        is_there = is_same_place(self._mission, self._teams.at[slot], self._lies[task])
        if task not in self._up and not is_there:
            return False
        robots = (self._mission.robots[robot] for robot in self._teams.robots[slot])
        return covers(total(robot.can for robot in robots), self._mission.tasks[task].needs)


def begun_steps(replay: Replay) -> dict[int, int]:
    """Return the step in which each task was begun last that was, by number.

    A task without a duration begins in the step in which it is done.
    """
    teams = Teams(replay)
    services = Services(replay, teams)
    for number, step in enumerate(replay.steps, start=1):
        teams.follow(step)
        services.go_on(step, number)
    return done_steps(replay) | services.begun
