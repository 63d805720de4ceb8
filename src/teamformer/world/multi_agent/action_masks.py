"""Which original actions are legal, for all teams of a view at once.

`action_spaces.legal_actions` says the same of one team in plain Python; a test compares the two.
"""

from __future__ import annotations

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.world.view import View


@entry
def legal_actions_of_rows(view: View, masks: Array) -> None:
    """Write 1 for each legal action into `masks` (teams, actions) int8, which holds zeros."""
    for row in range(masks.shape[0]):
        removal = masks.shape[1] // 2  # the first action that removes
        masks[row, 0] = masks[row, removal] = 1  # naming nothing maintains
        if not view.is_serving[row]:
            _allow_joins(view, row, masks)
            _allow_splits(view, row, masks, removal)


@kernel
def _allow_joins(view: View, row: int, masks: Array) -> None:
    """Allow to add what a team brings that may be joined, if that is at most one of each."""
    for column in range(view.can_join.shape[1]):
        action, is_spelled = 0, view.can_join[row, column]
        for cap in range(view.counts.shape[1]):
            count = view.seen_counts[row, column, cap]
            is_spelled = is_spelled and count <= 1
            action += (count > 0) << cap
        if is_spelled:
            masks[row, action] = 1


@kernel
def _allow_splits(view: View, row: int, masks: Array, removal: int) -> None:
    """Allow to remove one of some capabilities if what is left has room for a member."""
    for member in range(view.first_member[row], view.first_member[row + 1]):
        must_remain = 0  # removing one of any of these leaves no room for the member
        for cap in range(view.counts.shape[1]):
            is_all = view.member_counts[member, cap] == view.counts[row, cap]
            must_remain += is_all << cap
        for named in range(removal):
            if named & must_remain == 0:
                masks[row, removal + named] = 1
