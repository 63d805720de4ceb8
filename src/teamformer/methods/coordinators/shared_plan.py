"""The shared plan: every robot works it out alike, and makes it again when there is news."""

from __future__ import annotations

from dataclasses import dataclass

from teamformer.methods.coordinators.carried_out import best_carried_out, may_be_carried_out
from teamformer.mission.coordination import Known, Plan
from teamformer.planning.continuous.present import plan_present
from teamformer.planning.steps.free_looks import with_free_looks
from teamformer.planning.steps.shared_plan import plan_mission


@dataclass(frozen=True)
class SharedPlan:
    """The shared plan: every robot works out alike who does what with whom, and who scouts.

    With `scouts` robots that have time to spare look first at tasks that nobody knows all of.
    `is_brief` is for those who plan again often: then with fewer searches, and shorter ones.
    """

    scouts: bool = True
    is_brief: bool = False

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return a plan from now on, as good as the old one by its own count or better."""
        old = plan if plan is not None and plan.order else None
        if known.mission.time == "continuous":
            return plan_present(known, old)
        choose = best_carried_out if may_be_carried_out(known) else None
        found = plan_mission(known, old, self.is_brief and old is not None, choose)
        return with_free_looks(known, found) if self.scouts else found
