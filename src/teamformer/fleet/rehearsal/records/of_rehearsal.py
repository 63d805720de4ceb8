"""The record of a rehearsal, that `view` shows and `check` judges."""

from __future__ import annotations

from collections.abc import Sequence

from teamformer.fleet.rehearsal.checking.trace import Event
from teamformer.fleet.rehearsal.outcome import Outcome
from teamformer.fleet.rehearsal.play import Rehearsal
from teamformer.fleet.rehearsal.records.in_steps import record_in_steps
from teamformer.fleet.rehearsal.records.in_time import record_in_time
from teamformer.record.record import Record


def record_of(rehearsal: Rehearsal, outcome: Outcome, events: Sequence[Event], seed: int) -> Record:
    """Return the record of a rehearsal that has been played, from its trace."""
    is_in_steps = rehearsal.mission.source.time == "steps"
    make = record_in_steps if is_in_steps else record_in_time
    return make(rehearsal, outcome, sorted(events, key=lambda event: event.at), seed)
