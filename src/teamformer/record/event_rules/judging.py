"""Judging the events of a record: they are followed by the rules up to the first difference."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from teamformer.mission.coordination import NEWS
from teamformer.mission.parts.charging import has_batteries
from teamformer.record.event_rules import charging, from_outside, missing, ways, work
from teamformer.record.event_rules.causes import judge_cause
from teamformer.record.event_rules.ending import wrong_endings
from teamformer.record.event_rules.names import BrokenRuleError
from teamformer.record.event_rules.plans import take_plan
from teamformer.record.event_rules.settling import settle
from teamformer.record.event_rules.standing import Standing
from teamformer.record.record import Record
from teamformer.world.continuous.events import Event
from teamformer.world.rules.constants import NOBODY


def _queue(now: Standing, event: Event) -> None:
    """Take in that somebody waits for room: at a charger, or to unload."""
    (charging.queue if event.task == NOBODY else work.queue)(now, event)


TAKE: Mapping[str, Callable[[Standing, Event], None]] = {
    "plan": take_plan,
    "walk": ways.walk,
    "arrive": ways.arrive,
    "form": work.form,
    "formed": work.formed,
    "serve": work.serve,
    "lift": work.lift,
    "unload": work.unload,
    "done": work.done,
    "broken": work.broken,
    "opens": from_outside.opens,
    "lost": from_outside.lost,
    "back": from_outside.back,
    "rests": from_outside.rests,
    "works": from_outside.works,
    "appear": from_outside.appear,
    "cancel": from_outside.cancel,
    "missed": missing.missed,
    "know": from_outside.know,
    "found": from_outside.found,
    "moved": from_outside.moved,
    "overdue": from_outside.overdue,
    "queue": _queue,
    "charge": charging.charge,
    "charged": charging.charged,
    "empty": charging.empty,
}
"""What is checked of an event of each kind, and what it changes."""

IN_THE_NEWS = {
    "appear": "task appeared",
    "lost": "robot lost",
    "empty": "robot lost",
    "back": "robot back",
    "know": "needs known",
    "overdue": "service overdue",
    "cancel": "task cancelled",
    "done": "task done",
}
"""What is news after an event of a kind; of what is known as the mission starts nothing is."""


def take(now: Standing, event: Event) -> None:
    """Take in the next event; raises `BrokenRuleError` for one that the rules do not allow."""
    if event.at > now.now:
        settle(now, event.at)
        if isinstance(now.charges, charging.Charges):
            charging.pass_time(now, now.charges, event.at)
        now.now, now.news, now.plans, now.opened = event.at, {}, 0, {}
    judge_cause(now, event)
    if event.kind != "over":
        if event.kind not in TAKE:
            raise BrokenRuleError(f"nothing like '{event.kind}' happens in continuous time")
        if isinstance(now.charges, charging.Charges):
            charging.notice(now, now.charges, event)
        TAKE[event.kind](now, event)
    _note(now, event)
    if event.kind in IN_THE_NEWS and not (event.kind == "know" and "start" in now.news):
        now.news[IN_THE_NEWS[event.kind]] = None
    now.count += 1


def _note(now: Standing, event: Event) -> None:
    """Note on what later events may hang."""
    if event.kind in ("done", "cancel", "missed"):
        now.over_by[event.task] = now.count
    if event.kind in ("opens", "appear"):
        now.opened.setdefault(event.task, []).append(now.count)
    if event.kind == "plan":
        now.planned = now.count
    if event.kind not in ("know", "found"):
        for robot in event.robots:
            now.robots[robot].since = now.count


def judge_events(record: Record) -> Iterator[tuple[float, str]]:
    """Yield the moment at which record and rules part, if they do, and what is wrong there.

    A moment of -1 means the record as a whole.
    """
    if record.heeds != tuple(word for word in NEWS if word in record.heeds):
        yield -1, "heeds has news twice or not in order"
    now = Standing(record)
    if has_batteries(record.mission.robots):
        now.charges = charging.Charges(now)
    for number, event in enumerate(record.events):
        try:
            take(now, event)
        except BrokenRuleError as broken:
            yield event.at, f"event {number}, at {event.at:g}: {broken}"
            return
    if not record.events or record.events[-1].kind != "over":
        yield -1, "the last event does not say that the mission is over"
        return
    for message in wrong_endings(now, record.events[-1].status):
        yield -1, message
