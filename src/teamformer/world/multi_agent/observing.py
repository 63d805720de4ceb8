"""What teams observe of a view, as the arrays of a learner: single floats, flags as numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.world.multi_agent.action_masks import legal_actions_of_rows
from teamformer.world.multi_agent.action_spaces import count_actions
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View

OF_TEAM = tuple(name for name in View._fields if name not in ("world", "first_member"))
"""The arrays of a view that are observed: what places a row in the batch is not."""

MAY_BE_EMPTY = ("task_may_need", "task_within", "task_to_place")
"""Arrays without columns where no mission needs them; these are not observed then."""

Observations = dict[str, Array]
"""Arrays by name, each with a row for each team."""


class Column(NamedTuple):
    """An array of a view that is observed, and how a learner gets it."""

    name: str
    dtype: type[np.generic] | None  # what it is turned into; None: it is copied
    is_flag: bool
    is_flat: bool  # one number for each team, which becomes a row of one


def observed(view: View) -> tuple[Column, ...]:
    """Return the arrays that are observed of views like this one."""
    names = (n for n in OF_TEAM if n not in MAY_BE_EMPTY or getattr(view, n).shape[1] > 0)
    return tuple(_column(name, getattr(view, name)) for name in names)


def _column(name: str, array: Array) -> Column:
    dtype = np.float32 if array.dtype == np.float64 else None
    return Column(name, dtype, array.dtype == np.bool_, array.ndim == 1)


def observe_rows(
    view: View, columns: Sequence[Column], robots: int, has_original_actions: bool
) -> Observations:
    """Return new arrays of what each team observes; their first axis is that of the view's rows.

    `columns` are those that `observed` returns; `robots` is how many a world has at most. `member`
    (teams, robots) and `member_counts` (teams, robots, caps) are padded to these. With original
    actions `action_mask` (teams, actions) says which of them are legal.
    """
    seen = {column.name: _for_learners(getattr(view, column.name), column) for column in columns}
    teams, caps = view.counts.shape
    places = _STEPS[:robots] if robots <= len(_STEPS) else np.arange(robots)
    is_member = places < view.size[:, None]  # (teams, robots)
    member = np.empty((teams, robots), dtype=np.int32)
    member.fill(NOBODY)
    member[is_member] = view.member
    seen["member"] = member
    seen["member_counts"] = np.zeros((teams, robots, caps), dtype=np.int32)
    seen["member_counts"][is_member] = view.member_counts
    if has_original_actions:
        masks = np.zeros((teams, count_actions(caps)), dtype=np.int8)
        legal_actions_of_rows(view, masks)
        seen["action_mask"] = masks
    return seen


_STEPS = np.arange(256)


def _for_learners(array: Array, column: Column) -> Array:
    """Return a copy: (teams, ...), at least one number for each team."""
    if column.dtype is not None:
        array = array.astype(column.dtype)
    elif column.is_flag:
        array = array.view(np.int8).copy()
    else:
        array = array.copy()
    return array[:, None] if column.is_flat else array
