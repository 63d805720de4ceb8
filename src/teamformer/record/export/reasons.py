"""Why a robot did what it did: its story, worked out from the record alone."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.record.export.events import events
from teamformer.record.export.moments import Moment, moments
from teamformer.record.export.plans_in_force import PlansInForce
from teamformer.record.phases import (
    AT_WORK,
    CARRYING,
    FORMING,
    IDLE,
    LOADING,
    LOST,
    SERVING,
    UNLOADING,
    WAITING,
)
from teamformer.record.record import Record
from teamformer.record.task_times import known_steps, opening_steps, over_steps
from teamformer.world.rules.constants import NEVER, NOBODY


@dataclass(frozen=True)
class Chapter:
    """What a robot did from the end of one step to the end of another, and why."""

    begun: int
    ended: int
    what: str
    why: str


def explain(record: Record, robot: int) -> list[Chapter]:
    """Return the story of a robot, a chapter for each thing that it did.

    The record is gone through once: a chapter is told when it begins, by what was known then.
    """
    narrator = _Narrator(record, robot)
    told: list[tuple[int, str, str]] = []  # steps made, what, why
    doing = None
    for moment in islice(moments(record), 1, None):
        narrator.go_on(moment.step)
        now = (moment.phase[robot], moment.pursued[robot])
        if now != doing:
            told.append((moment.step - 1, narrator.what(moment), narrator.why(moment)))
        doing = now
    ends = [*(begun for begun, _, _ in told[1:]), len(record.steps)]
    return [Chapter(begun, end, *said) for (begun, *said), end in zip(told, ends, strict=False)]


class _Narrator:
    """Tells what a robot does in a step and why; goes on from step to step."""

    def __init__(self, record: Record, robot: int) -> None:
        self._record, self._mission, self._robot = record, record.mission, robot
        self._known, self._opens = known_steps(record), opening_steps(record)
        self._over_in = over_steps(record)
        self._over: set[int] = set()
        self._plans = PlansInForce(record)
        self._news: defaultdict[int, list[str]] = defaultdict(list)
        self._parts: dict[int, tuple[int, ...]] = {}  # by step, the team that the robot leaves
        for event in events(record):
            if event.kind == "splits" and robot in event.robots:
                self._parts[event.step] = event.robots
            if event.kind in ("appears", "cancelled", "lost", "back", "needs"):
                self._news[event.step].append(event.text(record.true_mission))

    def go_on(self, number: int) -> None:
        """Go on to a step, from the one before."""
        self._plans.go_on(number)
        self._over.update(task for task, step in self._over_in.items() if step == number)

    def what(self, moment: Moment) -> str:
        """Return what the robot does, and with whom."""
        phase, task = moment.phase[self._robot], moment.pursued[self._robot]
        name = "" if task == NOBODY else self._mission.tasks[task].name
        mates = _mates(self._mission, moment, self._robot)
        what = {
            LOST: "lost",
            IDLE: "idle",
            FORMING: self._parting(moment) or (f"forms {mates}" if mates else "forms a team"),
            SERVING: f"serves {name}",
            LOADING: f"loads {name}",
            CARRYING: f"carries {name}",
            UNLOADING: f"unloads {name}",
            WAITING: f"waits at {name}",
        }.get(phase, f"walks to {name}" if name else "walks, while plans are made anew")
        return f"{what}, {mates}" if mates and phase not in (LOST, FORMING) else what

    def _parting(self, moment: Moment) -> str:
        """Return the words for whom the robot parts from in a step; empty if it stays."""
        slot = moment.team[self._robot]
        left = [other for other in self._parts.get(moment.step, ()) if moment.team[other] != slot]
        names = ", ".join(self._mission.robots[other].name for other in left)
        return f"parts from {names}" if names else ""

    def why(self, moment: Moment) -> str:
        """Return why the robot does it; nothing where that goes without saying."""
        phase, task = moment.phase[self._robot], moment.pursued[self._robot]
        if phase == WAITING:
            before = self._waits_for(task)
            if before:
                return f"the task comes after {', '.join(before)}"
            if moment.step <= self._opens[task] < NEVER:
                return f"the task may not begin before step {self._opens[task] + 1}"
            return _why_waiting(self._record.true_mission, moment, self._robot, task)
        if phase == IDLE:
            return self._why_idle(moment)
        if phase in AT_WORK:
            return "its team brings all that the task needs"
        if phase in (LOST, FORMING) or task == NOBODY:
            return ""
        return "; ".join(filter(None, (self._why_task(moment, task), self._why_now())))

    def _waits_for(self, task: int) -> list[str]:
        """Return the tasks that a task comes after and that are not over."""
        over = {self._mission.tasks[other].name for other in self._over}
        return [name for name in self._mission.tasks[task].after if name not in over]

    def _why_idle(self, moment: Moment) -> str:
        is_open = [
            task
            for number, task in enumerate(self._mission.tasks)
            if self._known[number] < moment.step and number not in self._over
        ]
        if not is_open:
            return "no task is open"
        if self._plans.has_shared_plan and not self._has_part_left():
            return "the plan has nothing left for it"
        can = total(self._mission.robots[mate].can for mate in _team(moment, self._robot))
        useful = [task.name for task in is_open if set(task.needs) & set(can)]
        if not useful:
            return "no open task needs what it brings"
        return f"others are to do {', '.join(useful)}"

    def _has_part_left(self) -> bool:
        """Say whether the shared plan has the robot do a task that is not over."""
        left = self._plans.tasks_shared_out() - self._over
        return any(self._robot in self._plans.coalition(task) for task in left)

    def _why_task(self, moment: Moment, task: int) -> str:
        """Return which plan said so: the policy itself, the plan, or the shared order."""
        if moment.team[self._robot] in self._record.steps[moment.step - 1].named:
            return "its policy named the task itself"
        if self._plans.has_shared_plan:
            looking = self._plans.scouts_of(task).intersection(_team(moment, self._robot))
            if looking:
                names = ", ".join(self._mission.robots[scout].name for scout in sorted(looking))
                return f"the plan has {names} look first what is to be known of it"
            return _in_plan(self._mission, self._plans.coalition(task))
        if task in self._plans.order:
            place = self._plans.order.index(task) + 1
            return f"number {place} in the order that everybody shares"
        return ""

    def _why_now(self) -> str:
        """Return when the plan that holds was made, and after what, if not at the start."""
        made = self._plans.made
        if not made:
            return ""
        taken_over = ["a longer search was taken over"] if self._plans.is_taken_over else []
        causes = [*self._news.get(made, ()), *taken_over]
        return f"planned anew after step {made}{': ' if causes else ''}{', '.join(causes)}"


def _why_waiting(mission: Mission, moment: Moment, robot: int, task: int) -> str:
    mates = _team(moment, robot)
    short = missing(total(mission.robots[mate].can for mate in mates), mission.tasks[task].needs)
    if not short:
        return "its team brings all that the task needs"
    coming = [
        mission.robots[other].name
        for other, goal in enumerate(moment.task)
        if goal == task and other not in mates and set(short) & set(mission.robots[other].can)
    ]
    who = ", ".join(coming) or "nobody on the way"
    return f"lacks {describe(short)}, which {who} {'bring' if len(coming) > 1 else 'brings'}"


def _in_plan(mission: Mission, robots: tuple[int, ...]) -> str:
    names = ", ".join(mission.robots[robot].name for robot in robots)
    together = " together" if len(robots) > 1 else ""
    return f"the plan has {names} do it{together}" if robots else ""


def _team(moment: Moment, robot: int) -> list[int]:
    slot = moment.team[robot]
    return [mate for mate, team in enumerate(moment.team) if team == slot and slot != NOBODY]


def _mates(mission: Mission, moment: Moment, robot: int) -> str:
    names = [mission.robots[mate].name for mate in _team(moment, robot) if mate != robot]
    return f"with {', '.join(names)}" if names else ""


def story_lines(record: Record, robot: int) -> Iterator[tuple[str, str, str]]:
    """Yield (steps, what, why) of each chapter as texts."""
    for chapter in explain(record, robot):
        yield f"{chapter.begun + 1}-{chapter.ended}", chapter.what, chapter.why
