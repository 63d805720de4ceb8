"""All that is told of a record."""

from __future__ import annotations

from teamformer.record.critical_path.stretches import Stretch
from teamformer.record.events.whole import tell_events
from teamformer.record.record import Record
from teamformer.record.telling.path import find_path
from teamformer.record.telling.teller import Teller
from teamformer.record.told.told_record import ToldRecord

NONSENSE = (IndexError, KeyError, ValueError)
"""What telling comes upon in steps that cannot be, which anybody may have written."""


def told_of(record: Record) -> ToldRecord:
    """Return what is told of a record: it is worked out once, when it is first asked for.

    Of a record with steps that cannot be, as much is told as can be.
    """
    if "told" not in record.memo:
        record.memo["told"] = _tell(record)
    told = record.memo["told"]
    assert isinstance(told, ToldRecord), "nobody else writes it"
    return told


def path_of_record(record: Record) -> tuple[Stretch, ...]:
    """Return the critical path of a record; see `find_path`."""
    return told_of(record).path


def _tell(record: Record) -> ToldRecord:
    if record.is_continuous:
        return tell_events(record)
    nothing = tuple(() for _ in record.mission.robots)
    try:
        teller = Teller(record)
    except NONSENSE:
        return ToldRecord(0, (), nothing, ())
    try:
        for _ in record.steps:
            teller.go_on(record)
        return teller.told(find_path(record, teller.told()))
    except NONSENSE:
        return teller.told()
