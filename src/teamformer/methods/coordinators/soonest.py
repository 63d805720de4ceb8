"""The rule without search: the task that can begin soonest, by those who are there first.

Every robot works it out alike from what everybody knows, as with a shared plan. It needs no network
and no search, so it is a bar for both.
"""

from __future__ import annotations

from teamformer.mission.coordination import NEWS, Known, Plan
from teamformer.planning.continuous.present import soonest_present
from teamformer.planning.steps.reactive import soonest_plan


class Soonest:
    """Next comes the task that can begin soonest, by whoever is there first; nothing is searched.

    It is asked whenever something is done, too, as in steps it does not foresee how long forming
    takes.
    """

    heeds = NEWS

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return who does each task that is possible now, in the order in which they can begin."""
        if known.mission.time == "continuous":
            return soonest_present(known, plan)
        return soonest_plan(known)
