"""Whether an event hangs on the latest of what it waited for: causes are tight."""

from __future__ import annotations

from collections.abc import Iterable

from teamformer.mission.coordination import IDLE, TAKEN_OVER
from teamformer.mission.parts.zones import lets_in
from teamformer.record.event_rules.charging import begun_by, freed
from teamformer.record.event_rules.names import need
from teamformer.record.event_rules.standing import QUEUES, Standing
from teamformer.world.continuous.events import Event
from teamformer.world.rules.constants import NOBODY

FROM_OUTSIDE = ("lost", "back", "rests", "works", "appear", "cancel", "missed", "empty")
"""Events without a cause."""

AT_ONCE = ("plan", "walk", "form", "serve", "know", "broken", "charge")
"""Events that happen as soon as what they hang on; who queues at a charger, or unloads after he has
queued, does so, too."""

PARTS = ("formed", "lift", "unload", "done", "overdue", "queue")
"""Events that hang on the part of work that was begun last; not if somebody has queued."""


def judge_cause(now: Standing, event: Event) -> None:
    """Check on what an event hangs; that of a linked start may come later."""
    if event.kind == "opens":
        need(event.cause == NOBODY or event.task in now.linked, "opens has a cause without a link")
        return
    due = _cause_of(now, event)
    if due != event.cause:
        by_rules, said = (_named(now, number) for number in (due, event.cause))
        need(False, f"{event.kind} hangs on {by_rules} by the rules and on {said} in the record")
    is_queue = event.kind == "queue" and event.task == NOBODY
    is_at_once = event.kind in AT_ONCE or is_queue or _has_queued(now, event)
    if is_at_once and not _comes_by_itself(now, event):
        begun = 0.0 if due == NOBODY else now.events[due].at
        need(begun == event.at, f"{event.kind} is due at {begun:.9g}")


def _comes_by_itself(now: Standing, event: Event) -> bool:
    """Say whether an event is a plan that is made though nothing has happened at its moment.

    An operator takes it over, or nobody has anything to do but a team held by a link: it stands at
    its task, and the moment from which it was to begin has come.
    """
    if event.plan is None or IDLE not in event.plan.reasons:
        return event.plan is not None and TAKEN_OVER in event.plan.reasons
    return any(
        now.is_open(task) and all(now.is_at(robot, now.place_of(task)) for robot in team)
        for task in now.linked
        if (team := now.team_of(task))
    )


def _cause_of(now: Standing, event: Event) -> int:
    """Return the number of the event on which one hangs by the rules."""
    if event.kind in FROM_OUTSIDE:
        return NOBODY
    if _has_queued(now, event):
        let_in = lets_in(now.rooms, _moment(now), now.at_work, event.task, is_load=True)
        return _latest(now, let_in, event)
    if event.kind in PARTS and event.task != NOBODY:
        work = now.works.get(event.task)
        need(work is not None, f"nobody is at work on {now.names.task(event.task)}")
        assert work is not None
        return work.event
    if event.kind == "broken":
        need(event.task in now.breaks, f"{now.names.task(event.task)} does not break off")
        return now.breaks[event.task]
    if event.kind == "plan":
        return now.count - 1
    since = [now.robots[robot].since for robot in event.robots]
    if event.kind == "charged":
        return begun_by(now, event)
    if event.kind == "charge":
        since += freed(now, event)
    if event.kind == "found":
        return since[0]
    if event.kind == "moved":
        looked = event.cause in [robot.since for robot in now.robots]
        return event.cause if looked else NOBODY
    if event.kind == "arrive" and _ends_walk(now, event):
        return now.robots[event.robots[0]].walk
    if event.kind == "over":
        since = [robot.since for robot in now.robots]
    elif event.kind == "serve":
        since += [now.over_by[other] for other in now.before.get(event.task, ())
                  if other in now.over_by]  # fmt: skip
        since += now.opened.get(event.task, ())
        since += lets_in(now.rooms, _moment(now), now.at_work, event.task)
    if event.kind in ("walk", "arrive", "form", "serve"):
        since.append(now.planned)
    return _latest(now, since, event)


def _has_queued(now: Standing, event: Event) -> bool:
    """Say whether an event begins the unloading of a load that had to wait for room."""
    work = now.works.get(event.task)
    return event.kind == "unload" and work is not None and work.part == QUEUES


def _moment(now: Standing) -> list[tuple[int, str, int]]:
    """Return the events of this moment: the number, the kind and the task of each."""
    first = now.count
    while first > 0 and now.events[first - 1].at == now.now:
        first -= 1
    return [(n, now.events[n].kind, now.events[n].task) for n in range(first, now.count)]


def _ends_walk(now: Standing, event: Event) -> bool:
    robot = now.robots[event.robots[0]]
    return robot.is_walking and event.cause == robot.walk


def _latest(now: Standing, candidates: Iterable[int], event: Event) -> int:
    """Return the latest of some events if it is of this moment, else what has happened last."""
    latest = max(candidates, default=NOBODY)
    is_now = latest != NOBODY and now.events[latest].at == event.at
    return latest if is_now or now.count == 0 else now.count - 1


def _named(now: Standing, number: int) -> str:
    if number == NOBODY:
        return "nothing"
    return f"event {number} ({now.events[number].kind})"
