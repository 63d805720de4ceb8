"""Tells of the latest step of a record that grows."""

from __future__ import annotations

from teamformer.record.record import Record
from teamformer.record.telling.teller import Teller
from teamformer.record.told.told_record import ToldOfStep


class LatestTold:
    """Tells what each step adds; `forget` what was told where the past is another one."""

    def __init__(self) -> None:
        self._teller: Teller | None = None

    def forget(self) -> None:
        """Begin anew with the next step."""
        self._teller = None

    def of(self, record: Record) -> ToldOfStep:
        """Return what the latest step adds to what is told of a record."""
        teller = self._teller
        if teller is None or teller.steps != len(record.steps) - 1:
            self._teller = teller = Teller(record)
        while teller.steps < len(record.steps) - 1:
            teller.go_on(record)
        return teller.go_on(record)
