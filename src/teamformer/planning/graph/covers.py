"""The coalitions that cover a need, as numbers of robots of each type, with nobody to spare."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.array_types import Int32s
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.problem.coalition_problem import NOBODY

if TYPE_CHECKING:
    from teamformer.base.array_types import Array

MOST_COVERS = 48
"""With more covers than this those of fewest robots are listed."""

MOST_TYPES = 40
"""With more types of robots nothing is listed: covers are found greedily."""

MOST_STEPS = 100_000
"""How long covers of one need are looked for; where that is not enough they are found greedily."""


def list_covers(counts: Int32s, number: Int32s, needs: Int32s) -> tuple[Int32s, Int32s, Int32s]:
    """Return how many of each type are of use, the covers, and how many are listed, by need.

    Covers are (needs, covers, width, 2): types with how many robots of each, then NOBODY. `number`
    says how many robots of each type there are.
    """
    types, width = len(counts), int(needs.sum(axis=1).max(initial=1))
    useful = _useful(counts, number, needs)
    listed = np.zeros(len(needs), np.int32)
    if types > MOST_TYPES:
        return useful, np.full((len(needs), 1, 1, 2), NOBODY, np.int32), listed
    width = min(width, int(number.sum()), types)
    covers = np.full((len(needs), MOST_COVERS, width + 1, 2), NOBODY, np.int32)
    picks = np.zeros((int(needs.sum(axis=1).max(initial=1)) + 1, needs.shape[1] + 1), np.int32)
    for need in range(len(needs)):
        listed[need] = list_of_need(counts, number, needs[need], picks, covers[need])
    return useful, covers, listed


def _useful(counts: Int32s, number: Int32s, needs: Int32s) -> Int32s:
    """Return how many robots of a type a coalition has at most if it has none to spare."""
    useful = np.zeros((len(needs), len(counts)), np.int32)
    for kind, brings in enumerate(counts):
        has = brings > 0
        if has.any():
            asked = -(-needs[:, has] // brings[has])  # (needs, caps), rounded up
            useful[:, kind] = np.minimum(asked.max(axis=1), number[kind])
    return useful


@entry
def list_of_need(counts: Array, number: Array, need: Array, picks: Array, covers: Array) -> int:
    """List the covers of a need, fewest robots first; return how many there are.

    `picks` has a row for each robot picked so far: its type, and what was lacking before it. They
    are picked in the order of their types.
    """
    found, steps, caps = 0, 0, len(need)
    for size in range(1, len(picks)):
        depth = 0
        picks[0, 0] = -1
        for cap in range(caps):
            picks[0, 1 + cap] = need[cap]
        while depth >= 0:
            steps += 1
            if steps > MOST_STEPS:
                return 0
            picks[depth, 0] += 1
            kind = picks[depth, 0]
            if kind >= len(counts):
                depth -= 1
                continue
            if not _can_add(counts, number, picks, depth):
                continue
            lacking = 0
            for cap in range(caps):
                lacking += max(0, picks[depth, 1 + cap] - counts[kind, cap])
            if lacking == 0:
                if depth + 1 == size and _has_none_to_spare(counts, need, picks, size):
                    _write(picks, size, covers[found])
                    found += 1
                    if found == len(covers):
                        return found
            elif depth + 1 < size:
                for cap in range(caps):
                    picks[depth + 1, 1 + cap] = picks[depth, 1 + cap] - counts[kind, cap]
                picks[depth + 1, 0] = kind - 1
                depth += 1
    return found


@kernel
def _can_add(counts: Array, number: Array, picks: Array, depth: int) -> bool:
    """Say whether one more robot of the type at hand exists and brings what is lacking."""
    kind, taken, helps = picks[depth, 0], 0, False
    for other in range(depth):
        taken += picks[other, 0] == kind
    for cap in range(counts.shape[1]):
        helps |= counts[kind, cap] > 0 and picks[depth, 1 + cap] > 0
    return helps and taken < number[kind]


@kernel
def _has_none_to_spare(counts: Array, need: Array, picks: Array, size: int) -> bool:
    for out in range(size):
        is_needed = False
        for cap in range(len(need)):
            has = 0
            for other in range(size):
                if other != out:
                    has += counts[picks[other, 0], cap]
            is_needed |= has < need[cap]
        if not is_needed:
            return False
    return True


@kernel
def _write(picks: Array, size: int, cover: Array) -> None:
    """Write the types that are picked, and how many of each."""
    count = -1
    for index in range(size):
        if index == 0 or picks[index, 0] != picks[index - 1, 0]:
            count += 1
            cover[count, 0], cover[count, 1] = picks[index, 0], 0
        cover[count, 1] += 1
    cover[count + 1, 0] = NOBODY
