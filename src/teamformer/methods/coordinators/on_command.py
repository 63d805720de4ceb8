"""Teams go by the tasks that decisions name, and by nothing else."""

from __future__ import annotations

from teamformer.mission.coordination import Known, Plan


class OnCommand:
    """Plans nothing: a team heads for the task that its decision names, or stays."""

    heeds: tuple[str, ...] = ()
    times: tuple[str, ...] = ("steps",)

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return an empty plan."""
        return Plan()
