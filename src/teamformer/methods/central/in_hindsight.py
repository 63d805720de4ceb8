"""The central planner in continuous time: told what a mission really is, it searches at the start.

What is lost or called off it does not foresee; then it plans again, as the shared plan does.
"""

from __future__ import annotations

from dataclasses import replace

from teamformer.base.errors import UndoableError
from teamformer.methods.central.policy import Central
from teamformer.mission.coordination import Known, Plan
from teamformer.mission.model import Mission
from teamformer.planning.continuous.continuous_mission import ContinuousMission, pose_mission
from teamformer.planning.continuous.present import plan_present
from teamformer.planning.continuous.rules import warm_up
from teamformer.planning.continuous.solve import solve


class InHindsight:
    """Plans a mission by its truth, for as long as the central planner may; then as it goes on.

    `bound` is what no plan of the truth is over before, in the mission's unit; 0 if tasks are
    called off, or lost robots need not come home, which the search does not foresee.
    """

    def __init__(self, truth: Mission, settings: Central) -> None:
        self._truth, self._settings = truth, settings
        self.bound = 0.0

    def update(self, known: Known, plan: Plan | None) -> Plan:
        """Return the plan of the search at the start, and later what is left of it, improved."""
        if plan is not None:
            return plan_present(known, plan)
        posed = pose_mission(self._truth)
        warm_up(self._truth)
        return self._search(posed)

    def _search(self, posed: ContinuousMission) -> Plan:
        start = None if self._settings.start is None else posed.as_arrays(self._settings.start)
        found = solve(
            posed.problem, self._settings.time_limit, workers=self._settings.workers, start=start
        )
        if found is None:
            raise UndoableError(
                f"{self._truth.name}: no plan was found in which every task has able robots",
                "add robots, or drop a link",
            )
        if not _is_less_to_do(self._truth):
            self.bound = posed.tell(found).bound
        return replace(posed.as_plan(found.plan), made_from="arcs")


def _is_less_to_do(truth: Mission) -> bool:
    """Say whether less has to be done than a plan of all tasks has, with everybody home."""
    is_lost = truth.ends is not None and any(robot.absences for robot in truth.robots)
    return is_lost or any(task.cancelled is not None for task in truth.tasks)
