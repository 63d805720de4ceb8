"""Scripted policies that are stronger than the paper's heuristic: the honest bar for learning."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, entry, kernel
from teamformer.methods.scripted.pairing import is_partner, keep_first_half, pair_by_slot
from teamformer.mission.model import Mission
from teamformer.world.env import Decision
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View


class JoinAll:
    """Joins a team in the same place whenever it adds what an open task needs; splits hardly ever.

    Useful means: some task in view needs more of a capability than the own team has, and the
    other team has it. Teams in one place pair off by slot, first with second, third with fourth,
    so that many become one in few steps. Who flies over walls joins others only where no task
    that they cannot get to waits for it, and halves its team with them where one does.
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
    lacks = np.empty(view.counts.shape[1], dtype=np.bool_)
    for row in range(len(wanted)):
        if view.is_serving[row]:
            continue
        if view.has_to_part[row]:
            keep_first_half(view, row, wanted[row])
            continue
        _mark_lacks(view, row, lacks)
        chosen = pair_by_slot(view, row, False)
        if chosen == NOBODY or not _is_useful(view, row, chosen, lacks):
            chosen = _first_useful(view, row, lacks)
        if chosen != NOBODY:
            for cap in range(len(lacks)):
                wanted[row, cap] += view.seen_counts[row, chosen, cap]


@allocating_kernel
def _mark_lacks(view: View, row: int, lacks: Array) -> None:
    """Mark the capabilities of which a task in view needs more than the team has."""
    lacks[:] = False
    for task in range(view.task_number.shape[1]):
        for cap in range(len(lacks)):
            lacks[cap] |= view.task_needs[row, task, cap] > view.counts[row, cap]


@kernel
def _first_useful(view: View, row: int, lacks: Array) -> int:
    for other in range(view.seen_slot.shape[1]):
        is_possible = is_partner(view, row, other, False)
        if is_possible and _is_useful(view, row, other, lacks):
            return other
    return NOBODY


@kernel
def _is_useful(view: View, row: int, other: int, lacks: Array) -> bool:
    for cap in range(len(lacks)):
        if lacks[cap] and view.seen_counts[row, other, cap] > 0:
            return True
    return False
