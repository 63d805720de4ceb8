"""Plays the shared plan, step for step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.model import Scenario
from teamformer.policies.scripted.joining import JoinUseful
from teamformer.sim.env import Decision
from teamformer.sim.view import View


class FollowPlan:
    """Form as the shared plan wants; where there is none, do as `JoinCrew` or `JoinAll`."""

    needs_everything = False

    def begin(self, everything: Sequence[Scenario] | None, rng: np.random.Generator) -> None:
        """Nothing to prepare."""

    def decide(self, view: View) -> Decision:
        """Have the counts that the plan wants."""
        if view.has_plan.all():
            return Decision(view.planned.copy())
        wanted = JoinUseful().decide(view).wanted
        wanted[view.has_plan] = view.planned[view.has_plan]
        return Decision(wanted)
