"""Whether robots go where the plan has them go, by ways as short as can be."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.mission.parts.grid import Place
from teamformer.record.event_rules.lengths import NEAR, is_near
from teamformer.record.event_rules.names import BrokenRuleError, need
from teamformer.record.event_rules.standing import Standing, one
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.rules.constants import NOBODY


def walk(now: Standing, event: Event) -> None:
    """Take in that a robot sets out."""
    robot = one(event)
    it, task = now.robots[robot], event.task
    name = now.names.robot(robot)
    need(not it.is_lost, f"{name} sets out, and is lost")
    need(it.work == NOBODY, f"{name} sets out, and is at work")
    goal = event.way[-1].place
    if task != NOBODY:
        judge_goal(now, robot, task, goal)
    judge_way(now, (robot,), event, now.turns_at(robot), goal)
    stop_walking(now, robot)
    it.way, it.task, it.walk = event.way, task, now.count


def judge_goal(now: Standing, robot: int, task: int, goal: Place) -> None:
    """Check that a robot heads for the task that the plan has for it, and where that is."""
    name = now.names.robot(robot)
    due = now.next_task(robot)
    is_look = task in now.unseen and now.is_open(task)
    if task != due and not is_look:
        to = "nothing" if due == NOBODY else now.names.task(due)
        raise BrokenRuleError(
            f"{name} heads for {now.names.task(task)}, and the plan has it do {to}"
        )
    place = now.place_of(task)
    if goal != place and not now.never_gets(robot, place):
        at, there = now.names.place(place), now.names.place(goal)
        raise BrokenRuleError(f"{now.names.task(task)} is at {at}, and the way leads to {there}")


def judge_way(
    now: Standing,
    robots: tuple[int, ...],
    event: Event,
    stub: tuple[Passed, ...],
    goal: Place,
) -> None:
    """Check that a way begins where robots are, is as short as can be, and takes so long.

    Together they go round obstacles if somebody walks, and take as long as the slowest would alone.
    """
    way = event.way
    if not _is_same_way(way[: len(stub)], stub):
        said, due = (now.names.passed(part[0]) for part in (way, stub))
        raise BrokenRuleError(f"the way begins at {said} in the record, by the rules at {due}")
    alone = {robot: now.takes(robot, stub[-1].place, goal) for robot in robots}
    walkers = [robot for robot in robots if not now.truth.robots[robot].flies]
    slowest = max(walkers or robots, key=alone.__getitem__)
    slower = max(alone.values()) / alone[slowest] if alone[slowest] > 0 else 1.0
    speed, spent, here = now.truth.robots[slowest].speed / slower, 0.0, stub[-1].place
    for at, place in way[len(stub) :]:
        spent += now.lengths.between(here, place, slowest)
        due_at = now.lengths.when(robots, stub[-1].at, spent / speed)
        if place == here and len(robots) == 1:  # it pauses there, where a shift has just ended
            rounded = due_at + NEAR * max(1.0, due_at)
            due_at = now.truth.robots[robots[0]].rota.goes_on(rounded)
        if not is_near(at, due_at):
            what = f"{now.names.place(place)} is passed at {due_at:.9g} by the rules"
            raise BrokenRuleError(f"{what} and at {at:.9g} in the record")
        here = place
    length = now.lengths.between(stub[-1].place, goal, slowest)
    if not is_near(spent, length):
        raise BrokenRuleError(f"the way is {spent:.9g} long, and a way of {length:.9g} leads there")
    until = way[-1].at
    need(event.until is not None and is_near(event.until, until),
               f"it is there at {until:.9g}, and the record says {event.until}")  # fmt: skip


def arrive(now: Standing, event: Event) -> None:
    """Take in that a robot arrives, or stops where it is."""
    robot = one(event)
    it, name = now.robots[robot], now.names.robot(robot)
    need(not it.is_lost and it.work == NOBODY, f"{name} cannot arrive")
    stub = now.turns_at(robot)
    if it.is_walking and is_near(it.way[-1].at, event.at):
        stub = it.way[-1:]
        need(event.cause == it.walk, f"{name} arrives by another way than its own")
        need(event.task == it.task, f"{name} arrives for another task than its own")
    elif event.task != NOBODY:
        judge_goal(now, robot, event.task, stub[-1].place)
    last = stub[-1]
    need(len(stub) == 1, f"{name} is between two places, and arrives")
    place = now.names.place(last.place)
    need(event.place == last.place, f"{name} is at {place}, and arrives elsewhere")
    stop_walking(now, robot)
    it.way, it.task = (Passed(event.at, last.place),), event.task


def stop_walking(now: Standing, robot: int) -> None:
    """Add up for how long a robot has been on its way."""
    it = now.robots[robot]
    if it.is_walking:
        now.travel += now.truth.robots[robot].rota.worked(now.events[it.walk].at, now.now)


def _is_same_way(one: Sequence[Passed], other: Sequence[Passed]) -> bool:
    """Say whether two ways pass the same places at the same times."""
    if len(one) != len(other):
        return False
    return all(
        is_near(a.at, b.at) and all(map(is_near, a.place, b.place))
        for a, b in zip(one, other, strict=True)
    )
