"""What teams observe of a view, as the arrays of a learner: single floats, flags as numbers."""

from __future__ import annotations

from collections.abc import Sequence

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


def observed(view: View) -> tuple[str, ...]:
    """Return the names of the arrays that are observed of views like this one."""
    return tuple(n for n in OF_TEAM if n not in MAY_BE_EMPTY or getattr(view, n).shape[1] > 0)


def observe_rows(
    view: View, names: Sequence[str], robots: int, has_original_actions: bool
) -> Observations:
    """Return new arrays of what each team observes; their first axis is that of the view's rows.

    `names` are those that `observed` returns; `robots` is how many a world has at most. `member`
    (teams, robots) and `member_counts` (teams, robots, caps) are padded to these. With original
    actions `action_mask` (teams, actions) says which of them are legal.
    """
    seen = {name: _for_learners(getattr(view, name)) for name in names}
    is_member = np.arange(robots) < view.size[:, None]  # (teams, robots)
    seen["member"] = np.full(is_member.shape, NOBODY, dtype=np.int32)
    seen["member"][is_member] = view.member
    seen["member_counts"] = np.zeros((*is_member.shape, view.counts.shape[1]), dtype=np.int32)
    seen["member_counts"][is_member] = view.member_counts
    if has_original_actions:
        masks = np.zeros((len(view.slot), count_actions(view.counts.shape[1])), dtype=np.int8)
        legal_actions_of_rows(view, masks)
        seen["action_mask"] = masks
    return seen


def _for_learners(array: Array) -> Array:
    """Return a copy: (teams, ...), at least one number for each team."""
    if array.dtype == np.float64:
        array = array.astype(np.float32)
    elif array.dtype == np.bool_:
        array = array.astype(np.int8)
    else:
        array = array.copy()
    return array[:, None] if array.ndim == 1 else array
