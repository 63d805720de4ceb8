"""Which symbols may come next in a spelling, without torch: the twin of `nets.action_mask`."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.methods.learned.token_features import NEVER_FITS, Spelled
from teamformer.world.rules.coverage import are_equal

EDIT, FULL = "edit", "full"


class Next(NamedTuple):
    """What may come next, as (teams, symbols); the last symbol is the end."""

    is_legal: Array
    is_maintain: Array  # the one that goes on to maintain, if there still is


def next_symbols(spelling: str, tokens: Spelled, spelled: Array) -> Next:
    """Return what may follow the counts `spelled` so far (teams, caps).

    In `edit` spelling what is dropped counts negative.
    """
    teams, caps = spelled.shape
    symbols = caps + 1 if spelling == FULL else 2 * caps + 1
    found = Next(
        np.zeros((teams, symbols), dtype=np.bool_), np.zeros((teams, symbols), dtype=np.bool_)
    )
    _mark(spelling == FULL, tokens, spelled, found)
    return found


def complete(spelling: str, tokens: Spelled, spelled: Array) -> Array:
    """Complete, in place, what can only be spelled in one way; return which teams' it was.

    In `edit` spelling what adds can only reach teams in view; one that differs from all others is
    certain before its end. `spelled` is (teams, caps), the result (teams,) bool.
    """
    is_complete = np.zeros(len(spelled), dtype=np.bool_)
    if spelling == EDIT:
        _complete(tokens, spelled, is_complete)
    return is_complete


@entry
def _complete(tokens: Spelled, spelled: Array, is_complete: Array) -> None:
    for row in range(len(spelled)):
        last, only = _last(spelled[row], 1), 0
        for target in range(1, tokens.can_join.shape[1] if last >= 0 else 0):
            brings = tokens.team_counts[row, target]
            if not tokens.can_join[row, target] or not _goes_on_to(brings, spelled[row], last):
                continue
            if only > 0 and not are_equal(brings, tokens.team_counts[row, only]):
                only = 0
                break
            only = target
        if only > 0:
            spelled[row] = tokens.team_counts[row, only]
            is_complete[row] = True


@kernel
def _goes_on_to(brings: Array, spelled: Array, last: int) -> bool:
    """Say whether counts are spelled alike up to the last symbol."""
    for cap in range(len(spelled)):
        lacks = brings[cap] - spelled[cap]
        if lacks < 0.0 or (cap < last and lacks > 0.0):
            return False
    return True


@entry
def _mark(is_full: bool, tokens: Spelled, spelled: Array, found: Any) -> None:
    for row in range(len(spelled)):
        if is_full:
            last = _last(spelled[row], 1)
            _mark_targets(is_full, tokens, row, spelled[row], last, found)
            _mark_splits(tokens, row, spelled[row], last, found.is_legal[row])
        else:
            added, dropped = _last(spelled[row], 1), _last(spelled[row], -1)
            if dropped < 0:
                _mark_targets(is_full, tokens, row, spelled[row], added, found)
            else:
                found.is_legal[row, 2 * len(spelled[row])] = True
            if added < 0:
                _mark_drops(tokens, row, spelled[row], dropped, found.is_legal[row])


@kernel
def _last(spelled: Array, sign: int) -> int:
    """Return the last capability that counts by this sign, or -1."""
    for cap in range(len(spelled) - 1, -1, -1):
        if spelled[cap] * sign > 0:
            return cap
    return -1


@kernel
def _mark_targets(
    is_full: bool, tokens: Spelled, row: int, spelled: Array, last: int, found: Any
) -> None:
    """Mark what goes on to counts that can be named: to maintain, or to join a team."""
    caps, end = len(spelled), found.is_legal.shape[1] - 1
    for target in range(tokens.can_join.shape[1]):
        if target > 0 and not tokens.can_join[row, target]:
            continue
        following, is_alive, is_nothing = caps, True, True
        for cap in range(caps):
            brings = tokens.team_counts[row, target, cap] if target > 0 else 0.0
            is_nothing &= brings == 0.0
            lacks = brings - spelled[cap]
            if is_full:
                lacks += tokens.team_counts[row, 0, cap]
            is_alive &= lacks >= 0.0
            if lacks > 0.0 and following == caps:
                following = cap
        if is_alive and following >= last and not (target > 0 and is_nothing):
            symbol = following if following < caps else end
            found.is_legal[row, symbol] = True
            found.is_maintain[row, symbol] |= target == 0


@kernel
def _mark_splits(tokens: Spelled, row: int, spelled: Array, last: int, is_legal: Array) -> None:
    """Mark what goes on to fewer counts into which some robot fits, when all are spelled."""
    caps = len(spelled)
    for cap in range(caps):
        if spelled[cap] > tokens.team_counts[row, 0, cap]:
            return
    reach = -1  # the last capability that can come next so that some robot still fits
    for cap in range(caps):
        if tokens.singles[row, cap] > 0:
            reach = max(reach, caps if spelled[cap] >= tokens.singles[row, cap] else cap)
    for kind in range(tokens.profiles.shape[1]):
        if tokens.profiles[row, kind, 0] >= NEVER_FITS:
            break
        reach = max(reach, _first_beyond(tokens.profiles[row, kind], spelled))
    for cap in range(max(last, 0), min(reach + 1, caps)):
        is_legal[cap] |= spelled[cap] < tokens.team_counts[row, 0, cap]
    is_legal[caps] |= reach == caps


@kernel
def _first_beyond(profile: Array, spelled: Array) -> int:
    """Return the first capability of which a robot has more than is spelled; their number: none."""
    for cap in range(len(spelled)):
        if profile[cap] > spelled[cap]:
            return cap
    return len(spelled)


@kernel
def _mark_drops(tokens: Spelled, row: int, spelled: Array, last: int, is_legal: Array) -> None:
    """Mark what can be dropped so that some robot still stays."""
    caps = len(spelled)
    own = tokens.team_counts[row, 0]
    fitting = 0
    for cap in range(caps):
        single = tokens.singles[row, cap]
        fitting += single > 0 and own[cap] + spelled[cap] >= single
    for cap in range(max(last, 0), caps):
        kept = own[cap] + spelled[cap]
        single = tokens.singles[row, cap]
        if kept >= 1 and fitting > (single > 0 and single == kept):
            is_legal[caps + cap] = True
    for kind in range(tokens.profiles.shape[1]):
        if tokens.profiles[row, kind, 0] >= NEVER_FITS:
            break
        _mark_drops_around(tokens.profiles[row, kind], own, spelled, last, is_legal)


@kernel
def _mark_drops_around(
    profile: Array, own: Array, spelled: Array, last: int, is_legal: Array
) -> None:
    """Mark what can be dropped so that one kind of robot stays."""
    caps = len(spelled)
    for cap in range(caps):
        if own[cap] + spelled[cap] < profile[cap]:
            return
    for cap in range(max(last, 0), caps):
        is_legal[caps + cap] |= own[cap] + spelled[cap] > profile[cap]
