"""Whether tasks are missed when they may be: at the end, too late, or given up."""

from __future__ import annotations

from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.names import need
from teamformer.record.event_rules.standing import Standing, is_too_late
from teamformer.world.continuous.events import WHY_MISSED, Event


def missed(now: Standing, event: Event) -> None:
    """Take in that a task is not done any more."""
    task, until = event.task, now.mission.until
    name = now.names.task(task)
    need(task not in now.over, f"{name} is over already")
    is_end = until is not None and is_near(now.now, until)
    need(is_end or _is_hopeless(now, task) or _is_given_up(now, task), f"{name} can still be done")
    need(event.why in WHY_MISSED, f"{name} is missed, and no word says why")
    now.over[task] = event.at
    now.missed.add(task)
    if task in now.works:
        now.breaks[task] = now.count


def _is_hopeless(now: Standing, task: int) -> bool:
    """Say whether the whole team of a task stands there, and it could not end in time."""
    team = now.team_of(task)
    place = now.place_of(task)
    is_there = bool(team) and all(now.is_at(robot, place) for robot in team)
    return is_there and now.brings(team, task) and is_too_late(now, task, team)


def _is_given_up(now: Standing, task: int) -> bool:
    """Say whether all that is left may be left out, and nobody does or comes to do anything."""
    left = [number for number in range(len(now.truth.tasks)) if number not in now.over]
    is_optional = all(now.truth.tasks[number].optional for number in left)
    is_known = now.appeared.issuperset(left)
    is_due = any(
        it.is_lost and now.truth.robots[number].is_due(now.now)
        for number, it in enumerate(now.robots)
    )
    return is_optional and is_known and now.is_quiet and not is_due
