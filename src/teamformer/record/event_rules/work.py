"""Whether teams form, serve and carry when and how they may."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from teamformer.mission.parts.capabilities import describe, missing, total
from teamformer.mission.parts.grid import Place
from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.names import need
from teamformer.record.event_rules.standing import (
    CARRIES,
    FORMS,
    QUEUES,
    SERVES,
    UNLOADS,
    Standing,
    WorkNow,
    expect,
    has_to_form,
    is_too_late,
    turning,
    work_on,
)
from teamformer.record.event_rules.ways import judge_way
from teamformer.world.continuous.events import Event, Passed
from teamformer.world.rules.constants import NOBODY


def form(now: Standing, event: Event) -> None:
    """Take in that a team begins to form."""
    _judge_team(now, event)
    need(has_to_form(now, event.robots), "the team forms, and need not")
    fits = now.fits(event.robots, now.mission.forming)
    need(fits, "forming does not fit into the shifts of the team")
    ends = now.now + now.mission.forming
    expect(event, ends)
    _begin(now, event, WorkNow(event.robots, FORMS, now.now, ends, now.count))


def formed(now: Standing, event: Event) -> None:
    """Take in that a team has formed."""
    _end_part(now, event, FORMS)
    del now.works[event.task]
    _free(now, event.robots, event.place, event.task)


def serve(now: Standing, event: Event) -> None:
    """Take in that a service begins."""
    task = event.task
    _judge_team(now, event)
    name, real, wanted = now.names.task(task), now.truth.tasks[task], now.mission.tasks[task]
    have = total(now.truth.robots[robot].can for robot in event.robots)
    lacks = missing(have, real.needs)
    need(not lacks, f"the team of {name} lacks {describe(lacks)}")
    need(now.is_released(task), f"{name} may not begin yet")
    need(task not in now.maybe, f"nobody knows where {name} is")
    need(not has_to_form(now, event.robots), f"the team of {name} has not formed")
    need(not is_too_late(now, task, event.robots), f"{name} cannot end by {now.mission.until}")
    may_enter = now.enters(task) or now.is_quiet  # else nobody would ever go on
    need(may_enter, f"{name} begins before its turn in a zone, or without room there")
    takes = now.believed_time(task, event.robots)
    need(now.fits(event.robots, takes), f"{name} does not fit into the shifts of its team")
    expect(event, now.now + takes)
    ends = now.now + real.duration
    overdue = now.now + wanted.duration if wanted.duration < real.duration else None
    now.started[task] = now.now
    _begin(now, event, WorkNow(event.robots, SERVES, now.now, ends, now.count, overdue=overdue))


def _judge_team(now: Standing, event: Event) -> None:
    """Check that a whole team stands at a task, with nothing else to do."""
    task = event.task
    name = now.names.task(task)
    need(task in now.appeared, f"{name} is not known yet")
    need(task not in now.over, f"{name} is over")
    need(task not in now.works, f"{name} is being served, or its team forms")
    place, team = now.place_of(task), now.team_of(task)
    there = now.names.place(place)
    need(event.place == place, f"{name} is at {there}, and is done elsewhere")
    for robot in event.robots:
        who = f"{now.names.robot(robot)}"
        need(now.is_at(robot, place), f"{who} is not free at {there}, where {name} is")
    need(event.robots == team, f"the plan has {now.names.robots(team)} do {name}")
    for robot in team:
        due = now.next_task(robot)
        need(now.robots[robot].task == task, f"{now.names.robot(robot)} has not come for {name}")
        need(due == task, f"{now.names.robot(robot)} has something else to do first")


def lift(now: Standing, event: Event) -> None:
    """Take in that a team sets out with its load, or goes on without a robot that is lost."""
    task = event.task
    work = work_on(now, event)
    real = now.truth.tasks[task]
    need(real.to is not None, f"{now.names.task(task)} is no load")
    if work.part == SERVES:
        _end_part(now, event, SERVES)
        stub: tuple[Passed, ...] = (Passed(now.now, now.place_of(task)),)
    else:
        need(work.part == CARRIES, f"{now.names.task(task)} is not carried")
        need("robot lost" in now.news, f"{now.names.task(task)} is carried already")
        stub = turning(work.way, now.now, now.is_plane)
    need(event.robots == work.robots, f"{now.names.robots(work.robots)} carry it")
    need(event.place == stub[0].place, f"it is lifted at {now.names.place(stub[0].place)}")
    assert real.to is not None
    judge_way(now, event.robots, event, stub, real.to)
    again = replace(work, part=CARRIES, ends=event.way[-1].at, event=now.count, way=event.way)
    now.works[task] = again
    for robot in event.robots:
        now.robots[robot].way = event.way


def unload(now: Standing, event: Event) -> None:
    """Take in that a load is where it goes."""
    task, name = event.task, now.names.task(event.task)
    if work_on(now, event).part == CARRIES:
        _bring(now, event)
    work = now.works[task]
    need(work.part == QUEUES, f"unload of {name} is not what comes next")
    need(event.robots == work.robots, f"{now.names.robots(work.robots)} are at {name}")
    need(event.place == now.place_of(task), "it is unloaded elsewhere than it goes")
    need(now.may_unload(task), f"{name} is unloaded before its turn in a zone, or without room")
    ends = now.now + now.truth.tasks[task].unload
    expect(event, ends)
    now.works[task] = replace(work, part=UNLOADS, ends=ends, event=now.count)


def queue(now: Standing, event: Event) -> None:
    """Take in that a team waits for room to unload."""
    _bring(now, event)
    name, is_told = now.names.task(event.task), any(event.task in it.loads for it in now.rooms)
    need(is_told, f"{name} waits to be unloaded, and is brought to no zone")
    need(event.place == now.place_of(event.task), f"{name} waits elsewhere than it goes")


def _bring(now: Standing, event: Event) -> None:
    """Take in that a load is where it goes, and not yet unloaded."""
    task = event.task
    _end_part(now, event, CARRIES)
    to, work = now.truth.tasks[task].to, now.works[task]
    assert to is not None, "it was carried"
    now.works[task] = replace(
        work, part=QUEUES, ends=math.inf, event=now.count, way=(), came=now.now
    )
    now.lies[task] = to
    for robot in event.robots:
        now.robots[robot].way = (Passed(now.now, to),)


def done(now: Standing, event: Event) -> None:
    """Take in that a task is done."""
    task = event.task
    real = now.truth.tasks[task]
    _end_part(now, event, SERVES if real.to is None else UNLOADS)
    del now.works[task]
    place = now.place_of(task) if real.to is None else real.to
    need(event.place == place, f"{now.names.task(task)} is done at {now.names.place(place)}")
    now.over[task] = now.now
    now.done.add(task)
    _free(now, event.robots, event.place, NOBODY)


def _set_down(now: Standing, task: int, way: tuple[Passed, ...], last: Place) -> Place:
    """Return where a load lies whose team leaves it: on a map not over an obstacle, nor beyond."""
    world, origin = now.truth.world, now.place_of(task)
    if now.is_plane:
        return last
    for passed in reversed(way):
        is_past = passed.at <= now.now or is_near(passed.at, now.now)
        is_free = world.is_free(passed.place)
        if is_past and is_free and world.region(passed.place) == world.region(origin):
            return passed.place
    return origin


def broken(now: Standing, event: Event) -> None:
    """Take in that a team leaves its work."""
    task = event.task
    work = work_on(now, event)
    why = now.breaks.pop(task, None)
    need(why is not None, f"{now.names.task(task)} does not break off")
    need(event.robots == work.robots, f"{now.names.robots(work.robots)} are left of its team")
    stub = turning(work.way, now.now, now.is_plane) if work.way else ()
    if work.part == CARRIES:
        now.lies[task] = _set_down(now, task, work.way, stub[0].place)
    lies = now.place_of(task) if work.part in (CARRIES, UNLOADS, QUEUES) else None
    need(
        event.place == lies,
        f"its load lies at {'no place' if lies is None else now.names.place(lies)}",
    )
    del now.works[task]
    if work.part != FORMS:
        now.started.pop(task, None)
        now.news["service broken off"] = None
    for robot in work.robots:
        it = now.robots[robot]
        it.work, it.task = NOBODY, NOBODY
        if work.part == CARRIES:
            it.way, it.walk = stub, now.count


def _begin(now: Standing, event: Event, work: WorkNow) -> None:
    now.works[event.task] = work
    for robot in work.robots:
        now.robots[robot].work = event.task


def _end_part(now: Standing, event: Event, part: int) -> None:
    """Check that a part of work ends when, where and by whom it has to."""
    work, name = work_on(now, event), now.names.task(event.task)
    need(work.part == part, f"{event.kind} of {name} is not what comes next")
    need(is_near(work.ends, event.at),
               f"{event.kind} of {name} is due at {work.ends:.9g}")  # fmt: skip
    need(event.robots == work.robots, f"{now.names.robots(work.robots)} are at {name}")


def _free(now: Standing, robots: Sequence[int], place: Place | None, task: int) -> None:
    assert place is not None, "it has been read"
    for robot in robots:
        it = now.robots[robot]
        it.work, it.task, it.came_from = NOBODY, task, place
        it.way = (Passed(now.now, place),)
