"""What was seen of a fleet in continuous time, as the events of a record with their causes.

An event hangs on the latest one of its robots, or of its task; what comes from outside on nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from teamformer.mission.model import Mission
from teamformer.record.record import FLEET, Ending, Record
from teamformer.world.continuous.events import Event, PlanMade, PlannedTask
from teamformer.world.continuous.reasons import why_left_out
from teamformer.world.continuous.ways import Ways
from teamformer.world.rules.constants import NOBODY

FROM_OUTSIDE = ("lost", "back", "appear", "cancel", "missed", "plan")
"""Events that hang on nothing that was seen."""

WORKS = ("serve", "lift", "unload")


class EventsSeen:
    """Writes down one event after the other; robots and tasks are numbers, times the mission's."""

    def __init__(self) -> None:
        self.events: list[Event] = []
        self.over: dict[int, float] = {}  # tasks that are done, called off or missed, and when
        self.done: set[int] = set()
        self.missed: set[int] = set()
        self.lost: set[int] = set()
        self.at_work: dict[int, tuple[int, ...]] = {}  # by task
        self._since: dict[int, int] = {}  # the latest event of each robot
        self._of_task: dict[int, int] = {}

    def tell(
        self, at: float, kind: str, robots: Sequence[int] = (), task: int = NOBODY, **said: Any
    ) -> None:
        """Write down an event with what it `said`, unless it cannot be after what has been told.

        Times never run backwards: what is heard of late is told as of now.
        """
        at = max(at, self.events[-1].at if self.events else 0.0)
        robots = tuple(robot for robot in robots if robot not in self.lost or kind == "back")
        if not self._is_due(kind, robots, task):
            return
        if (
            kind == "done" and robots and task not in self.at_work
        ):  # it took no time, or nobody heard of it
            self.tell(at, "serve", robots, task, place=said["place"], until=at)
        known = [self._since.get(robot, NOBODY) for robot in robots]
        known += [self._of_task.get(task, NOBODY)]
        cause = NOBODY if kind in FROM_OUTSIDE else max(known)
        number = len(self.events)
        self.events.append(Event(at, kind, robots, task, cause=cause, **said))
        self._since |= dict.fromkeys(robots, number)
        if task != NOBODY and kind != "walk":
            self._of_task[task] = number
        self._note(self.events[-1])

    def _is_due(self, kind: str, robots: tuple[int, ...], task: int) -> bool:
        """Say whether there is something to tell of an event."""
        if kind in ("lost", "walk", "arrive", "back", "charge", "charged", "empty"):
            return bool(robots) and (kind != "back" or robots[0] in self.lost)
        if kind in ("done", "cancel", "missed", *WORKS):
            return task not in self.over and (kind not in WORKS or bool(robots))
        return kind != "broken" or task in self.at_work

    def _note(self, event: Event) -> None:
        if event.kind == "walk":  # whoever leaves is at work no more, though others may go on
            for task, robots in self.at_work.items():
                self.at_work[task] = tuple(r for r in robots if r not in event.robots)
        elif event.kind in WORKS:
            self.at_work[event.task] = event.robots
        elif event.kind in ("done", "cancel", "missed", "broken"):
            self.at_work.pop(event.task, None)
        if event.kind in ("done", "cancel", "missed"):
            self.over[event.task] = event.at
        if event.kind == "missed":
            self.missed.add(event.task)
        if event.kind == "done":
            self.done.add(event.task)
        if event.kind in ("lost", "empty"):
            self.lost.update(event.robots)
        elif event.kind == "back":
            self.lost.difference_update(event.robots)

    def plan(self, at: float, stops: Sequence[tuple[int, tuple[int, ...]]]) -> None:
        """Write down a plan: tasks with their coalitions, in order."""
        rows = tuple(PlannedTask(task, robots) for task, robots in stops)
        self.tell(at, "plan", plan=PlanMade((), rows))

    def miss_the_rest(self, at: float, truth: Mission) -> None:
        """Write down that every task of a mission is missed that is not over at a time."""
        ways = Ways(truth.world)
        for task in range(len(truth.tasks)):
            if task not in self.over:
                is_begun = task in self.at_work
                why = "under way" if is_begun else why_left_out(truth, ways, task)
                self.tell(at, "missed", (), task, why=why)

    def record(
        self,
        mission: Mission,
        at: float,
        status: str,
        seed: int = 0,
        blocked: tuple[str, ...] = (),
        truth: Mission | None = None,
    ) -> Record:
        """Return the record of what was seen until a time, at which the mission is over."""
        events = [event for event in self.events if event.at <= at]
        ours = (n for n, event in enumerate(events) if event.kind not in FROM_OUTSIDE)
        events.append(Event(at, "over", cause=max(ours, default=NOBODY), status=status))
        return Record(
            mission=mission,
            method=FLEET,
            seed=seed,
            events=tuple(events),
            truth=truth,
            end=Ending(
                status=status,
                makespan=at if status == "completed" else None,
                tasks_done=len(self.done),
                blocked_tasks=blocked,
                late=lateness(mission, self.over, self.done),
                missed=tuple(mission.tasks[task].name for task in sorted(self.missed)),
            ),
        )


def lateness(mission: Mission, ends: dict[int, float], done: set[int]) -> dict[str, float]:
    """Return by how much tasks that are done were late, by their names; nothing of the others."""
    due = {n: task.between[1] for n, task in enumerate(mission.tasks) if task.between}
    return {
        mission.tasks[n].name: ends[n] - due[n]
        for n in sorted(done & due.keys())
        if ends[n] > due[n]
    }
