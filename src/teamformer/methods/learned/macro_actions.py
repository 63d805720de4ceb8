"""Whole choices: what a team may want, few enough to be scored one by one.

To follow the script (`policies.scripted.join_fitting`), which joins whom it is useful to join; or
else to maintain; to halve, keeping half of each capability; to shed, keeping what any one task in
view needs at most; to join one of the nearest teams; to split so that only what one of the next
tasks needs is kept. The counts wanted are built from the choice.
"""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.methods.scripted.join_fitting import JoinFitting
from teamformer.world.rules.constants import NOBODY
from teamformer.world.rules.coverage import are_equal
from teamformer.world.rules.splitting import anybody_fits
from teamformer.world.view import View

TEAMS, TASKS = 9, 4
"""How many teams can be joined and how many tasks split for: the first ones of the view."""

FOLLOW, MAINTAIN, HALVE, SHED, JOIN = 0, 1, 2, 3, 4
SPLIT = JOIN + TEAMS
CHOICES = SPLIT + TASKS
"""Where each kind of choice begins, and how many choices there are."""


def scripted_counts(view: View) -> Array:
    """Return the counts that the script wants, as (teams, caps)."""
    return JoinFitting().decide(view).wanted


def legal_choices(view: View, scripted: Array) -> Array:
    """Return which choices the environment would carry out, as (teams, CHOICES).

    One that wants what the script wants is left out: to follow it says the same.
    """
    is_legal = np.zeros((len(view.slot), CHOICES), dtype=np.bool_)
    _mark_legal(view, scripted, is_legal)
    return is_legal


def wanted_counts(view: View, choice: Array) -> Array:
    """Return the counts that choices (teams,) stand for, as (teams, caps)."""
    wanted = scripted_counts(view)
    _write_wanted(view, np.asarray(choice, dtype=np.int64), wanted)
    return wanted


@entry
def _mark_legal(view: View, scripted: Array, is_legal: Array) -> None:
    kept = np.zeros(view.counts.shape[1], dtype=np.int32)
    for row in range(len(is_legal)):
        is_legal[row, FOLLOW] = True
        if view.is_serving[row]:
            continue
        for choice in range(MAINTAIN, CHOICES):
            if _can_choose(view, row, choice, kept):
                _write_row(view, row, choice, kept, kept)
                is_legal[row, choice] = not are_equal(kept, scripted[row])


@kernel
def _can_choose(view: View, row: int, choice: int, kept: Array) -> bool:
    if choice == MAINTAIN:
        return True
    if JOIN <= choice < SPLIT:
        other = choice - JOIN
        return other < view.can_join.shape[1] and view.can_join[row, other]
    is_there = view.size[row] > 1 and keep_for(view, row, choice, kept)
    return is_there and _parts(view, row, kept)


@entry
def _write_wanted(view: View, choices: Array, wanted: Array) -> None:
    kept = np.zeros(view.counts.shape[1], dtype=np.int32)
    for row in range(len(wanted)):
        if choices[row] != FOLLOW:
            _write_row(view, row, choices[row], kept, wanted[row])


@kernel
def _write_row(view: View, row: int, choice: int, kept: Array, wanted: Array) -> None:
    if JOIN <= choice < SPLIT:
        for cap in range(len(wanted)):
            wanted[cap] = view.counts[row, cap] + view.seen_counts[row, choice - JOIN, cap]
    else:
        keep_for(view, row, choice, kept)
        for cap in range(len(wanted)):
            wanted[cap] = kept[cap]


@kernel
def keep_for(view: View, row: int, choice: int, kept: Array) -> bool:
    """Write what a team keeps by a choice that joins nobody; say whether there is such a choice."""
    column = choice - SPLIT
    columns = view.task_number.shape[1]
    is_there = choice < JOIN or (column < columns and view.task_number[row, column] != NOBODY)
    for cap in range(len(kept)):
        have = view.counts[row, cap]
        kept[cap] = have
        if choice == HALVE:
            kept[cap] = (have + 1) // 2
        elif choice == SHED:
            most = 0
            for task in range(columns):
                most = max(most, view.task_needs[row, task, cap])
            kept[cap] = min(have, most)
        elif choice >= SPLIT and is_there:
            kept[cap] = min(have, view.task_needs[row, column, cap])
    return is_there


@kernel
def _parts(view: View, row: int, kept: Array) -> bool:
    """Say whether somebody goes and some member fits into what is kept, as a split has to."""
    anybody_goes = False
    for cap in range(len(kept)):
        anybody_goes |= kept[cap] < view.counts[row, cap]
    if not anybody_goes:
        return False
    members = view.first_member[row], view.first_member[row + 1]
    return anybody_fits(view.member_counts, members[0], members[1], kept)
