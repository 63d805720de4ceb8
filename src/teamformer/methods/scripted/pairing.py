"""Pairing off: how teams in one place become one in few steps without talking it over."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.world.view import View


@kernel
def pair_by_slot(view: View, row: int, for_same_task: bool) -> int:
    """Return the column of the team that pairs off with this one, or NOBODY.

    Teams in one place pair off in the order of their slots, first with second, third with fourth.
    Where a view is cut to the nearest slots a team in the middle takes the one after it, which
    comes to the same, since joins are made in slot order.
    """
    before = after = NOBODY  # the columns of the next lower and the next higher slot here
    lower_slots = 0
    for other in range(view.seen_slot.shape[1]):
        if not is_partner(view, row, other, for_same_task):
            continue
        slot = view.seen_slot[row, other]
        if slot < view.slot[row]:
            lower_slots += 1
            if before == NOBODY or slot > view.seen_slot[row, before]:
                before = other
        elif after == NOBODY or slot < view.seen_slot[row, after]:
            after = other
    return after if lower_slots % 2 == 0 else before


@kernel
def is_partner(view: View, row: int, other: int, for_same_task: bool) -> bool:
    """Say whether a seen team stands here and can be joined.

    With `for_same_task` it must also head for the same task.
    """
    if not (view.is_here[row, other] and view.can_join[row, other]):
        return False
    return not for_same_task or view.seen_task[row, other] == view.task[row]
