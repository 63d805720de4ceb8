"""Whether what a record says an uncertain mission really was can be, and what was known when."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from teamformer.mission.checks.rules import LEAST_CHANCE
from teamformer.mission.model import Arrivals, Mission, Robot, Task
from teamformer.mission.parts.capabilities import Counts, exact, total
from teamformer.record.record import Record, Step
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.finding import can_be_at, places_of
from teamformer.record.referee.rules.teams import Fleet, gets_there
from teamformer.record.referee.rules.verdict import Notes


def judge_truth(record: Record, notes: Notes) -> None:
    """Check that the mission which was played is one that the mission allows."""
    for message in wrong_truths(record.mission, record.true_mission):
        notes.note(message)


def wrong_truths(mission: Mission, truth: Mission) -> Iterator[str]:
    """Say what of a truth a mission does not allow; both have the same tasks and robots."""
    for task, true in zip(mission.tasks, truth.tasks, strict=True):
        if not (_can_be_task(task, true) and can_be_at(mission, task, true.at)):
            yield f"task {task.name} cannot really have been like that"
    if mission.arrivals is not None:
        yield from _wrong_arrivals(mission, mission.arrivals)
    for robot, real in zip(mission.robots, truth.robots, strict=True):
        if not _can_be_robot(robot, real):
            yield f"robot {robot.name} cannot really have been like that"


def _wrong_arrivals(mission: Mission, arrivals: Arrivals) -> Iterator[str]:
    """Say which tasks that appeared at random cannot have."""
    latest = arrivals.since
    for task in mission.tasks:
        if not task.has_arrived:
            continue
        near = (r.can for r in mission.robots if gets_there(mission.world, r, task.at))
        able = {cap for cap, count in total(near).items() if count >= 1}
        is_possible = (
            arrivals.rate > 0
            and latest < task.appears <= arrivals.until
            and task.duration == arrivals.duration
            and set(task.needs.values()) == {1}
            and task.needs.keys() <= able
            and len(task.needs) <= (arrivals.most_needs or len(able))
        )
        if not is_possible:
            yield f"task {task.name} cannot have appeared like that"
        latest = task.appears


def _can_be_task(task: Task, true: Task) -> bool:
    least, most = (task.duration, task.duration) if task.lasts is None else task.lasts
    for cap in {*task.needs, *task.may_need, *true.needs}:
        more = exact(true.needs.get(cap, 0) - task.needs.get(cap, 0))
        chance = task.may_need.get(cap, 0)
        if not (more == 0 and chance < 1) and not (more == 1 and chance > 0):
            return False
    is_known = true == task.once_known(true.at, true.needs, true.duration)
    return least <= true.duration <= most and is_known


def _can_be_robot(robot: Robot, real: Robot) -> bool:
    if robot.delays is not None and real.delays is not None and robot.delays.seed is None:
        robot = replace(robot, delays=replace(robot.delays, seed=real.delays.seed))
    if replace(robot, breaks=None, absences=()) != replace(real, absences=()):
        return False
    if robot.breaks is None:
        return robot == real
    rate, repair = robot.breaks.rate, robot.breaks.repair
    if not real.absences:
        return rate < 1
    times = [(away.lost, away.back) for away in real.absences]
    before = [0, *(back or math.inf for _, back in times)]
    is_in_order = all(lost > back for (lost, _), back in zip(times, before, strict=False))
    if rate == 0 or not is_in_order:
        return False
    if repair is None:
        return all(back is None for _, back in times)
    return all(back and repair[0] <= back - lost <= repair[1] for lost, back in times)


class NeedsKnown:
    """What is believed that tasks need, and when that changed."""

    def __init__(self, mission: Mission, foresight: str) -> None:
        self._mission, self._foresight = mission, foresight
        self._hidden = {number for number, task in enumerate(mission.tasks) if task.may_need}
        self._shown_at: dict[int, float] = dict.fromkeys(self._hidden, math.inf)
        self._changes: list[tuple[int, dict[int, Counts]]] = []  # steps made, by task
        self.shown_after: set[int] = set()
        self.expect(set(range(len(mission.robots))), 0)

    def expect(self, robots: set[int], steps_made: int) -> None:
        """Expect of what may be needed no more than the robots that are left can bring."""
        if self._hidden:
            hoped = {number: self._hoped(number, robots) for number in self._hidden}
            self._changes.append((steps_made, hoped))

    def _hoped(self, number: int, robots: set[int]) -> Counts:
        world, task = self._mission.world, self._mission.tasks[number]
        fleet = (self._mission.robots[robot] for robot in robots)
        place = places_of(world, task)[0]
        have = total(r.can for r in fleet if gets_there(world, r, place))
        needs = dict(task.needs)
        least = LEAST_CHANCE[self._foresight]
        for cap, chance in task.may_need.items():
            if 0 < chance >= least and have.get(cap, 0) >= exact(needs.get(cap, 0) + 1):
                needs[cap] = exact(needs.get(cap, 0) + 1)
        return needs

    def show(self, fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> bool:
        """Work out whose needs become known in a step, and say where the record differs.

        Returns whether any do.
        """
        teams = fleet.teams.values()
        truth = tasks.mission.tasks
        found = {
            task
            for task in self._hidden
            if tasks.is_open(task, number - 1)
            and any(fleet.is_at(t, truth[task].at) for t in teams)
        }
        for task in sorted(found ^ set(step.shown)):
            name = truth[task].name
            if task in found:
                notes.note(f"a team stands at task {name}, and the record does not show its needs")
            else:
                notes.note(f"the record shows what task {name} needs, where nobody can know it")
        if len(set(step.shown)) < len(step.shown):
            notes.note("the record shows what a task needs twice")
        self._hidden -= found
        if found:
            self.shown_after.add(number)
            self._shown_at |= dict.fromkeys(found, number)
            self._changes.append((number, {task: truth[task].needs for task in found}))
        return bool(found)

    def is_shown(self, task: int, steps_made: int) -> bool:
        """Say whether it was known what a task needs once so many steps were made."""
        return self._shown_at.get(task, 0) <= steps_made

    def needs(self, task: int, steps_made: int) -> Counts:
        """Return what a task was believed to need once so many steps were made."""
        believed = self._mission.tasks[task].needs
        for since, needs in self._changes:
            if since <= steps_made:
                believed = needs.get(task, believed)
        return believed
