"""What must have happened at a moment before a later one comes."""

from __future__ import annotations

import math

from teamformer.record.event_rules.charging import Charges, is_charging_first, settle_charges
from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.names import BrokenRuleError, need
from teamformer.record.event_rules.standing import Standing, has_to_form, is_due, is_too_late
from teamformer.world.rules.constants import NOBODY


def settle(now: Standing, later: float) -> None:
    """Check that all has happened that had to before a later moment."""
    for task in now.breaks:
        raise BrokenRuleError(
            f"the service of {now.names.task(task)} breaks off, and nothing says so"
        )
    need(now.plans > 0 or not heard(now), _no_plan(now))
    _settle_robots(now)
    if now.charges is not None:
        settle_charges(now, later)
    _settle_tasks(now)
    _settle_works(now, later)
    _settle_end(now, later)
    _settle_borders(now, later)
    for at, kind, which in now.to_come:
        if at >= later:
            break
        if is_due(now, kind, which):
            raise BrokenRuleError(
                f"by the mission {now.names.outside((at, kind, which))} at {at:g}"
            )


def _settle_borders(now: Standing, later: float) -> None:
    """Check that shifts have begun and ended that had to before a later moment."""
    for robot, border in enumerate(now.borders):
        if border is not None and border[0] < later and not is_near(border[0], later):
            word = "begins" if border[1] else "ends"
            raise BrokenRuleError(f"a shift of {now.names.robot(robot)} {word} at {border[0]:g}")


def _no_plan(now: Standing) -> str:
    return f"there is no plan, though: {', '.join(heard(now))}"


def heard(now: Standing) -> list[str]:
    """Return the news that a plan has to be made after at this moment."""
    asks = ("start", *(word for word in now.record.heeds if word != "service overdue"))
    return [word for word in now.news if word in asks]


def _settle_robots(now: Standing) -> None:
    """Check that whoever is free is where it is to be, or on its way there."""
    if now.plan is None:
        return
    for robot, it in enumerate(now.robots):
        if it.is_lost or it.work != NOBODY or _scouts(now, robot):
            continue
        if isinstance(now.charges, Charges) and is_charging_first(now, now.charges, robot):
            continue
        task = now.next_task(robot)
        goal = now.home_of(robot) if task == NOBODY else now.place_of(task)
        if it.task != task and (task != NOBODY or it.is_walking):
            what = "go home, or stop" if task == NOBODY else f"head for {now.names.task(task)}"
            raise BrokenRuleError(f"{now.names.robot(robot)} is to {what}, and does not")
        if goal is None or it.way[-1].place == goal:
            continue
        if now.never_gets(robot, goal):
            continue
        what = "home" if task == NOBODY else f"to {now.names.task(task)}"
        raise BrokenRuleError(f"{now.names.robot(robot)} is to go {what}, and does not")


def _scouts(now: Standing, robot: int) -> bool:
    """Say whether a robot goes to look at a task that nobody has seen."""
    return now.robots[robot].task in now.unseen


def _settle_tasks(now: Standing) -> None:
    """Check that tasks have begun that could."""
    for task in now.order:
        if task in now.linked or not now.is_open(task) or task in now.works:
            continue
        team, place = now.team_of(task), now.place_of(task)
        is_there = bool(team) and all(
            now.is_at(robot, place) and now.next_task(robot) == task for robot in team
        )
        if not is_there or not now.brings(team, task) or task in now.maybe:
            continue
        if math.isinf(now.carried(task, team)):
            continue
        takes, is_late = now.believed_time(task, team), is_too_late(now, task, team)
        if has_to_form(now, team):
            if is_late or not now.fits(team, now.mission.forming):
                continue
            raise BrokenRuleError(f"the team of {now.names.task(task)} is there and does not form")
        may_begin = now.is_released(task) and now.enters(task)
        if may_begin and (is_late or now.fits(team, takes)):
            what = "cannot end in time, and is not missed"
            can = "can begin, for all are there, and does not"
            raise BrokenRuleError(f"{now.names.task(task)} {what if is_late else can}")


def _settle_end(now: Standing, later: float) -> None:
    """Check that nothing is left to do after the time at which the mission is over."""
    until = now.mission.until
    if until is None or later <= until or is_near(later, until):
        return
    for task in range(len(now.truth.tasks)):
        if task not in now.over:
            name = now.names.task(task)
            raise BrokenRuleError(f"the mission is over at {until:g}, and {name} is not")


def _settle_works(now: Standing, later: float) -> None:
    """Check that what had to end before a later moment has ended."""
    for task in now.at_work.queue:
        need(not now.may_unload(task), f"there is room to unload {now.names.task(task)}")
    for task, work in now.works.items():
        if work.ends < later and not is_near(work.ends, later):
            part = ("the forming for", "the service of", "the carrying of", "the unloading of")
            what = f"{part[work.part]} {now.names.task(task)}"
            raise BrokenRuleError(f"{what} ends at {work.ends:.9g}, and the record goes on")
    for robot, it in enumerate(now.robots):
        is_walking = it.is_walking and not it.is_lost and it.work == NOBODY
        if is_walking and it.way[-1].at < later and not is_near(it.way[-1].at, later):
            at = it.way[-1].at
            raise BrokenRuleError(f"{now.names.robot(robot)} arrives at {at:.9g}, and does not")
