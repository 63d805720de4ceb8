"""Plans that were made before, given again when the same happens at the same time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from teamformer.mission.coordination import Coordinator, Known, Plan, heeded_by


@dataclass(frozen=True)
class Replayed:
    """Gives the plans of a history; where something else happens it asks another coordinator.

    `plans` has the steps made, or the time, and the plan from then on. So a past is played again
    without being planned again.
    """

    plans: Sequence[tuple[float, Plan]]
    coordinator: Coordinator

    @property
    def heeds(self) -> tuple[str, ...]:
        """Return what the other coordinator heeds."""
        return heeded_by(self.coordinator)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan that was made now after this news, or a new one."""
        for at, made in self.plans:
            is_same = at == known.now and made.why == known.news
            if is_same and set(known.possible_tasks) <= set(made.order):
                return made
        return self.coordinator.update(known, plan)
