"""Whether an event hangs on one that can have led to it."""

from __future__ import annotations

from teamformer.record.event_rules.lengths import is_near
from teamformer.record.event_rules.names import need
from teamformer.record.event_rules.standing import Standing
from teamformer.world.continuous.events import Event
from teamformer.world.rules.constants import NOBODY

FROM_OUTSIDE = ("lost", "back", "appear", "cancel")
SAME_MOMENT = ("walk", "form", "serve", "know", "broken", "plan")
"""Events without a cause, and those whose cause happens at the same moment."""

BEGUN_BY = {
    "formed": ("form",),
    "lift": ("serve", "lift"),
    "unload": ("lift",),
    "done": ("serve", "unload"),
    "overdue": ("serve",),
}
"""Events that hang on what has begun before, for the same task."""


def judge_cause(now: Standing, event: Event) -> None:
    """Check that an event hangs on one that can have led to it, and on nothing later."""
    cause = None if event.cause == NOBODY else now.events[event.cause]
    number = now.count
    if event.kind in FROM_OUTSIDE:
        need(cause is None, f"{event.kind} comes from outside, and has a cause")
        return
    if event.kind == "opens":
        return
    if cause is None:
        need(number == 0 and event.kind in ("plan", "know"), f"{event.kind} has no cause")
        return
    need(event.cause < number, f"{event.kind} has a cause that comes later")
    if event.kind == "arrive":
        is_walk = cause.kind == "walk" and cause.robots == event.robots
        is_there = is_near(cause.at, event.at)
        need(is_walk or is_there, "arrive has a cause that is not its robot's way")
    elif event.kind in BEGUN_BY:
        is_so = cause.kind in BEGUN_BY[event.kind] and cause.task == event.task
        need(is_so, f"{event.kind} has {cause.kind} as its cause")
        work = now.works.get(event.task)
        is_part = work is not None and work.event == event.cause
        need(is_part, f"{event.kind} has an earlier cause than its latest part")
    elif event.kind in SAME_MOMENT:
        what = f"{event.kind} hangs on what happened at {cause.at:.9g}"
        need(cause.at == event.at or event.kind == "over", what)
