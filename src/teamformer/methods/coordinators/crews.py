"""Crews: standing parts of the fleet, each with a list of tasks that it does in order."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from teamformer.mission.coordination import Known, Plan
from teamformer.mission.precedence import tasks_before
from teamformer.planning.problem.constants import NEVER
from teamformer.planning.steps.reactive import soonest_in
from teamformer.planning.steps.shared_plan import kept_plan, shared_plan_of
from teamformer.planning.steps.situation import Situation, situation_of
from teamformer.planning.steps.starts import plan_from_crews
from teamformer.planning.steps.timed_plan import TimedPlan, must_come_first, time_team_plan

ROUNDS, MOST_ROUNDS = 1500, 1_500_000
"""How many changes are tried for each open task, and in all; with more than that plans of 3,000
tasks are not better."""


@dataclass(frozen=True)
class Crews:
    """Standing parts of the fleet, each with a list of tasks; for very large missions.

    Robots are dealt out into crews, and tasks to their lists, sooner than a shared plan is made.
    Tasks that come after others are dealt when these are over; until then nobody is to do them.
    """

    rounds: int = ROUNDS
    times: ClassVar[tuple[str, ...]] = ("steps",)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return what crews do that are dealt out now, or what is left of the plan if it is over
        sooner, with new tasks at its end.
        """
        tasks = known.mission.tasks
        ready = tuple(task for task in known.possible_tasks if not tasks[task].after)
        waiting = tuple(task for task in known.possible_tasks if tasks[task].after)
        nobody: tuple[tuple[int, ...], ...] = ((),) * len(waiting)
        if not ready:
            return Plan(waiting, nobody, made_from="nothing")
        situation = situation_of(replace(known, open_tasks=ready), in_table=False)
        rounds = min(self.rounds * len(situation.tasks), MOST_ROUNDS)
        dealt = plan_from_crews(situation.problem, situation.company, rounds)
        crews = must_come_first(situation, time_team_plan(situation, dealt))
        timed = [("crews", crews)]
        if crews.has_prices:
            timed.append(("crews", _by_due(situation, crews)))
        if crews.makespan >= situation.problem.rotas.late.min(initial=NEVER):
            timed.append(("soonest", _by_shifts(replace(known, open_tasks=ready))))
        if plan is not None and plan.order:
            kept = time_team_plan(situation, kept_plan(situation, plan))
            timed.insert(0, ("kept", kept))
        made = shared_plan_of(situation, *min(timed, key=_what_counts))
        waiting = _that_may_come(known, made.order, waiting)
        nobody = ((),) * len(waiting)
        if waiting:
            order, coalitions = made.order + waiting, made.coalitions + nobody
            return replace(made, order=order, coalitions=coalitions, ends=())
        return made


def _by_shifts(known: Known) -> TimedPlan:
    """Return the plan of the rule `soonest`: crews may wait for robots whose shifts are over."""
    situation = situation_of(known)
    return time_team_plan(situation, soonest_in(situation))


def _that_may_come(
    known: Known, planned: tuple[int, ...], waiting: tuple[int, ...]
) -> tuple[int, ...]:
    """Return the waiting tasks without those that come after one that is left out."""
    tasks = known.mission.tasks
    coming = {*planned, *(task for task, _ in known.under_way)}
    before, kept = tasks_before(tasks), set(waiting)
    while out := {task for task in kept if not coming | kept >= set(before.get(task, ()))}:
        kept -= out
    return tuple(task for task in waiting if task in kept)


def _what_counts(named: tuple[str, TimedPlan]) -> int:
    return named[1].cost


def _by_due(situation: Situation, plan: TimedPlan) -> TimedPlan:
    """Return a plan with its tasks in the order in which they are due; the mission has prices."""
    due = situation.problem.prices.due
    order = plan.plan.order[np.argsort(due[plan.plan.order], kind="stable")]
    return time_team_plan(situation, plan.plan._replace(order=order))
