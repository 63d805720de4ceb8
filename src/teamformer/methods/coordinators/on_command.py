"""Teams go by the tasks that decisions name, and by nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from teamformer.mission.coordination import Known, Plan


@dataclass(frozen=True)
class OnCommand:
    """Plans nothing: a team heads for the task that its decision names, or stays.

    Optional tasks that are `left_out` are given up when all else is over.
    """

    left_out: frozenset[int] = frozenset()
    times: ClassVar[tuple[str, ...]] = ("steps",)

    @property
    def heeds(self) -> tuple[str, ...]:
        """Return the news after which it is asked: tasks that appear may be left out."""
        return ("task appeared",) if self.left_out else ()

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return a plan of all other tasks, for nobody."""
        order = tuple(task for task in known.open_tasks if task not in self.left_out)
        return Plan(order, ((),) * len(order))
