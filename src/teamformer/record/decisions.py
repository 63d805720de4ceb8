"""What teams want in each step, as a record keeps it: a row only where it is not as it was."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from teamformer.record.record import Wants

Standing = Mapping[int, Wants]
"""What teams want, by slot, that do not just stay as they are."""


def rows_of(before: Standing, now: Standing, slots: Collection[int]) -> tuple[Wants, ...]:
    """Return the rows of a step: of the teams of `slots` that want something else than before."""
    kept = before.keys() & slots
    stays = {slot: Wants(slot) for slot in kept}
    changed = (stays | dict(now)).values()
    return tuple(sorted(row for row in changed if row != before.get(row.slot, Wants(row.slot))))


def standing_after(
    before: Standing, rows: Sequence[Wants], slots: Collection[int]
) -> dict[int, Wants]:
    """Return what the teams of `slots` want in a step that has these rows."""
    kept = {slot: row for slot, row in before.items() if slot in slots}
    now = kept | {row.slot: row for row in rows}
    return {slot: row for slot, row in now.items() if row != Wants(slot)}
