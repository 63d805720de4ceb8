"""What teams observe of a view, as the arrays of a learner: single floats, flags as numbers.

All that a team observes lies in one row of a table that is made once. So the table is filled array
by array, and a row is copied, or handed out as arrays, in one go.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry
from teamformer.world.multi_agent.action_masks import legal_actions_of_rows
from teamformer.world.multi_agent.action_spaces import count_actions
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View

OF_TEAM = tuple(name for name in View._fields if name not in ("world", "first_member"))
"""The arrays of a view that are observed: what places a row in the batch is not."""

OF_MEMBERS = ("member", "member_counts")
"""Those of them with a row for each robot of a team; they are padded to all robots."""

MAY_BE_EMPTY = ("task_may_need", "task_within", "task_to_place")
"""Arrays without columns where no mission needs them; these are not observed then."""

Observation = dict[str, Array]
"""Arrays by name, of one team or with a row for each."""


class Observer:
    """Turns views of environments of the same sizes into observations.

    `robots` is how many a world has at most: `member` (robots,) and `member_counts` (robots, caps)
    of a team are padded to these. With original actions `action_mask` (actions,) says which of them
    are legal. `rows` has a record for each team that there may be.
    """

    def __init__(self, view: View, teams: int, robots: int, has_original_actions: bool) -> None:
        caps = view.counts.shape[1]
        actions = count_actions(caps) if has_original_actions else 0
        self.rows = np.zeros(teams, _record_of(view, robots, actions))
        self.bytes = as_bytes(self.rows)
        self.names = self.rows.dtype.names or ()
        self._masks = np.zeros((teams, actions), np.int8)
        self._view: View | None = None
        self._copies: list[tuple[Array, Array]] = []

    def look(self, view: View) -> None:
        """Write what each team of a view observes into the first rows."""
        teams = len(view.slot)
        if view is not self._view:  # another environment, or other teams
            self._view, self._copies = view, self._copies_of(view)
        if self._masks.shape[1]:
            self._masks[:teams] = 0
            legal_actions_of_rows(view, self._masks[:teams])
        for into, array in self._copies:
            np.copyto(into, array, casting="same_kind")
        pad_members(
            view.first_member,
            view.member,
            view.member_counts,
            self.rows["member"],
            self.rows["member_counts"],
        )

    def observations(self, teams: int) -> list[Observation]:
        """Return what each of the first teams observes, in arrays of their own."""
        rows = self.bytes[:teams].copy().reshape(-1).view(self.rows.dtype)
        parts: Any = rows.tolist()  # tuples of arrays, which share the memory of `rows`
        return [dict(zip(self.names, row, strict=True)) for row in parts]

    def _copies_of(self, view: View) -> list[tuple[Array, Array]]:
        """Return which array of a view is copied into which part of the table."""
        teams, copies = len(view.slot), []
        for name in self.names:
            into = self.rows[name][:teams]
            if name == "action_mask":
                copies.append((into, self._masks[:teams]))
            elif name not in OF_MEMBERS:
                array = getattr(view, name)
                is_flag = array.dtype == np.bool_
                is_flat = array.ndim == 1
                array = array.view(np.int8) if is_flag else array
                copies.append((into, array[:, None] if is_flat else array))
        return copies


def as_bytes(records: Array) -> Array:
    """Return the same records (rows,) as bytes (rows, bytes), which are faster to copy."""
    return records.view(np.uint8).reshape(len(records), -1)


def arrays_of(records: Array) -> Observation:
    """Return the parts of some records by name, each with a row for each record."""
    return {name: records[name] for name in records.dtype.names or ()}


def _record_of(view: View, robots: int, actions: int) -> np.dtype[np.void]:
    """Return what a team observes of views like this one, one number at least of each thing."""
    fields = []
    for name in OF_TEAM:
        array = getattr(view, name)
        if name in MAY_BE_EMPTY and array.shape[1] == 0:
            continue
        kinds = {np.dtype(np.float64): np.float32, np.dtype(np.bool_): np.int8}
        shape = (robots, *array.shape[1:]) if name in OF_MEMBERS else array.shape[1:] or (1,)
        fields.append((name, kinds.get(array.dtype, array.dtype), shape))
    if actions:
        fields.append(("action_mask", np.int8, (actions,)))
    return np.dtype(fields, align=True)


@entry
def pad_members(
    first_member: Array, member: Array, member_counts: Array, padded: Array, counts: Array
) -> None:
    """Write each team's robots and what they bring, padded to all robots, (teams, robots, ...)."""
    for row in range(len(first_member) - 1):
        begin, size = first_member[row], first_member[row + 1] - first_member[row]
        for seat in range(padded.shape[1]):
            padded[row, seat] = member[begin + seat] if seat < size else NOBODY
            for cap in range(counts.shape[2]):
                counts[row, seat, cap] = member_counts[begin + seat, cap] if seat < size else 0
