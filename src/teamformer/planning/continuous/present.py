"""The shared plan of a mission in continuous time from the present on."""

from __future__ import annotations

from teamformer.base.errors import TeamformerError
from teamformer.mission.coordination import Known, Plan
from teamformer.planning.continuous.continuous_mission import ContinuousMission, pose_present
from teamformer.planning.continuous.repair import repaired
from teamformer.planning.continuous.solve import plan_again, plan_together
from teamformer.planning.problem.coalition_plan import CoalitionPlan


def plan_present(known: Known, old: Plan | None = None) -> Plan:
    """Return the plan from the present on; never worse by its own count than the old one, mended.

    Robots that will be lost or back and tasks that have not appeared play no part; what the robots
    that are left cannot do is not in the plan. Without an old plan it is the plan of
    `teamformer plan --method plan`. Raises `TeamformerError` if linked tasks find no coalitions.
    """
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    posed = pose_present(known)
    mended = None if old is None or not old.order else repaired(posed, old)
    if mended is None:
        return posed.as_plan(_plan_anew(posed), "arcs")
    made = plan_again(posed.problem, mended)
    return posed.as_plan(mended if made is None else made.plan, "old plan")


def _plan_anew(posed: ContinuousMission) -> CoalitionPlan:
    made = plan_together(posed.problem)
    if made is None:
        raise TeamformerError(
            f"{posed.source.name}: no coalitions were found for tasks that are linked",
            "different robots do them, so add robots or drop a link",
        )
    return made.plan
