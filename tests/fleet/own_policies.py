"""A user's policies: that of docs/reference/policies.md, one that never joins, one that errs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.mission.model import Mission
from teamformer.world.env import Decision
from teamformer.world.view import View


class Alone:
    """Maintains, whatever happens."""

    needs_everything = False

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        self.rng = rng
        self.asked = 0

    def decide(self, view: View) -> Decision:
        self.asked += 1
        return Decision(view.counts.copy())


class Sociable(Alone):
    """Joins the first team that it may join where it stands; never splits."""

    def decide(self, view: View) -> Decision:
        self.asked += 1
        wanted = view.counts.copy()
        for team in range(len(wanted)):
            partners = (view.can_join[team] & view.is_here[team]).nonzero()[0]
            if len(partners):
                wanted[team] += view.seen_counts[team, partners[0]]
        return Decision(wanted)


class Parting(Sociable):
    """Joins likewise; a team of several without a task at hand keeps its last robot only."""

    def decide(self, view: View) -> Decision:
        if view.size[0] > 1 and not view.is_at_task[0]:
            return Decision(view.member_counts[-1:].copy())
        return super().decide(view)


class Erratic(Alone):
    """Wants anything, most of which is no decision, and names tasks at random."""

    def decide(self, view: View) -> Decision:
        wanted, task = view.counts.copy(), None
        kind = self.rng.integers(4)
        if kind == 0 and view.can_join[0].any():
            wanted[0] += view.seen_counts[0, self.rng.choice(view.can_join[0].nonzero()[0])]
        elif kind == 1:
            wanted[0] = view.member_counts[self.rng.integers(len(view.member_counts))]
        elif kind == 2:
            wanted[0] = self.rng.integers(-3, 5, size=wanted.shape[1])
        if self.rng.random() < 0.3:
            task = np.array([self.rng.choice(view.task_number[0])])
        return Decision(wanted, task)
