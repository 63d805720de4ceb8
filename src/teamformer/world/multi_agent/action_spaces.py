"""The two action spaces of the paper, and the one decision that both mean: the counts wanted.

Boehme and Hollinger (ICRA 2026, sections III and IV): the original space has an action for every
combination of capabilities to add or to remove, 2^(|C|+1) in all; the scalable one spells the
wanted capabilities one by one and then ends, |C| + 1 symbols.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import numpy as np

from teamformer.base.array_types import Array
from teamformer.world.view import View

MOST_CAPABILITIES = 16
"""The original space has 131,072 actions then; beyond it cannot be listed."""


def count_actions(caps: int) -> int:
    """Return the size of the original space, 2^(|C|+1); raises ValueError if it is too large."""
    if not 1 <= caps <= MOST_CAPABILITIES:
        raise ValueError(
            f"{caps} capabilities have no list of original actions; "
            f"use 1 to {MOST_CAPABILITIES}, or spell the counts wanted"
        )
    return int(2 ** (caps + 1))


def wanted_from_action(counts: Array, action: int) -> Array:
    """Return the counts (caps,) that an original action wants.

    Bit c of the action names capability c; bit |C| says whether these are removed, once each, or
    added. No capability named is to maintain.
    """
    wanted: Array = wanted_from_actions(counts[None], np.array([action]))[0]
    return wanted


def wanted_from_actions(counts: Array, actions: Array) -> Array:
    """Return the counts (teams, caps) that original actions (teams,) want of teams with `counts`.

    Raises ValueError for a number that is no action.
    """
    changes = _changes_of_actions(counts.shape[1])
    if len(actions) and not 0 <= actions.min() <= actions.max() < len(changes):
        wrong = next(it for it in actions.tolist() if not 0 <= it < len(changes))
        raise ValueError(f"action {wrong} is not among 0 to {len(changes) - 1}")
    wanted: Array = counts + changes[actions]
    return wanted


@cache
def _changes_of_actions(caps: int) -> Array:
    """Return what each original action changes of the counts, (actions, caps)."""
    actions = np.arange(count_actions(caps))
    named = (actions[:, None] >> np.arange(caps)) & 1
    removes = (actions >> caps)[:, None] == 1
    return np.where(removes, -named, named).astype(np.int8)


def action_from_wanted(counts: Array, wanted: Array) -> int | None:
    """Return the original action that wants these counts; None if none does."""
    removal = count_actions(len(counts)) // 2
    change = np.asarray(wanted, dtype=np.int64) - counts
    removes = bool((change < 0).any())
    if (np.abs(change) > 1).any() or (removes and (change > 0).any()):
        return None
    return _bits(np.abs(change)) + (removal if removes else 0)


def _bits(is_named: Array) -> int:
    """Return the number whose bits say which capabilities (caps,) are named."""
    return int((is_named.astype(np.int64) << np.arange(len(is_named))).sum())


def wanted_from_sequence(sequence: Iterable[int], caps: int) -> Array:
    """Return the counts (caps,) that a sequence of the scalable space spells.

    The symbols are capabilities, 0 to |C| - 1, each as often as it is wanted; |C| ends it.
    """
    wanted = np.zeros(caps, dtype=np.int32)
    for symbol in sequence:
        if symbol == caps:
            return wanted
        if not 0 <= symbol < caps:
            raise ValueError(f"symbol {symbol} is not among 0 to {caps}")
        wanted[symbol] += 1
    raise ValueError(f"the sequence does not end; end it with {caps}")


def sequence_from_wanted(wanted: Array) -> list[int]:
    """Return the sequence of the scalable space that spells some counts, lowest first."""
    return [*np.repeat(np.arange(len(wanted)), wanted).tolist(), len(wanted)]


def is_legal_wanted(view: View, row: int, wanted: Array) -> bool:
    """Say whether a team may want these counts: to maintain, to split, to join a team in view.

    Teams that the view has cut off for being farther than others are not looked at.
    """
    counts = view.counts[row]
    wanted = np.asarray(wanted)
    if (wanted == counts).all():
        return True
    if view.is_serving[row]:
        return False
    if (wanted <= counts).all():
        members = slice(view.first_member[row], view.first_member[row + 1])
        return bool((view.member_counts[members] <= wanted).all(axis=1).any())
    added = wanted - counts
    return bool(((view.seen_counts[row] == added).all(axis=1) & view.can_join[row]).any())


def is_legal_action(view: View, row: int, action: int) -> bool:
    """Say whether an original action is legal for a team."""
    return is_legal_wanted(view, row, wanted_from_action(view.counts[row], action))


def legal_actions(view: View, row: int) -> Array:
    """Return which original actions are legal for a team, as (2^(|C|+1),) bool."""
    counts = view.counts[row]
    removal = count_actions(len(counts)) // 2  # the first action that removes
    is_legal = np.zeros(2 * removal, dtype=np.bool_)
    is_legal[[0, removal]] = True  # naming nothing maintains
    if view.is_serving[row]:
        return is_legal
    for added in view.seen_counts[row][view.can_join[row]]:
        if (added <= 1).all():
            is_legal[_bits(added)] = True
    named = np.arange(removal)
    for brings in view.member_counts[view.first_member[row] : view.first_member[row + 1]]:
        must_remain = _bits(brings == counts)  # removing any of these leaves no room for the member
        is_legal[removal:] |= (named & must_remain) == 0
    return is_legal
