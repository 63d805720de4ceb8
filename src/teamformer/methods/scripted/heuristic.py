"""The paper's heuristic: meet at the task, join there, part when it is done."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import entry, kernel
from teamformer.methods.scripted.pairing import keep_first_half, pair_by_slot
from teamformer.mission.model import Mission
from teamformer.world.env import Decision
from teamformer.world.rules.constants import NOBODY
from teamformer.world.view import View


class Heuristic:
    """The paper's heuristic: meet at the task, join there, part when it is done.

    It is Boehme and Hollinger's comparison policy (ICRA 2026, section V-B). A team maintains until
    it stands at its assigned task. There it joins the teams with the same assignment, which pair
    off, until the requirements are met. Afterwards it halves, step by step, until every robot is
    alone or stands at its new assignment. That this ends is shown in
    docs/explanation/nothing-blocks-policies.md.
    """

    needs_everything = False

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        """Nothing to prepare."""

    def decide(self, view: View) -> Decision:
        """Join at the task, halve elsewhere, else maintain."""
        wanted = view.counts.copy()
        _decide(view, wanted)
        return Decision(wanted)


@entry
def _decide(view: View, wanted: Array) -> None:
    for row in range(len(wanted)):
        if view.is_serving[row]:
            continue
        if view.is_at_task[row] and not view.has_to_part[row]:
            _join_at_task(view, row, wanted[row])
        elif view.size[row] > 1:
            keep_first_half(view, row, wanted[row])


@kernel
def _join_at_task(view: View, row: int, wanted: Array) -> None:
    other = pair_by_slot(view, row, True)
    if other != NOBODY:
        for cap in range(len(wanted)):
            wanted[cap] += view.seen_counts[row, other, cap]
