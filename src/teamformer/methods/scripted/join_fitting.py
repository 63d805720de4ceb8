"""The script that the policy for any fleet begins from: joins that waste nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.methods.scripted.pairing import is_partner, keep_first_half, pair_by_slot
from teamformer.mission.model import Mission
from teamformer.world.env import Decision
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.coverage import fills_gap
from teamformer.world.view import View


class JoinFitting:
    """As join-all, but joins nobody whom no task needs.

    Nothing is wasted if the union has no more of what the other brings than some task in view
    needs, or than one: a task out of view may need it. At its own task a team joins others with
    the same assignment in any case, if they bring what is missing there: so none of them waits
    for ever. Teams in one place pair off by slot. Splits as join-all does.
    """

    needs_everything = False

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        """Nothing to prepare."""

    def decide(self, view: View) -> Decision:
        """Join whom it helps to join."""
        wanted = view.counts.copy()
        _decide(view, wanted)
        return Decision(wanted)


@entry
def _decide(view: View, wanted: Array) -> None:
    most = np.zeros(view.counts.shape[1], dtype=np.int32)
    for row in range(len(wanted)):
        if view.is_serving[row]:
            continue
        if view.has_to_part[row]:
            keep_first_half(view, row, wanted[row])
            continue
        _find_most_needed(view, row, most)
        chosen = _fitting(view, row, most)
        if chosen == NOBODY and view.is_at_task[row]:
            chosen = _missing_here(view, row)
        if chosen != NOBODY:
            for cap in range(len(most)):
                wanted[row, cap] += view.seen_counts[row, chosen, cap]


@kernel
def _find_most_needed(view: View, row: int, most: Array) -> None:
    """Write how much of each capability any one task in view needs at most; one beyond them may."""
    for cap in range(len(most)):
        most[cap] = 1
        for task in range(view.task_number.shape[1]):
            most[cap] = max(most[cap], view.task_needs[row, task, cap])


@kernel
def _fitting(view: View, row: int, most: Array) -> int:
    """Return the column of the team to pair off with, else of the first that fits, or NOBODY."""
    pair = pair_by_slot(view, row, False)
    if pair != NOBODY and _fits(view, row, pair, most) and not _part(view, row, pair):
        return pair
    for other in range(view.seen_slot.shape[1]):
        is_possible = is_partner(view, row, other, False)
        if is_possible and _fits(view, row, other, most) and not _part(view, row, other):
            return other
    return NOBODY


@kernel
def _part(view: View, row: int, other: int) -> bool:
    """Say whether two teams have different tasks and each can do its own alone."""
    mine, theirs = view.task[row], view.seen_task[row, other]
    if mine == theirs or min(mine, theirs) == NOBODY:
        return False
    for column in range(view.task_number.shape[1]):
        for cap in range(view.counts.shape[1]):
            need = view.task_needs[row, column, cap]
            if view.task_number[row, column] == mine and need > view.counts[row, cap]:
                return False
            is_theirs = view.task_number[row, column] == theirs
            if is_theirs and need > view.seen_counts[row, other, cap]:
                return False
    return True


@kernel
def _fits(view: View, row: int, other: int, most: Array) -> bool:
    """Say whether another team brings something needed, and nothing beyond that."""
    is_useful = False
    for cap in range(len(most)):
        brought = view.seen_counts[row, other, cap]
        if brought > 0:
            if view.counts[row, cap] + brought > most[cap]:
                return False
            is_useful = True
    return is_useful


@kernel
def _missing_here(view: View, row: int) -> int:
    """Return the first team with the same assignment that brings what is missing at the task."""
    for other in range(view.seen_slot.shape[1]):
        if not is_partner(view, row, other, True):
            continue
        at_hand = view.task_needs[row, 0]  # the own assignment is the first task of the view
        if fills_gap(view.counts[row], at_hand, view.seen_counts[row, other]):
            return other
    return NOBODY
