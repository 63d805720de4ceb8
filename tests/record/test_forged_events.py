"""Every field of records in continuous time is forged, and each forgery is found."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

import teamformer as tf
from event_forgeries import findings_in, forgeries
from hand_logs import BEAM_AND_CRATE, RECORD
from teamformer.mission.model import Absence, Mission, Robot, Task
from teamformer.record.files.writing import record_to_tree
from teamformer.record.record import Record
from test_telling_events import clinic

AT_THE_END = ("walk: gone",)
"""What nobody can see where the mission ends at that moment."""


def eventful() -> Mission:
    """Beam and crate with a third robot that is lost twice, and tasks that are uncertain."""
    cat = Robot("cat", (7, 0), {"lift": 1, "weld": 1}, absences=(Absence(5, 9), Absence(23)))
    more = (
        Task("heavy", (5, 0), {"lift": 2}, duration=1, to=(1, 0), unload=0.5),
        Task("late", (4, 0), {"lift": 1}, may_need={"weld": 0.5}, appears=3),
        Task("off", (7, 0), {"lift": 1}, cancelled=6.5, duration=9),
        Task("unsure", (6, 0), {"weld": 1}, duration=5, lasts=(1, 9)),
    )
    both = replace(BEAM_AND_CRATE, robots=(*BEAM_AND_CRATE.robots, cat))
    return replace(both, tasks=(*BEAM_AND_CRATE.tasks, *more))


@cache
def records() -> list[Record]:
    played = [tf.run(mission, "plan", seed=seed).record for seed in (0, 1)
              for mission in (eventful(), clinic())]  # fmt: skip
    return [RECORD, *played]


@pytest.mark.parametrize("number", range(5))
def test_each_forgery_is_found(number: int) -> None:
    tree = record_to_tree(records()[number])
    assert findings_in(tree) == []
    found = [(name, bool(findings_in(forged))) for name, forged in forgeries(tree)]
    assert len(found) > 90
    assert {name for name, is_found in found if not is_found} <= set(AT_THE_END)


def test_the_records_have_events_of_many_kinds() -> None:
    kinds = {event.kind for record in records() for event in record.events}
    assert kinds >= {
        *("plan", "walk", "arrive", "form", "formed", "opens", "serve", "lift", "unload", "done"),
        *("lost", "back", "appear", "cancel", "know", "overdue", "over"),
    }
