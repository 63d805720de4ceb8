"""What happened in a record, in order, as its tables and logs tell it."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.roads import Roads
from teamformer.record.record import Record
from teamformer.record.task_times import cancelled_steps, known_steps
from teamformer.record.teams import Teams
from teamformer.world.rules.constants import NOBODY

TOLD = {
    "appears": "{task} appears",
    "needs": "{task} needs {needs}",
    "found": "{task} found at {place}",
    "cancelled": "{task} called off",
    "missed": "{task} missed",
    "done": "{task} done by {names}",
    "takes up": "{task} taken up by {names}",
    "sets down": "{task} set down at {place}",
    "breaks off": "{task} broken off",
    "lost": "{names} lost",
    "dry": "{names} has run dry",
    "back": "{names} back",
    "splits": "{names} part",
    "joins": "{names} are one team",
}
"""What is said of an entry of each kind; of the end, its kind."""

UNKNOWN_DOERS = "{task} done by then, not known by whom"


@dataclass(frozen=True)
class LogEntry:
    """Something that happened: who did it, and to which task if to one.

    `at` is the step, or in continuous time the moment.
    """

    at: float
    kind: str  # appears, splits, joins, cancelled, lost, dry, back, found, needs, takes up,
    # sets down, breaks off, missed, done, or how the trial ended
    robots: tuple[int, ...] = ()
    task: int | None = None
    place: Place | None = None  # of what is set down

    def text(self, mission: Mission) -> str:
        """Return the entry as a sentence; the mission is the mission as it really was."""
        if self.kind not in TOLD:
            return self.kind
        task = None if self.task is None else mission.tasks[self.task]
        if self.kind == "done" and not self.robots:
            return UNKNOWN_DOERS.format(task=task.name if task else "")
        at = self.place or (task.at if task else (0, 0))
        return TOLD[self.kind].format(
            names=_names(mission, self.robots),
            task=task.name if task else "",
            needs=describe(task.needs) if task else "",
            place=_place(mission, at),
        )


def events(record: Record) -> Iterator[LogEntry]:
    """Yield what happened in a record."""
    yield from _of_events(record) if record.is_continuous else _of_steps(record)


IN_THE_LOG = {
    "appear": "appears",
    "cancel": "cancelled",
    "missed": "missed",
    "lost": "lost",
    "empty": "dry",
    "back": "back",
    "found": "found",
    "know": "needs",
    "lift": "takes up",
    "broken": "breaks off",
    "done": "done",
}
"""The kinds of events in continuous time that logs tell, and what they are called there."""


def _of_events(record: Record) -> Iterator[LogEntry]:
    for event in record.events:
        task = None if event.task == NOBODY else event.task
        if event.kind == "broken" and event.place is not None:
            yield LogEntry(event.at, "sets down", task=task, place=event.place)
        elif event.kind in IN_THE_LOG:
            yield LogEntry(event.at, IN_THE_LOG[event.kind], event.robots, task)
    yield LogEntry(record.length, record.end.status)


def loss_of(truth: Mission, robot: int, step: int) -> LogEntry:
    """Return that a robot is lost in a step, or has run dry: then the mission has no loss of it."""
    is_lost = any(away.lost == step for away in truth.robots[robot].absences)
    is_dry = truth.robots[robot].battery is not None and not is_lost
    return LogEntry(step, "dry" if is_dry else "lost", (robot,))


def _of_steps(record: Record) -> Iterator[LogEntry]:
    teams = Teams(record.mission.robots, record.start)
    appears: defaultdict[float, list[int]] = defaultdict(list)
    for task, steps in enumerate(known_steps(record)):
        appears[steps].append(task)
    cancelled: defaultdict[float, list[int]] = defaultdict(list)
    for task, called_off in cancelled_steps(record).items():
        cancelled[called_off].append(task)
    for number, step in enumerate(record.steps, start=1):
        for stay, leave in step.splits:
            teams.split(stay, leave)
            yield LogEntry(number, "splits", tuple(sorted((*stay, *leave))))
        for one, other in step.joins:
            yield LogEntry(number, "joins", teams.join(one, other))
        for task in cancelled.get(number, ()):
            yield LogEntry(number, "cancelled", task=task)
        for robot in step.lost:
            teams.lose(robot)
            yield loss_of(record.true_mission, robot, number)
        for robot in step.back:
            teams.bring_back(robot)
            yield LogEntry(number, "back", (robot,))
        for task in step.found:
            yield LogEntry(number, "found", task=task)
        for task in step.shown:
            yield LogEntry(number, "needs", task=task)
        for task, slot in step.taken:
            yield LogEntry(number, "takes up", teams.robots[slot], task)
        for task, x, y in step.left:
            yield LogEntry(number, "sets down", task=task, place=(x, y))
        for task, doer in step.done:
            yield LogEntry(number, "done", teams.doers(doer), task)
        for task, _ in step.missed:
            yield LogEntry(number, "missed", task=task)
        for task in appears.get(number, ()):
            yield LogEntry(number, "appears", task=task)
    yield LogEntry(len(record.steps), record.end.status)


def _place(mission: Mission, at: Place) -> str:
    if isinstance(mission.world, Roads):
        return mission.world.name_of(at)
    return f"[{at[0]:g}, {at[1]:g}]"


def _names(mission: Mission, robots: Sequence[int]) -> str:
    return ", ".join(mission.robots[robot].name for robot in robots)
