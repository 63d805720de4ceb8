"""A plan of a mission in continuous time whose tasks a network has given out."""

from __future__ import annotations

from teamformer.base.errors import TeamformerError
from teamformer.methods.by_name import Method
from teamformer.methods.coordinators.giving_out import GivesOutTasks
from teamformer.methods.learned.dispatch.giving_out import GivingOut, give_out_all
from teamformer.planning.continuous.continuous_mission import ContinuousMission
from teamformer.planning.continuous.reactive import solution_of
from teamformer.planning.problem.routes import MissionPlan


def plan_given_out(mission: ContinuousMission, method: Method) -> MissionPlan | None:
    """Return the plan that a learned method makes; None if there is no coalition for some task.

    Raises `TeamformerError` for a method that gives out no tasks.
    """
    if not isinstance(method.coordinator, GivesOutTasks):
        hint = "use one that was trained with network: tasks"
        raise TeamformerError(f"method '{method.name}' makes no plans in continuous time", hint)
    given = GivingOut.of(mission.problem)
    if not give_out_all([given], method.coordinator.score)[0]:
        return None
    return mission.tell(solution_of(mission.problem, given.schedule.plan))
