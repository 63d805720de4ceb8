"""The list schedule along the task order: what is left to win by forming teams better."""

from __future__ import annotations

from teamformer.mission.checks.windows import may_begin_at_once
from teamformer.mission.model import Mission
from teamformer.planning.problem.relaxed_problem import relax
from teamformer.planning.relaxation.schedule import schedule_tasks
from teamformer.world.env import TeamFormation


def list_schedule(mission: Mission) -> int | None:
    """Return the makespan of the list schedule along the task order, if joining is free.

    None where tasks appear later: the order is not all known then.
    """
    if not all(map(may_begin_at_once, mission.tasks)):
        return None
    order = TeamFormation([mission]).worlds.order[0, : len(mission.tasks)]
    schedule = schedule_tasks(relax(mission), order.tolist())
    return schedule.makespan if schedule else None
