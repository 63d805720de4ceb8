"""What robots did from when to when, and what was done for tasks, as events say."""

from __future__ import annotations

from collections.abc import Iterable

from teamformer.mission.parts.zones import AtWork
from teamformer.record.phases import (
    CARRYING,
    CHARGING,
    FORMING,
    IDLE,
    LOADING,
    LOST,
    OFF,
    QUEUEING,
    SERVING,
    UNLOADING,
    WAITING,
    WALKING,
)
from teamformer.record.record import Record
from teamformer.record.told.told_record import Robots, Run, ToldService
from teamformer.world.continuous.events import Event
from teamformer.world.rules.constants import NOBODY

BEGINS = {
    "walk": WALKING,
    "form": FORMING,
    "formed": WAITING,
    "serve": SERVING,
    "lift": CARRYING,
    "unload": UNLOADING,
    "done": IDLE,
    "broken": IDLE,
    "lost": LOST,
    "back": IDLE,
    "queue": QUEUEING,
    "charge": CHARGING,
    "charged": IDLE,
    "empty": LOST,
}
"""What an event has its robots do from then on; `arrive` and `cancel` depend on the task."""

OF_NO_TASK = (IDLE, LOST, CHARGING, QUEUEING)


class Runs:
    """What each robot does now and the services of tasks, event by event.

    `changed` are the robots that do something else since the latest event.
    """

    def __init__(self, record: Record) -> None:
        robots = len(record.mission.robots)
        self._loads = [task.to is not None for task in record.mission.tasks]
        self._now = [Run(0, IDLE, NOBODY)] * robots
        rotas = enumerate(robot.rota for robot in record.mission.robots)
        self._off = {robot for robot, rota in rotas if not rota.is_at_work(0.0)}
        self.services: list[ToldService] = []
        self.changed: set[int] = set()
        self._open: dict[int, int] = {}  # task -> its row that goes on
        self.queue: list[int] = []  # loads that wait for room to be unloaded
        self.over: set[int] = set()  # tasks

    @property
    def under_way(self) -> set[int]:
        """Return the tasks of which some part goes on, or that wait to be unloaded."""
        return {*self._open, *self.queue}

    @property
    def at_work(self) -> AtWork:
        """Return what takes room in zones, or waits for it with a load."""
        doing = {task: self.services[row].doing for task, row in self._open.items()}
        served = [task for task, what in doing.items() if what in (SERVING, LOADING)]
        unloaded = [task for task, what in doing.items() if what == UNLOADING]
        return AtWork(served, unloaded, self.queue)

    def now(self, robot: int) -> Run:
        """Return what a robot does; outside its shifts it is off, whatever it goes on with."""
        run = self._now[robot]
        is_off = robot in self._off and run.phase in (WALKING, WAITING, IDLE)
        return run._replace(phase=OFF) if is_off else run

    def crew(self, task: int) -> Robots:
        """Return who is at work on a task."""
        return self.services[self._open[task]].begun_by if task in self._open else ()

    def go_on(self, event: Event) -> None:
        """Take in an event."""
        self.changed = set()
        for robot in self._concerned(event):
            self._do(robot, event)
        match event.kind:
            case "serve":
                self._begin(event, LOADING if self._loads[event.task] else SERVING)
            case "lift":
                self._end(event.task, event.at, event.robots)
                self._begin(event, CARRYING)
            case "queue" if event.task != NOBODY:
                self._end(event.task, event.at, event.robots)
                self.queue.append(event.task)
            case "unload":
                self._end(event.task, event.at, event.robots)
                self._begin(event, UNLOADING)
            case "done":
                self._end(event.task, event.at, event.robots)
            case "broken" | "cancel" | "missed":
                self._end(event.task, event.at)
            case "rests":
                self._off.update(event.robots)
            case "works":
                self._off.difference_update(event.robots)
        if event.kind in ("unload", "broken", "cancel", "missed") and event.task in self.queue:
            self.queue.remove(event.task)
        if event.kind in ("done", "cancel", "missed"):
            self.over.add(event.task)

    def _concerned(self, event: Event) -> Iterable[int]:
        """Return the robots that may do something else since an event."""
        if event.kind not in ("cancel", "done", "missed"):
            return event.robots
        about = [robot for robot, run in enumerate(self._now) if run.task == event.task]
        return sorted({*event.robots, *about})

    def _do(self, robot: int, event: Event) -> None:
        phase, task = BEGINS.get(event.kind, IDLE), event.task
        if event.kind in ("rests", "works"):
            self._now[robot] = self._now[robot]._replace(begun=event.at)
            self.changed.add(robot)
            return
        if event.kind in ("arrive", "queue") and task != NOBODY:
            phase = WAITING
        elif event.kind == "serve" and self._loads[task]:
            phase = LOADING
        elif event.kind not in (*BEGINS, "arrive", "cancel", "missed"):
            return
        self._now[robot] = Run(event.at, phase, NOBODY if phase in OF_NO_TASK else task)
        self.changed.add(robot)

    def _begin(self, event: Event, doing: str) -> None:
        self._open[event.task] = len(self.services)
        self.services.append(ToldService(event.task, doing, event.at, None, event.robots, ()))

    def _end(self, task: int, when: float, robots: Robots = ()) -> None:
        """End what is done for a task, if something is; by default by those who began it."""
        if task in self._open:
            row = self._open.pop(task)
            known = self.services[row]
            self.services[row] = known._replace(ended=when, robots=robots or known.begun_by)


def add_run(row: list[Run], run: Run) -> None:
    """Begin a run of a robot, unless it says the same; one that took no time is none."""
    if row and row[-1].begun == run.begun:
        row.pop()
    if not row or row[-1][1:] != run[1:]:
        row.append(run)
