"""Whether what a record says an uncertain mission really was can be."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from teamformer.mission.model import Arrivals, Mission, Robot, Task
from teamformer.mission.parts.capabilities import exact, total
from teamformer.mission.parts.places import possible_places
from teamformer.mission.parts.reach import can_reach
from teamformer.record.record import Record
from teamformer.record.referee.verdict import Notes


def judge_truth(record: Record, notes: Notes) -> None:
    """Check that the mission which was played is one that the mission allows."""
    for message in wrong_truths(record.mission, record.true_mission):
        notes.note(message)


def wrong_truths(mission: Mission, truth: Mission) -> Iterator[str]:
    """Say what of a truth a mission does not allow; both have the same tasks and robots."""
    for task, true in zip(mission.tasks, truth.tasks, strict=True):
        if not (
            _can_be_task(task, true)
            and true.at in possible_places(mission.world, task.at, task.within)
        ):
            yield f"task {task.name} cannot really have been like that"
    if mission.arrivals is not None:
        yield from _wrong_arrivals(mission, mission.arrivals)
    for robot, real in zip(mission.robots, truth.robots, strict=True):
        if not _can_be_robot(robot, real):
            yield f"robot {robot.name} cannot really have been like that"


def _wrong_arrivals(mission: Mission, arrivals: Arrivals) -> Iterator[str]:
    """Say which tasks that appeared at random cannot have."""
    latest = float(arrivals.since)
    for task in mission.tasks:
        if not task.has_arrived:
            continue
        near = (r.can for r in mission.robots if can_reach(mission.world, r, task.at))
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
