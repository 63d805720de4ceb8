"""Judging the events of a record: they are followed by the rules up to the first difference."""

from __future__ import annotations

from collections.abc import Iterator

from teamformer.mission.coordination import NEWS
from teamformer.record.event_rules.ending import wrong_endings
from teamformer.record.event_rules.following import BrokenRuleError, Following
from teamformer.record.record import Record


def judge_events(record: Record) -> Iterator[tuple[float, str]]:
    """Yield the moment at which record and rules part, if they do, and what is wrong there.

    A moment of -1 means the record as a whole.
    """
    if record.heeds != tuple(word for word in NEWS if word in record.heeds):
        yield -1, "heeds has news twice or not in order"
    following = Following(record)
    for number, event in enumerate(record.events):
        try:
            following.take(event)
        except BrokenRuleError as broken:
            yield event.at, f"event {number}, at {event.at:g}: {broken}"
            return
    if not record.events or record.events[-1].kind != "over":
        yield -1, "the last event does not say that the mission is over"
        return
    for message in wrong_endings(following.now, record.events[-1].status):
        yield -1, message
