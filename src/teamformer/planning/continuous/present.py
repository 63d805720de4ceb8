"""The shared plan of a mission in continuous time from the present on."""

from __future__ import annotations

from dataclasses import replace

from teamformer.base.errors import TeamformerError
from teamformer.mission.checks.links import groups_of
from teamformer.mission.coordination import Known, Plan
from teamformer.planning.continuous.continuous_mission import ContinuousMission, pose_present
from teamformer.planning.continuous.repair import repaired
from teamformer.planning.continuous.solve import plan_again, plan_together
from teamformer.planning.linked.solve import plan_linked, plan_linked_again
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.links import LinkedProblem


def plan_present(known: Known, old: Plan | None = None) -> Plan:
    """Return the plan from the present on; never worse by its own count than the old one, mended.

    Robots that will be lost or back and tasks that have not appeared play no part; what the robots
    that are left cannot do is not in the plan. Without an old plan it is the plan of
    `teamformer plan --method plan`. Raises `TeamformerError` if linked tasks find no coalitions.
    """
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    posed = pose_present(known)
    if old is None:
        made = _plan_anew(posed)
        if made is None:
            raise TeamformerError(
                f"{posed.source.name}: no coalitions were found for tasks that are linked",
                "different robots do them, so add robots or drop a link",
            )
        return posed.as_plan(made, "arcs")
    mended = repaired(posed, old) if old.order else None
    again = _plan_anew(posed) if mended is None else _improve(posed, mended)
    if again is None:  # robots are lost: the others do what they can until these are back
        return plan_present(_with_fewer_links(known), old)
    return posed.as_plan(again, "arcs" if mended is None else "old plan")


def _plan_anew(posed: ContinuousMission) -> CoalitionPlan | None:
    """Return the plan of a first search; None if linked tasks find no coalitions."""
    problem = posed.problem
    if isinstance(problem, LinkedProblem):
        made = plan_linked(problem)
        return None if made is None else made.plan
    together = plan_together(problem)
    assert together is not None, "all tasks are possible"
    return together.plan


def _improve(posed: ContinuousMission, mended: CoalitionPlan) -> CoalitionPlan | None:
    """Return what a shorter search makes of a plan; None as above."""
    if isinstance(posed.problem, LinkedProblem):
        made = plan_linked_again(posed.problem, mended)
        return None if made is None else made.plan
    return plan_again(posed.problem, mended).plan


def _with_fewer_links(known: Known) -> Known:
    """Return what is known without the last tasks whose starts are linked with one another."""
    groups = [set(group) for group in groups_of(known.mission.tasks) if len(group) > 1]
    left = set(known.possible_tasks)
    last = next(group for group in reversed(groups) if group & left)
    return replace(known, open_tasks=tuple(sorted(left - last)))
