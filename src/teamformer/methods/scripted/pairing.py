"""Pairing off: how teams in one place become one in few steps without talking it over."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
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

    With `for_same_task` it must also head for the same task. Nobody is a partner whom a union would
    have to part from again, or with whom such a one may be mistaken, as it brings the same.
    """
    if not (view.is_here[row, other] and view.can_join[row, other]):
        return False
    for twin in range(view.seen_slot.shape[1]):
        if not view.can_join[row, twin] or view.can_go_with[row, twin]:
            continue
        if twin == other or _comes_before(view, row, twin, other):
            return False
    return not for_same_task or view.seen_task[row, other] == view.task[row]


@kernel
def _comes_before(view: View, row: int, twin: int, other: int) -> bool:
    """Say whether a join meant for one team may be made with another that brings the same."""
    for cap in range(view.counts.shape[1]):
        if view.seen_counts[row, twin, cap] != view.seen_counts[row, other, cap]:
            return False
    task = view.task[row]
    is_meant = task != NOBODY and view.seen_task[row, other] == task != view.seen_task[row, twin]
    return not is_meant or _away(view, row, twin) < _away(view, row, other)


@kernel
def _away(view: View, row: int, other: int) -> float:
    """Return the squared distance to another team."""
    along = view.seen_place[row, other, 0] - view.place[row, 0]
    up = view.seen_place[row, other, 1] - view.place[row, 1]
    return float(along * along + up * up)


@kernel
def keep_first_half(view: View, row: int, wanted: Array) -> None:
    """Want to keep the first half of a team, rounded down; nothing is wanted of a single robot."""
    first = view.first_member[row]
    for cap in range(len(wanted)):
        wanted[cap] = 0
        for member in range(first, first + view.size[row] // 2):
            wanted[cap] += view.member_counts[member, cap]
