"""The reactive rule: the best of some hundred futures by the rule `soonest`, with noise.

Every robot works it out alike from what everybody knows, and plays the futures again whenever
something is done. What was decided before stays unless a future is better.
"""

from __future__ import annotations

from teamformer.mission.coordination import NEWS, Known, Plan
from teamformer.planning.continuous.present import reactive_present
from teamformer.planning.steps.reactive import reactive_plan


class Reactive:
    """Nothing is searched: some hundred futures by the rule `soonest`, and the best is followed."""

    heeds = NEWS

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the best future, or what is left of the plan if none is better."""
        if known.mission.time == "continuous":
            return reactive_present(known, plan)
        return reactive_plan(known, plan)
