"""The shared plan of a mission in continuous time from the present on."""

from __future__ import annotations

from dataclasses import replace

from teamformer.base.errors import TeamformerError
from teamformer.mission.checks.links import groups_of
from teamformer.mission.coordination import Known, Plan
from teamformer.planning.continuous.continuous_mission import pose_present
from teamformer.planning.continuous.repair import repaired
from teamformer.planning.continuous.solve import plan_again, plan_together


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
    made = plan_together(posed.problem) if mended is None else plan_again(posed.problem, mended)
    if made is not None:
        return posed.as_plan(made.plan, "arcs" if mended is None else "old plan")
    if old is None:
        raise TeamformerError(
            f"{posed.source.name}: no coalitions were found for tasks that are linked",
            "different robots do them, so add robots or drop a link",
        )
    return plan_present(_with_fewer_links(known), old)  # others wait until robots are back


def _with_fewer_links(known: Known) -> Known:
    """Return what is known without the last tasks whose starts are linked with one another."""
    groups = [set(group) for group in groups_of(known.mission.tasks) if len(group) > 1]
    left = set(known.possible_tasks)
    last = next(group for group in reversed(groups) if group & left)
    return replace(known, open_tasks=tuple(sorted(left - last)))
