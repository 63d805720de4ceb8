"""The shared plan of a mission in continuous time from the present on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from teamformer.base.errors import TeamformerError
from teamformer.mission.checks.links import groups_of
from teamformer.mission.coordination import Known, Plan
from teamformer.planning.continuous.continuous_mission import pose_present
from teamformer.planning.continuous.reactive import dispatch, react
from teamformer.planning.continuous.repair import repaired
from teamformer.planning.continuous.solve import Solution, plan_again, plan_together
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem

Rule = Callable[[CoalitionProblem, CoalitionPlan | None], Solution | None]
"""Solves what is left of a mission; it is given what is left of the old plan, mended, if any."""


def plan_present(known: Known, old: Plan | None = None) -> Plan:
    """Return the plan from the present on; never worse by its own count than the old one, mended.

    Robots that will be lost or back and tasks that have not appeared play no part; what the robots
    that are left cannot do is not in the plan. Without an old plan it is the plan of
    `teamformer plan --method plan`. Raises `TeamformerError` if linked tasks find no coalitions.
    """
    return _solve_present(known, old, _search, "arcs")


def soonest_present(known: Known, old: Plan | None) -> Plan:
    """Return the plan by the rule `soonest` from the present on, or the old one if it still holds.

    Raises what `plan_present` raises.
    """
    if old is not None and _goes_as_planned(known, old):
        return old
    return _solve_present(known, None, lambda problem, _: dispatch(problem), "soonest")


def reactive_present(known: Known, old: Plan | None) -> Plan:
    """Return the best of many futures by that rule, and of the old plan, from the present on.

    All that is decided one after the other is in it, so it is left alone while all goes as planned.
    Raises what `plan_present` raises.
    """
    if old is not None and _goes_as_planned(known, old):
        return old
    return _solve_present(known, old, react, "futures")


def _search(problem: CoalitionProblem, mended: CoalitionPlan | None) -> Solution | None:
    return plan_together(problem) if mended is None else plan_again(problem, mended)


def _goes_as_planned(known: Known, old: Plan) -> bool:
    """Say whether a plan foresaw the news, has all that can be done, and nothing of it is late."""
    is_foreseen = known.news == ("task done",) and set(known.possible_tasks) <= set(old.order)
    return is_foreseen and min(old.ends, default=known.now) >= known.now


def _solve_present(known: Known, old: Plan | None, rule: Rule, made_from: str) -> Plan:
    """Return the plan that a rule makes, of all that is possible, if need be without some links."""
    if not known.possible_tasks:
        return Plan(made_from="nothing")
    posed = pose_present(known)
    mended = None if old is None or not old.order else repaired(posed, old)
    made = rule(posed.problem, mended)
    if made is not None:
        return posed.as_plan(made.plan, made_from if mended is None else "old plan")
    fewer = _with_fewer_links(known)  # others wait until robots are back
    if fewer is None:
        raise TeamformerError(
            f"{posed.source.name}: no coalitions were found for tasks that are linked",
            "different robots do them, so add robots or drop a link",
        )
    return _solve_present(fewer, old, rule, made_from)


def _with_fewer_links(known: Known) -> Known | None:
    """Return what is known without the last tasks whose starts are linked with one another.

    At the start only what is optional can be left out: None if nothing is.
    """
    tasks, left = known.mission.tasks, set(known.possible_tasks)
    groups = [set(group) & left for group in groups_of(tasks) if len(group) > 1]
    if "start" in known.news:
        groups = [group for group in groups if all(tasks[task].optional for task in group)]
    last = next((group for group in reversed(groups) if group), None)
    return None if last is None else replace(known, open_tasks=tuple(sorted(left - last)))
