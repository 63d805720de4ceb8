"""What comes from outside, and what robots see: whether the mission has it so."""

from __future__ import annotations

from teamformer.mission.parts.capabilities import describe
from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.names import BrokenRuleError, need
from teamformer.record.event_rules.outside import Due
from teamformer.record.event_rules.standing import FORMS, Standing, expect, one, work_on
from teamformer.record.event_rules.ways import stop_walking
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.rules.constants import NOBODY

SHORTEST_HOPE = 10
"""A service that is overdue is expected to take a tenth of the longest more, at least."""


def opens(now: Standing, event: Event) -> None:
    """Take in that a task opens: by its window, or as its linked start has come."""
    if event.cause == NOBODY:
        _from_outside(now, (event.at, "opens", event.task))
        return
    need(event.task in now.linked, f"{now.names.task(event.task)} has no links to hold it")


def _from_outside(now: Standing, due: Due) -> None:
    """Check that the mission has something happen now."""
    match = next((it for it in now.to_come if it[1:] == due[1:] and is_near(it[0], due[0])), None)
    if match is None:
        raise BrokenRuleError(f"by the mission it is not so that {now.names.outside(due)} now")
    now.to_come.remove(match)


def lost(now: Standing, event: Event) -> None:
    """Take in that a robot is lost."""
    robot = one(event)
    _from_outside(now, (event.at, "lost", robot))
    stand_still(now, robot, event)


def stand_still(now: Standing, robot: int, event: Event) -> None:
    """Take in that a robot stands still from now on."""
    it = now.robots[robot]
    stub = now.turns_at(robot)
    need(event.place == stub[-1].place, f"it is lost at {now.names.place(stub[-1].place)}")
    if it.work == NOBODY:
        stop_walking(now, robot)
    rota = now.truth.robots[robot].rota
    it.walked, it.rest = rota.worked(stub[0].at, now.now), rota.worked(now.now, stub[-1].at)
    it.way, it.is_lost = stub, True
    task, it.work, it.task = it.work, NOBODY, NOBODY
    if task == NOBODY:
        return
    work = now.works[task]
    work.robots = tuple(other for other in work.robots if other != robot)
    if work.part == FORMS or not now.brings(work.robots, task):
        now.breaks[task] = now.count


def back(now: Standing, event: Event) -> None:
    """Take in that a robot is back."""
    robot = one(event)
    _from_outside(now, (event.at, "back", robot))
    it = now.robots[robot]
    need(event.place == it.way[-1].place, f"it is back at {now.names.place(it.way[-1].place)}")
    it.is_lost = False
    if it.is_walking:
        before, after = it.way
        arrives = now.truth.robots[robot].rota.ends_leg(now.now, it.rest)
        it.way = (Passed(now.now - it.walked, before.place), Passed(arrives, after.place))
        it.walk = now.count


def rests(now: Standing, event: Event) -> None:
    """Take in that a shift ends: whatever the robot is at work on breaks off."""
    robot = one(event)
    _border(now, robot, begins=False)
    task = now.robots[robot].work
    if task != NOBODY and not is_near(now.all_done(task), now.now):
        now.breaks[task] = now.count


def works(now: Standing, event: Event) -> None:
    """Take in that a shift begins."""
    _border(now, one(event), begins=True)


def _border(now: Standing, robot: int, begins: bool) -> None:
    """Check that a shift of a robot begins or ends now."""
    due, rota = now.borders[robot], now.truth.robots[robot].rota
    word = "begins" if begins else "ends"
    is_due = due is not None and is_near(due[0], now.now) and due[1] == begins
    need(is_due, f"no shift of {now.names.robot(robot)} {word} now")
    touches = not begins and rota.is_at_work(now.now)
    now.borders[robot] = (now.now, True) if touches else rota.next_border(now.now)


def appear(now: Standing, event: Event) -> None:
    """Take in that a task becomes known."""
    _from_outside(now, (event.at, "appear", event.task))
    now.appeared.add(event.task)


def cancel(now: Standing, event: Event) -> None:
    """Take in that a task is called off."""
    task = event.task
    _from_outside(now, (event.at, "cancel", task))
    need(task not in now.over, f"{now.names.task(task)} is over already")
    now.over[task] = event.at
    if task in now.works:
        now.breaks[task] = now.count


def know(now: Standing, event: Event) -> None:
    """Take in that it becomes known what a task needs."""
    task, robot = event.task, one(event)
    name = now.names.task(task)
    need(task in now.unseen, f"what {name} needs is known already")
    need(task in now.appeared and task not in now.over, f"{name} cannot be seen")
    place = now.robots[robot].way[0].place
    need(place == now.place_of(task), f"{now.names.robot(robot)} is not at {name}")
    needs = now.truth.tasks[task].needs
    need(event.needs == dict(needs), f"{name} needs {describe(needs)}")
    now.unseen.discard(task)


def found(now: Standing, event: Event) -> None:
    """Take in that a robot sees where a task is."""
    task, robot = event.task, one(event)
    name, real = now.names.task(task), now.truth.tasks[task].at
    need(task in now.maybe, f"where {name} is is known already")
    need(task in now.appeared and task not in now.over, f"{name} cannot be seen")
    need(event.place == real, f"{name} is at {now.names.place(real)}")
    need(now.sees(robot, real), f"{now.names.robot(robot)} is too far away from {name}")
    if now.believed[task] != real and "start" not in now.news:
        now.news["task found"] = None
    del now.maybe[task], now.believed[task]


def moved(now: Standing, event: Event) -> None:
    """Take in that a task is not where it was believed, but somewhere else."""
    task, place = event.task, event.place
    name = now.names.task(task)
    need(task in now.maybe, f"where {name} is is known already")
    assert place is not None, "it has been read"
    need(place in now.maybe[task], f"{name} cannot be at {now.names.place(place)}")
    is_start = event.cause == NOBODY
    seen = range(len(now.robots)) if is_start else now.events[event.cause].robots
    was = now.believed[task]
    looked = any(now.sees(robot, was) and not now.sees(robot, place) for robot in seen)
    need(looked, f"nobody has looked at {now.names.place(was)}, where {name} was believed")
    now.believed[task] = place


def overdue(now: Standing, event: Event) -> None:
    """Take in that a service lasts longer than believed."""
    task = event.task
    work, wanted = work_on(now, event), now.mission.tasks[task]
    is_due = work.overdue is not None and is_near(work.overdue, event.at)
    need(is_due, f"{now.names.task(task)} is not overdue now")
    latest = work.begun + wanted.longest
    more = max((latest - now.now) / 2, wanted.longest / SHORTEST_HOPE)
    ends = min(latest, now.now + more)
    expect(event, ends + now.carried(task, work.robots) + wanted.unload)
    work.overdue = ends if ends < work.begun + now.truth.tasks[task].duration else None
