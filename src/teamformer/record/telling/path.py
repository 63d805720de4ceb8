"""The critical path of a record: from its last task back to the start, by what happened."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from teamformer.mission.parts.zones import rooms_of
from teamformer.record.critical_path.stretches import (
    CLOSED,
    UNKNOWN,
    Stretch,
    in_order,
    in_shifts,
)
from teamformer.record.phases import AT_WORK, FORMING, IDLE, UNLOADING, WAITING
from teamformer.record.record import Record
from teamformer.record.task_times import opening_steps
from teamformer.record.telling.doings import Doings
from teamformer.record.told.told_record import ToldRecord, ToldService
from teamformer.world.rules.constants import NOBODY


def find_path(record: Record, told: ToldRecord) -> tuple[Stretch, ...]:
    """Return the stretches that the makespan is the sum of, the first one first.

    Where robots waited for one another, the path goes on with the one that came last; where they
    waited for a task to open, with those who did the last one that it is `after`, or it ends there.
    It is empty unless the mission ended with a task that was done, and if nobody knows who did one.
    """
    if not record.end.makespan or not record.steps[-1].done:
        return ()
    if any(slot is None for step in record.steps for _, slot in step.done):
        return ()
    path = in_order(_Tracing(record, told).stretches(int(record.end.makespan)))
    return tuple(in_shifts(record.mission, path))


class _Tracing:
    """Goes back through a record: `_now` steps are made, and it hangs on `_robots` being ready."""

    def __init__(self, record: Record, told: ToldRecord) -> None:
        self._doings = Doings(record, told)
        self._done_last = record.steps[-1].done[0][0]
        self._opens = opening_steps(record)
        self._tasks = record.true_mission.tasks
        self._rooms = rooms_of(record.true_mission)
        self._number_of = {task.name: number for number, task in enumerate(self._tasks)}
        self._now = 0
        self._robots: Sequence[int] = ()
        self._task = NOBODY  # that they were ready for
        self._together: list[tuple[Stretch, Sequence[int]]] = []  # not told yet, and by which team
        self._passed_on = -1  # where the path last went from an idle robot to who did a task

    def stretches(self, makespan: int) -> Iterator[Stretch]:
        """Yield the stretches, the last one first."""
        last = self._doings.last[self._done_last]
        self._go_before(last, makespan)
        while self._now > 0:
            robot, busy = self._last_busy()
            if busy < self._now:
                yield from self._waited(robot, busy)
            else:
                yield from self._made(robot)
        yield from self._told_of(self._robots[0])

    def _told_of(self, robot: int) -> Iterator[Stretch]:
        """Yield what a team did together, as done by the one of it that was ready last."""
        for stretch, mates in self._together:
            yield replace(stretch, robot=robot if robot in mates else mates[0])
        self._together.clear()

    def _last_busy(self) -> tuple[int, int]:
        """Return which robot was the last to do something, and in which step: 0 if none did."""
        for step in range(self._now, 0, -1):
            for robot in self._robots:
                if self._doings.doing(robot, step) not in (WAITING, IDLE):
                    return robot, step
        return self._robots[0], 0

    def _made(self, robot: int) -> Iterator[Stretch]:
        """Go back to before what a robot did in the step now."""
        step, doing = self._now, self._doings.doing(robot, self._now)
        if doing in AT_WORK and (service := self._doings.service_in(robot, step)):
            is_same_team = not set(self._robots).isdisjoint(service.begun_by)
            if service.task != self._task or not is_same_team:
                yield from self._told_of(robot)
            self._go_before(service, step)
            return
        task = self._doings.pursued(robot, step)
        stretch = Stretch(step - 1, step, doing, robot, task)
        self._robots, self._now = (robot,), step - 1
        if task != NOBODY:
            self._task = task
        if doing == FORMING:
            self._robots = _led_by(self._robots, self._doings.team(robot, step))
            self._together.append((stretch, self._robots))
        else:
            yield from self._told_of(robot)
            yield stretch

    def _go_before(self, service: ToldService, until: float) -> None:
        """Go back to when those who began a service were ready for it."""
        self._robots, self._task = _led_by(self._robots, service.begun_by), service.task
        stretch = Stretch(service.begun, until, service.doing, task=service.task)
        self._together.append((stretch, self._robots))
        self._now = int(service.begun)

    def _waited(self, robot: int, busy: int) -> Iterator[Stretch]:
        """Go back to before the time in which nobody who was needed did anything."""
        opened = self._opens[self._task] if self._task != NOBODY else -1
        freed, zone = self._freed(busy)
        if freed is not None and self._together:
            stretch, mates = self._together[-1]
            self._together[-1] = replace(stretch, zone=zone), mates
        yield from self._told_of(robot)
        if freed is not None:
            self._go_before(freed, self._now)
            return
        if opened > 0 and busy <= opened <= self._now:
            yield from self._stood(robot, opened)
            yield from self._awaited(self._task)
            return
        doing = self._doings.doing(robot, self._now)
        if doing == IDLE and self._now != self._passed_on:
            self._passed_on = self._now
            for task, doers in self._doings.ended_in(self._now):
                if robot not in doers:  # what they did gave it its next task
                    self._robots, self._task = doers, task
                    return
        yield from self._stood(robot, busy)

    def _freed(self, busy: int) -> tuple[ToldService | None, int]:
        """Return which service left room in a zone for the task now, as it ended; and the zone.

        None if nobody waited for it, be it that all were busy.
        """
        is_load = bool(self._together) and self._together[-1][0].doing == UNLOADING
        for room in self._rooms if busy < self._now else ():
            own = room.loads if is_load else room.tasks
            others = (room.tasks | room.loads) - {self._task} if self._task in own else ()
            for other in sorted(others):
                service = self._doings.last.get(other)
                if service is not None and service.begun < self._now == service.ended:
                    return service, room.zone
        return None, NOBODY

    def _stood(self, robot: int, since: int) -> Iterator[Stretch]:
        """Go back to when a robot began to wait, for a task or for a task to be given."""
        for step in range(self._now, since, -1):
            doing, task = self._doings.doing(robot, step), self._doings.pursued(robot, step)
            yield Stretch(step - 1, step, doing, robot, task)
        self._now = since

    def _awaited(self, task: int) -> Iterator[Stretch]:
        """Go back from when a task opened to what it waited for."""
        wanted = self._tasks[task]
        for name in wanted.after:
            before = self._doings.last.get(self._number_of[name])
            if before is not None and before.ended == self._now:
                self._go_before(before, before.ended)
                return
        is_known = wanted.appears < self._now
        yield Stretch(0, self._now, CLOSED if is_known else UNKNOWN, NOBODY, task)
        self._now = 0


def _led_by(before: Sequence[int], robots: Sequence[int]) -> tuple[int, ...]:
    """Return robots in order, but first the one that the path followed before, if it is there."""
    return tuple(sorted(robots, key=lambda robot: (robot not in before[:1], robot)))
