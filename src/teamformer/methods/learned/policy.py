"""Learned policies: a network behind the seam, and a rule for when it gets nowhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.methods.learned.codec import Codec
from teamformer.methods.learned.deadlock_guard import DeadlockGuard
from teamformer.methods.scripted.joining import JoinAll
from teamformer.mission.model import Mission
from teamformer.world.env import Decision
from teamformer.world.view import View

Brain = Callable[[tuple[Array, ...]], Array]
"""From the tokens of some teams (teams, ...), their actions (teams, ...)."""


class Learned:
    """Reads views with a codec and does what a brain says.

    The brain is asked where the codec finds a choice. Elsewhere a team does as join-all does, and
    so does one that the deadlock guard finds overdue, until a task is done; `overdue` counts such
    decisions.
    """

    needs_everything = False

    def __init__(self, codec: Codec, brain: Brain, is_guarded: bool = True) -> None:
        self.codec = codec
        self.brain = brain
        self.is_guarded = is_guarded
        self.overdue = 0
        self._guard = DeadlockGuard()
        self._fallback = JoinAll()

    def unguarded(self) -> Learned:
        """Return the same policy without its deadlock guard."""
        return Learned(self.codec, self.brain, is_guarded=False)

    def begin(self, everything: Sequence[Mission] | None, rng: np.random.Generator) -> None:
        """Forget earlier trials."""
        self._guard.begin()
        self.overdue = 0

    def decide(self, view: View) -> Decision:
        """Return what the brain wants where it is asked, else what the scripted policy wants."""
        wanted = self._fallback.decide(view).wanted
        tokens = self.codec.encode(view)
        is_asked = self.codec.has_choice(view, tokens)
        if self.is_guarded:
            is_overdue = self._guard.is_overdue(view)
            self.overdue += int(is_overdue.sum())
            is_asked &= ~is_overdue
        rows = np.flatnonzero(is_asked)
        if len(rows):
            action = self.brain(tuple(part[rows] for part in tokens))
            wanted[rows] = self.codec.decode(rows_of(view, rows), action)
        return Decision(wanted)


def rows_of(view: View, rows: Array) -> View:
    """Return some rows of a view, in the order given."""
    sizes = np.diff(view.first_member)[rows]
    first = np.concatenate(([0], np.cumsum(sizes)))
    members = np.repeat(view.first_member[rows] - first[:-1], sizes) + np.arange(first[-1])
    by_member = {
        "first_member": first.astype(view.first_member.dtype),
        "member": view.member[members],
        "member_counts": view.member_counts[members],
    }
    by_team = {name: getattr(view, name)[rows] for name in View._fields if name not in by_member}
    return View(**by_team, **by_member)
