"""Plans are carried out to see when they end where who queues hangs on everybody.

The search does not know of batteries, nor of loads at zones. Of the plans that it comes by, this
chooses.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission, as_believed
from teamformer.mission.parts.zones import has_loads_at_zones
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY

MOST_TIMES, MORE = 20, 1000
"""A plan that is not done after so many times the steps that it counts with, and more, never is."""


@dataclass(frozen=True)
class _Kept:
    """A coordinator that keeps to a plan."""

    plan: Plan
    heeds: tuple[str, ...] = ()

    def update(self, known: Known, plan: Plan | None) -> Plan:
        return self.plan


def may_be_carried_out(known: Known) -> bool:
    """Say whether a plan is made at the start for robots that may queue, and by its makespan."""
    mission = known.mission
    is_start = known.now == 0 and not known.under_way
    is_by_makespan = mission.cost is None and mission.until is None
    may_queue = mission.charging is not None or has_loads_at_zones(mission)
    return may_queue and is_start and is_by_makespan


def best_carried_out(known: Known, plans: Iterable[Plan]) -> Plan:
    """Return the plan that is done first, with the steps in which its tasks really are.

    Of plans that are done in the same step it is the first, and if none is ever done the first of
    all. Nothing happens that nobody can foresee.
    """
    mission, found, tried = _as_foreseen(known.mission), list[Plan](), set[Plan]()
    best, least = None, np.inf
    for plan in plans:
        found.append(plan)
        bare = replace(plan, ends=(), made_from="")
        most = min(MOST_TIMES * plan.makespan + MORE, least - 1)
        if bare in tried or (ends := _carry_out(mission, bare, most)) is None:
            continue
        tried.add(bare)
        best, least = replace(plan, ends=ends), max(ends)
    return best or found[0]


def _carry_out(mission: Mission, plan: Plan, most: float) -> tuple[int, ...] | None:
    """Return when the tasks of a plan are done; None if not all are after so many steps."""
    env, order = TeamFormation([mission], truths=[mission], coordinator=_Kept(plan)), [*plan.order]
    while env.is_running[0] and env.worlds.count["steps"][0] < most:
        env.step(env.planned_decision(env.view()))
        ends = env.worlds.tasks["done_at"][0, order]
        if (ends != NOBODY).all():
            return tuple(ends.tolist())
    return None


def _as_foreseen(mission: Mission) -> Mission:
    """Return a mission in which all is as it is believed, and nobody is lost or held up."""
    robots = (replace(it, absences=(), delays=None, breaks=None) for it in mission.robots)
    tasks = (
        replace(task, lasts=None, may_need={}, within=0.0, cancelled=None) for task in mission.tasks
    )
    return as_believed(mission, robots=tuple(robots), tasks=tuple(tasks), arrivals=None)
