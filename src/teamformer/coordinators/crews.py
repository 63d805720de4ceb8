"""Crews: standing parts of the fleet, each with a list of tasks that it does in order."""

from __future__ import annotations

from dataclasses import dataclass, replace

from teamformer.coordination import Known, Plan
from teamformer.planning.teams.situation import plan_of, situation_of
from teamformer.planning.teams.starts import plan_from_crews

ROUNDS = 1500
"""How many changes are tried for each open task."""


@dataclass(frozen=True)
class Crews:
    """Deals robots out into crews, and tasks to their lists; sooner than a shared plan is made."""

    rounds: int = ROUNDS

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return what crews do that are dealt out now, whatever they were before."""
        if not known.possible_tasks:
            return Plan(made_from="nothing")
        situation = situation_of(replace(known, open_tasks=known.possible_tasks))
        rounds = self.rounds * len(situation.tasks)
        found = plan_from_crews(situation.problem, situation.company, rounds)
        return replace(plan_of(situation, found), made_from="crews")
