"""Whole choices: what a team may want, few enough to be scored one by one.

To maintain; to halve, keeping half of each capability; to shed, keeping what any one task in view
needs at most; to join one of the nearest teams; to split so that only what one of the next tasks
needs is kept. The counts wanted are built from the choice.
"""

from __future__ import annotations

import numpy as np

from teamformer.jit import entry, kernel
from teamformer.sim.arrays import NOBODY, Array
from teamformer.sim.view import View

TEAMS, TASKS = 9, 4
"""How many teams can be joined and how many tasks split for: the first ones of the view."""

MAINTAIN, HALVE, SHED, JOIN = 0, 1, 2, 3
SPLIT = JOIN + TEAMS
CHOICES = SPLIT + TASKS
"""Where each kind of choice begins, and how many choices there are."""


def legal_choices(view: View) -> Array:
    """Return which choices the environment would carry out, as (teams, CHOICES)."""
    is_legal = np.zeros((len(view.slot), CHOICES), dtype=np.bool_)
    _mark_legal(view, is_legal)
    return is_legal


def wanted_counts(view: View, choice: Array) -> Array:
    """Return the counts that choices (teams,) stand for, as (teams, caps)."""
    wanted = view.counts.copy()
    _write_wanted(view, np.asarray(choice, dtype=np.int64), wanted)
    return wanted


def choices_for(view: View, wanted: Array) -> Array:
    """Return the first choice that stands for each row of counts, MAINTAIN if none does."""
    choice = np.zeros(len(wanted), dtype=np.int64)
    _find_choices(view, legal_choices(view), wanted, choice)
    return choice


def sees_doubles(view: View) -> Array:
    """Return which teams and those that they see have some capability twice, as (teams,)."""
    is_doubled = np.zeros(len(view.slot), dtype=np.bool_)
    _find_doubles(view, is_doubled)
    return is_doubled


@entry
def _find_doubles(view, is_doubled):  # type: ignore[no-untyped-def]
    for row in range(len(is_doubled)):
        for cap in range(view.counts.shape[1]):
            together = view.counts[row, cap]
            for other in range(view.seen_slot.shape[1]):
                together += view.seen_counts[row, other, cap]
            is_doubled[row] |= together > 1


@entry
def _mark_legal(view, is_legal):  # type: ignore[no-untyped-def]
    kept = np.zeros(view.counts.shape[1], dtype=np.int32)
    for row in range(len(is_legal)):
        is_legal[row, MAINTAIN] = True
        if view.is_serving[row]:
            continue
        for choice in range(1, CHOICES):
            if JOIN <= choice < SPLIT:
                other = choice - JOIN
                is_legal[row, choice] = other < view.can_join.shape[1] and view.can_join[row, other]
            elif view.size[row] > 1 and keep_for(view, row, choice, kept):
                is_legal[row, choice] = _parts(view, row, kept)


@entry
def _write_wanted(view, choices, wanted):  # type: ignore[no-untyped-def]
    kept = np.zeros(view.counts.shape[1], dtype=np.int32)
    for row in range(len(wanted)):
        _write_row(view, row, choices[row], kept, wanted[row])


@kernel
def _write_row(view, row, choice, kept, wanted):  # type: ignore[no-untyped-def]
    if JOIN <= choice < SPLIT:
        for cap in range(len(wanted)):
            wanted[cap] = view.counts[row, cap] + view.seen_counts[row, choice - JOIN, cap]
    else:
        keep_for(view, row, choice, kept)
        for cap in range(len(wanted)):
            wanted[cap] = kept[cap]


@entry
def _find_choices(view, is_legal, wanted, choices):  # type: ignore[no-untyped-def]
    caps = view.counts.shape[1]
    kept = np.zeros(caps, dtype=np.int32)
    meant = np.zeros(caps, dtype=np.int32)
    for row in range(len(wanted)):
        for choice in range(CHOICES - 1, -1, -1):
            if is_legal[row, choice]:
                _write_row(view, row, choice, kept, meant)
                is_same = True
                for cap in range(caps):
                    is_same &= meant[cap] == wanted[row, cap]
                if is_same:
                    choices[row] = choice


@kernel
def keep_for(view, row, choice, kept):  # type: ignore[no-untyped-def]
    """Write what a team keeps by a choice that joins nobody; say whether there is such a choice."""
    column = choice - SPLIT
    columns = view.task_number.shape[1]
    is_there = choice < SPLIT or (column < columns and view.task_number[row, column] != NOBODY)
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
def _parts(view, row, kept):  # type: ignore[no-untyped-def]
    """Say whether somebody goes and some member fits into what is kept, as a split has to."""
    anybody_goes = False
    for cap in range(len(kept)):
        anybody_goes |= kept[cap] < view.counts[row, cap]
    if not anybody_goes:
        return False
    for member in range(view.first_member[row], view.first_member[row + 1]):
        fits = True
        for cap in range(len(kept)):
            fits &= view.member_counts[member, cap] <= kept[cap]
        if fits:
            return True
    return False
