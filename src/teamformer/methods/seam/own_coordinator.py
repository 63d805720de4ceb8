"""A coordinator of a user's own: what goes wrong in it is told by file and line."""

from __future__ import annotations

from teamformer.base.errors import TeamformerError
from teamformer.base.own_code import telling_where
from teamformer.mission.coordination import Coordinator, Known, Plan, heeded_by, times_of


class OwnCoordinator:
    """Asks a coordinator that a user wrote, and refuses what is no plan."""

    def __init__(self, coordinator: Coordinator, name: str) -> None:
        self._coordinator, self._name = coordinator, name

    @property
    def heeds(self) -> tuple[str, ...]:
        """Return the news after which it is asked."""
        return heeded_by(self._coordinator)

    @property
    def times(self) -> tuple[str, ...]:
        """Return of which times missions are that it can plan."""
        return times_of(self._coordinator)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return its plan; raises `TeamformerError` where it fails or returns none."""
        with telling_where(f"coordinator '{self._name}' failed"):
            made = self._coordinator.update(known, plan)
        if not isinstance(made, Plan):
            what = f"update() returned {type(made).__name__}, not a Plan"
            hint = "see docs/reference/coordinators.md for what a coordinator returns"
            raise TeamformerError(f"coordinator '{self._name}': {what}", hint)
        return made
