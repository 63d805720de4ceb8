"""The list schedule along the task order: what is left to win by forming teams better."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.checks.windows import may_begin_at_once
from teamformer.mission.model import Mission
from teamformer.planning.problem.coalition_plan import CoalitionPlan, without_spares
from teamformer.planning.problem.relaxed_problem import Relaxed, relax
from teamformer.planning.relaxation.relaxed_plan import makespan_of, plan_without_spares
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import FAR


def list_schedule(mission: Mission) -> int | None:
    """Return the makespan of the list schedule along the task order, if joining is free.

    None where tasks appear later: the order is not all known then.
    """
    if not all(map(may_begin_at_once, mission.tasks)):
        return None
    order = TeamFormation([mission]).worlds.order[0, : len(mission.tasks)]
    problem = relax(mission)
    plan = schedule_tasks(problem, order.tolist())
    return None if plan is None else makespan_of(problem, plan)


def schedule_tasks(problem: Relaxed, ranking: Sequence[int]) -> CoalitionPlan | None:
    """Return the list schedule of an order of all tasks.

    Each task in turn gets the coalition that can be there first. None if robots that will be lost
    leave a task without a coalition.
    """
    at = len(problem.appears) + np.arange(len(problem.pace))  # (robots,) places
    arrive, leave = problem.ready.astype(np.int64), problem.ready.astype(np.int64)
    coalitions: list[list[int]] = [[] for _ in problem.appears]
    for task in ranking:
        ways = problem.steps[problem.pace, problem.cells[task, at]]
        arrival = np.where(ways == 0, arrive, leave + ways)
        crew = coalitions[task] = _first_to_come(problem, task, arrival)
        if not crew:
            return None
        end = max(problem.appears[task] + 1, arrival[crew].max()) + problem.duration[task]
        stays = ways[crew] == 0
        arrive[crew] = arrival[crew]
        leave[crew] = np.where(stays, np.maximum(leave[crew], end), end)
        at[crew] = task
    plan = plan_without_spares(problem, ranking, coalitions)
    return None if makespan_of(problem, plan) is None else plan


def _first_to_come(problem: Relaxed, task: int, arrival: Array) -> list[int]:
    """Return who can be there first and is there at the end; nobody if that is not enough.

    Of those that come until there are enough, the first are sent away again if they can be spared:
    they would wait longest.
    """
    counts, needs, crew = problem.counts, problem.needs[task], list[int]()
    is_useful = (np.minimum(counts, needs) > 0).any(axis=1) & (arrival < FAR)  # (robots,)
    for robot in np.argsort(arrival, kind="stable").tolist():
        if not is_useful[robot]:
            continue
        crew.append(robot)
        if (counts[crew].sum(axis=0) >= needs).all():
            end = max(problem.appears[task] + 1, arrival[robot]) + problem.duration[task]
            crew = [one for one in crew if end < problem.lost[one]]
            if (counts[crew].sum(axis=0) >= needs).all():
                return without_spares(counts, needs, crew[::-1])[::-1]
    return []
