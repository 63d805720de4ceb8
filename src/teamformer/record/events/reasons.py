"""Why robots do what they do in continuous time, in words, by what was known then."""

from __future__ import annotations

import math
from collections.abc import Sequence

from teamformer.base.naming import listed
from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.shifts import fits_all
from teamformer.mission.parts.zones import may_unload, rooms_of
from teamformer.mission.precedence import tasks_before
from teamformer.record.events.runs import Runs
from teamformer.record.phases import (
    AT_WORK,
    CARRYING,
    FORMING,
    LOST,
    OFF,
    UNLOADING,
    WAITING,
    WALKING,
    WHY_AT_CHARGER,
)
from teamformer.record.told.zones import held_in
from teamformer.world.continuous.events import Event, PlanMade
from teamformer.world.rules.constants import NOBODY

IN_THE_NEWS = {
    "lost": "{robots} lost",
    "empty": "{robots} has run dry",
    "back": "{robots} back",
    "appear": "{task} appears",
    "cancel": "{task} called off",
    "missed": "{task} missed",
    "know": "{task} needs {needs}",
    "found": "{task} found",
    "broken": "{task} broken off",
    "overdue": "{task} takes longer",
    "done": "{task} done",
}
"""What is said of events of a moment at which a plan is made anew."""


class Explainer:
    """Tells why robots do what they do after the latest event."""

    def __init__(self, mission: Mission, runs: Runs) -> None:
        self._mission, self._runs = mission, runs
        self._before, self._rooms = tasks_before(mission.tasks), rooms_of(mission)
        self._lies: dict[int, Place] = {}  # where loads were set down
        self._now = 0.0
        self._news: list[str] = []  # of this moment
        self._plan: PlanMade | None = None
        self._coalitions: dict[int, tuple[int, ...]] = {}
        self._made = ""  # when the plan that holds was made, and after what, if not at the start

    def go_on(self, event: Event) -> None:
        """Take in an event that the runs have taken in."""
        if event.kind in ("broken", "unload") and event.place is not None and self._rooms:
            self._lies[event.task] = event.place
            self._rooms = rooms_of(self._mission, self._lies)
        if event.at > self._now:
            self._now, self._news = event.at, []
        if event.plan is not None:
            self._plan = event.plan
            self._coalitions = {row.task: row.robots for row in event.plan.tasks}
            causes = ", ".join(self._news or event.plan.reasons)
            self._made = f"planned anew at {event.at:g}: {causes}" if event.at else ""
        elif event.kind in IN_THE_NEWS:
            self._news.append(self._told(event))

    def whose(self, event: Event) -> Sequence[int]:
        """Return the robots that may do something else since an event, or for another reason."""
        if event.plan is not None:
            return range(len(self._mission.robots))
        kinds = {"arrive", "done", "cancel", "missed", "opens", "know"}
        if event.kind not in (
            kinds | {"serve", "broken", "lift", "unload"} if self._rooms else kinds
        ):
            return sorted(self._runs.changed)
        waits = (n for n in range(len(self._mission.robots)) if self._run(n)[0] == WAITING)
        return sorted({*self._runs.changed, *waits})

    def why(self, robot: int) -> tuple[str, ...]:
        """Return why a robot does it; nothing where that goes without saying."""
        phase, task = self._run(robot)
        if phase in (LOST, FORMING):
            return ()
        if phase == OFF:
            return (self._why_off(robot),)
        if phase in (CARRYING, UNLOADING):
            return ("its team brings all that the load takes, and stays until it is unloaded",)
        if phase in AT_WORK:
            return ("its team brings all that the task needs, and stays until that is done",)
        if phase in WHY_AT_CHARGER:
            return (WHY_AT_CHARGER[phase],)
        if phase == WAITING:
            return (self._why_waiting(task),)
        if task == NOBODY:
            return (self._why_free(robot),)
        return tuple(filter(None, (self._planned(task), self._made)))

    def _why_off(self, robot: int) -> str:
        again = self._mission.robots[robot].rota.goes_on(self._now)
        return (
            "its last shift is over" if again == math.inf else f"its next shift begins at {again:g}"
        )

    def _run(self, robot: int) -> tuple[str | None, int]:
        """Return what a robot does, and what for."""
        run = self._runs.now(robot)
        return run.phase, run.task

    def _told(self, event: Event) -> str:
        task = None if event.task == NOBODY else self._mission.tasks[event.task]
        return IN_THE_NEWS[event.kind].format(
            robots=self._names(event.robots),
            task=task.name if task else "",
            needs=describe(event.needs or {}),
        )

    def _why_waiting(self, task: int) -> str:
        if task in self._runs.queue:
            work = self._runs.at_work
            full = (room for room in self._rooms if not may_unload([room], work, task))
            return next((held_in(self._mission, room, work, ()) for room in full), "")
        tasks, over = self._mission.tasks, self._runs.over
        before = [tasks[k].name for k in self._before.get(task, ()) if k not in over]
        if before:
            return f"the task comes after {', '.join(before)}"
        if self._now < (opens := release_of(tasks[task])):
            return f"the task may not begin before {opens:g}"
        there, coming = self._heading(task)
        robots = self._mission.robots
        lacks = missing(total(robots[r].can for r in there), tasks[task].needs)
        bring = [r for r in coming if set(lacks) & set(robots[r].can)]
        if lacks:
            who = self._names(bring) or "nobody on the way"
            return f"lacks {describe(lacks)}, which {who} {'bring' if len(bring) > 1 else 'brings'}"
        late = [r for r in self._coalitions.get(task, ()) if r in coming]
        off = [r for r in self._coalitions.get(task, ()) if self._run(r)[0] == OFF]
        if off and not late:
            return f"{self._names(off)} {'are' if len(off) > 1 else 'is'} off"
        if not late and (held := self._held_in_a_zone(task)):
            return held
        if not late and self._does_not_fit(task):
            return "the task does not fit into what is left of the shifts of its robots"
        return f"{self._names(late)} is to come" if late else "the task is to begin later"

    def _held_in_a_zone(self, task: int) -> str:
        """Return in which zone a task waits for what; nothing if in none."""
        work = self._runs.at_work
        begun = self._runs.over | self._runs.under_way
        waiting = [row.task for row in (self._plan.tasks if self._plan else ()) if row.robots]
        waiting = [other for other in waiting if other not in begun]
        for room in self._rooms:
            if task in room.tasks and not room.has_turn(waiting, work, task):
                return held_in(self._mission, room, work, waiting)
        return ""

    def _does_not_fit(self, task: int) -> bool:
        """Say whether a task is too long for what is left of the shifts of its robots."""
        wanted = self._mission.tasks[task]
        rotas = [self._mission.robots[robot].rota for robot in self._coalitions.get(task, ())]
        return fits_all(rotas, self._now, wanted.duration + wanted.unload) > self._now

    def _heading(self, task: int) -> tuple[list[int], list[int]]:
        """Return the robots that wait at a task, and those that walk to it."""
        found: dict[str, list[int]] = {WAITING: [], WALKING: []}
        for robot in range(len(self._mission.robots)):
            phase, about = self._run(robot)
            if about == task and phase in found:
                found[phase].append(robot)
        return found[WAITING], found[WALKING]

    def _why_free(self, robot: int) -> str:
        over, rows = self._runs.over, self._plan.tasks if self._plan else ()
        left = [row.task for row in rows if robot in row.robots and row.task not in over]
        if left:
            return f"the plan has it do {self._mission.tasks[left[0]].name} next"
        is_open = len(over) < len(self._mission.tasks)
        return "the plan has nothing left for it" if is_open else "no task is open"

    def _planned(self, task: int) -> str:
        coalition = self._coalitions.get(task, ())
        together = " together" if len(coalition) > 1 else ""
        return f"the plan has {self._names(coalition)} do it{together}" if coalition else ""

    def _names(self, robots: Sequence[int]) -> str:
        return listed([self._mission.robots[robot].name for robot in robots])
