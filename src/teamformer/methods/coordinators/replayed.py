"""Plans that were made before, given again when the same happens at the same time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

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
                return _without_left_out(known, made)
        return self.coordinator.update(known, plan)


def _without_left_out(known: Known, plan: Plan) -> Plan:
    """Return a plan without the optional tasks that it has for nobody: it gives these up."""
    tasks, pairs = known.mission.tasks, zip(plan.order, plan.coalitions, strict=True)
    rows = [(task, robots) for task, robots in pairs if robots or not tasks[task].optional]
    if len(rows) == len(plan.order):
        return plan
    order, coalitions = tuple(task for task, _ in rows), tuple(robots for _, robots in rows)
    return replace(plan, order=order, coalitions=coalitions, ends=())
