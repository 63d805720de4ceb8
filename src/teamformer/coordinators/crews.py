"""Crews: standing parts of the fleet, each with a list of tasks that it does in order."""

from __future__ import annotations

from dataclasses import dataclass, replace
from operator import itemgetter

from teamformer.coordination import Known, Plan
from teamformer.planning.relaxation.problem import has_prices
from teamformer.planning.steps.shared_plan import by_due, kept_plan, timed_plan
from teamformer.planning.steps.situation import situation_of
from teamformer.planning.steps.starts import plan_from_crews

ROUNDS = 1500
"""How many changes are tried for each open task."""


@dataclass(frozen=True)
class Crews:
    """Deals robots out into crews, and tasks to their lists; sooner than a shared plan is made."""

    rounds: int = ROUNDS

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return what crews do that are dealt out now, or what is left of the plan if it is over
        sooner, with new tasks at its end.
        """
        if not known.possible_tasks:
            return Plan(made_from="nothing")
        situation = situation_of(replace(known, open_tasks=known.possible_tasks))
        rounds = self.rounds * len(situation.tasks)
        dealt = plan_from_crews(situation.problem, situation.company, rounds)
        timed = [timed_plan(situation, dealt, "crews")]
        if has_prices(situation.problem):
            timed.append(timed_plan(situation, by_due(situation, dealt), "crews"))
        if plan is not None and plan.order:
            timed.insert(0, timed_plan(situation, kept_plan(situation, plan), "kept"))
        return min(timed, key=itemgetter(0))[1]
