"""Who serves which task in a record, which says only when one is done, and where loads are."""

from __future__ import annotations

import math
from collections.abc import Iterable

from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.grid import Place
from teamformer.record.phases import believed_places, is_same_place, work_on
from teamformer.record.record import Record, Step
from teamformer.record.task_times import cancelled_steps, done_steps, opening_steps
from teamformer.record.teams import Teams
from teamformer.world.rules.constants import NOBODY


class Services:
    """Who serves which task after a step; `teams` are those of the same step."""

    def __init__(self, record: Record, teams: Teams) -> None:
        self._mission, self._teams = record.true_mission, teams
        self._serving: dict[int, set[int]] = {}  # task -> robots that began it and stayed with it
        self._opens, self._done = opening_steps(record), done_steps(record)
        self._cancelled = cancelled_steps(record)
        self._is_over = [False] * len(self._mission.tasks)
        self._lies = [task.at for task in self._mission.tasks]  # loads where they were taken up
        self._believed = believed_places(record)  # where teams head for
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
            places[task] = self._place_of(self._serving[task])
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
                self._let_go(task, self._serving.get(task, ()))
                self._end(task)
                self._is_over[task] = True
        for task, x, y in step.left:
            self._end(task)
            self._lies[task] = self._believed[task] = (x, y)
        taken = {k: slot for k, slot in step.taken if self._is_load(k) and not self._is_over[k]}
        for task, robots in list(self._serving.items()):
            self._go_on_with(task, robots, taken.get(task))
        let_go = {row.task for row in step.left}
        waiting = (self._waiting(number) - let_go) | (taken.keys() - self._serving.keys())
        for task in sorted(waiting, key=lambda k: (not self._is_load(k), k)):
            self._begin(task, taken.get(task), number)
        for task in taken:
            self._up[task] = self._mission.tasks[task].to or self._lies[task]

    def _go_on_with(self, task: int, robots: set[int], taker: int | None) -> None:
        """Let a service go on with those of its robots that do; `taker` takes its load up.

        Of a team that has parted the first part that can goes on. Who has a load has it until the
        record says that it is down. If they part, those have it that can carry it and head for
        nothing else; if no part can, all that head for nothing else.
        """
        there = {robot: self._teams.slot[robot] for robot in sorted(robots)}
        there = {robot: slot for robot, slot in there.items() if slot != NOBODY}
        if taker is not None:
            going = [taker]
        elif task in self._up:
            about = [slot for slot in there.values() if self._is_about(slot, task)]
            able = [slot for slot in about if self._is_able(slot, task)]
            going = able or about or [*there.values()]
        else:
            going = [slot for slot in there.values() if self._can_serve(slot, task)][:1]
        self._serving[task] = {robot for robot, slot in there.items() if slot in going}
        if not self._serving[task]:
            self._let_go(task, robots)
            self._end(task)

    def _let_go(self, task: int, robots: Iterable[int]) -> None:
        """Leave a load that is called off on its way, or has no carrier left, where its team is."""
        if task in self._up:
            self._lies[task] = self._believed[task] = self._place_of(robots)

    def _end(self, task: int) -> None:
        self._serving.pop(task, None)
        self._up.pop(task, None)

    def _place_of(self, robots: Iterable[int]) -> Place:
        """Return where the first of those robots is that is there, or else where it was lost."""
        return self._teams.place(min(robots, key=lambda r: (self._teams.slot[r] == NOBODY, r)))

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

    def _begin(self, task: int, taker: int | None, number: int) -> None:
        """Let the taker of a load begin, or the first team that can of those that have no load."""
        if taker is None:
            loads = (robots for other, robots in self._serving.items() if self._is_load(other))
            busy = {self._teams.slot[robot] for robots in loads for robot in robots}
            able = (slot for slot in self._teams.robots if slot not in busy)
            taker = min((slot for slot in able if self._can_begin(slot, task)), default=None)
        if taker is not None:
            self._serving[task] = set(self._teams.robots[taker])
            self.begun[task] = number

    def _can_begin(self, slot: int, task: int) -> bool:
        is_meant = not self._is_load(task) or self._teams.task[slot] == task
        return is_meant and self._can_serve(slot, task)

    def _can_serve(self, slot: int, task: int) -> bool:
        is_there = is_same_place(self._mission, self._teams.at[slot], self._lies[task])
        return is_there and self._is_about(slot, task) and self._is_able(slot, task)

    def _is_about(self, slot: int, task: int) -> bool:
        """Say whether a team heads for no other task than a load."""
        return not self._is_load(task) or self._teams.task[slot] in (task, NOBODY)

    def _is_able(self, slot: int, task: int) -> bool:
        robots = (self._mission.robots[robot] for robot in self._teams.robots[slot])
        return covers(total(robot.can for robot in robots), self._mission.tasks[task].needs)


def begun_steps(record: Record) -> dict[int, int]:
    """Return the step in which each task was begun last that was, by number.

    A task without a duration begins in the step in which it is done.
    """
    teams = Teams(record)
    services = Services(record, teams)
    for number, step in enumerate(record.steps, start=1):
        teams.follow(step)
        services.go_on(step, number)
    return done_steps(record) | services.begun
