"""What happened in a record, in order: the events of its tables and logs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe
from teamformer.mission.parts.grid import Place
from teamformer.record.record import Record
from teamformer.record.task_times import cancelled_steps, known_steps
from teamformer.record.teams import Teams

TOLD = {
    "appears": "{task} appears",
    "needs": "{task} needs {needs}",
    "found": "{task} found at {place}",
    "cancelled": "{task} called off",
    "done": "{task} done by {names}",
    "takes up": "{task} taken up by {names}",
    "sets down": "{task} set down at {place}",
    "lost": "{names} lost",
    "back": "{names} back",
    "splits": "{names} part",
    "joins": "{names} are one team",
}
"""What is said of an event of each kind; of the end, its kind."""

UNKNOWN_DOERS = "{task} done by then, not known by whom"


@dataclass(frozen=True)
class Event:
    """Something that happened in a step: who did it, and to which task if to one."""

    step: int
    kind: str  # appears, splits, joins, cancelled, lost, back, found, needs, takes up, sets down,
    # done, or how the trial ended
    robots: tuple[int, ...] = ()
    task: int | None = None
    place: Place | None = None  # of what is set down

    def text(self, mission: Mission) -> str:
        """Return the event as a sentence; the mission is the mission as it really was."""
        if self.kind not in TOLD:
            return self.kind
        task = None if self.task is None else mission.tasks[self.task]
        if self.kind == "done" and not self.robots:
            return UNKNOWN_DOERS.format(task=task.name if task else "")
        x, y = self.place or (task.at if task else (0, 0))
        return TOLD[self.kind].format(
            names=_names(mission, self.robots),
            task=task.name if task else "",
            needs=describe(task.needs) if task else "",
            place=f"[{x:g}, {y:g}]",
        )


def events(record: Record) -> Iterator[Event]:
    """Yield the events of a record."""
    teams = Teams(record.mission.robots, record.start)
    appears: defaultdict[int, list[int]] = defaultdict(list)
    for task, steps in enumerate(known_steps(record)):
        appears[steps].append(task)
    cancelled: defaultdict[int, list[int]] = defaultdict(list)
    for task, called_off in cancelled_steps(record).items():
        cancelled[called_off].append(task)
    for number, step in enumerate(record.steps, start=1):
        for stay, leave in step.splits:
            teams.split(stay, leave)
            yield Event(number, "splits", tuple(sorted((*stay, *leave))))
        for one, other in step.joins:
            yield Event(number, "joins", teams.join(one, other))
        for task in cancelled.get(number, ()):
            yield Event(number, "cancelled", task=task)
        for robot in step.lost:
            teams.lose(robot)
            yield Event(number, "lost", (robot,))
        for robot in step.back:
            teams.bring_back(robot)
            yield Event(number, "back", (robot,))
        for task in step.found:
            yield Event(number, "found", task=task)
        for task in step.shown:
            yield Event(number, "needs", task=task)
        for task, slot in step.taken:
            yield Event(number, "takes up", teams.robots[slot], task)
        for task, x, y in step.left:
            yield Event(number, "sets down", task=task, place=(x, y))
        for task, doer in step.done:
            yield Event(number, "done", teams.doers(doer), task)
        for task in appears.get(number, ()):
            yield Event(number, "appears", task=task)
    yield Event(len(record.steps), record.end.status)


def _names(mission: Mission, robots: Sequence[int]) -> str:
    return ", ".join(mission.robots[robot].name for robot in robots)
