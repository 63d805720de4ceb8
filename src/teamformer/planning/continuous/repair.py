"""What is left of an old plan, mended: lost robots replaced, new tasks last, by who comes first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from teamformer.base.array_types import Ints
from teamformer.mission.coordination import Plan
from teamformer.planning.continuous.continuous_mission import ContinuousMission
from teamformer.planning.problem.coalition_plan import (
    CoalitionPlan,
    empty_plan,
    keep_order,
    without_spares,
)
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.links import FREE, have_weights
from teamformer.planning.problem.misses import can_miss


def repaired(posed: ContinuousMission, old: Plan) -> CoalitionPlan | None:
    """Return a plan of all tasks of a problem, as an old one has it as far as can be.

    Optional tasks that it leaves out are left out. None if tasks that are linked, which different
    robots do, find nobody.
    """
    number_of = {task: number for number, task in enumerate(posed.tasks)}
    robot_of = {robot: number for number, robot in enumerate(posed.robots)}
    planned = zip(old.order, old.coalitions, strict=True)
    crews = {
        number_of[task]: [robot_of[robot] for robot in robots if robot in robot_of]
        for task, robots in planned
        if task in number_of
    }
    kept = [task for task, crew in crews.items() if crew]
    new = sorted(set(range(len(posed.tasks))).difference(kept))
    order = keep_order(posed.problem.before, [*kept, *new])
    return _mend(posed.problem, order, crews)


def _mend(
    problem: CoalitionProblem, order: Sequence[int], crews: Mapping[int, list[int]]
) -> CoalitionPlan | None:
    """Return the plan of an order: by the old crews, and who comes first where these lack."""
    gap = problem.links.gap if have_weights(problem.links) else None
    plan, place = empty_plan(problem), problem.origin.astype(np.int64)
    free = problem.ready[place - len(problem.needs)]
    plan.order[:] = order
    doers = dict(crews)  # of linked tasks that are not planned yet, the old ones count
    for task in order:
        if can_miss(problem.misses) and problem.misses.optional[task] and not crews.get(task):
            continue
        comes = np.maximum(free + problem.ways[problem.pace, place, task], problem.release[task])
        linked = [] if gap is None else np.flatnonzero(gap[task] > FREE).tolist()
        taken = {robot for other in linked for robot in doers.get(other, ())}
        crew = _completed(problem, task, doers.get(task, []), taken, comes)
        if crew is None:
            return None
        doers[task] = crew
        plan.size[task], plan.coalition[task, : len(crew)] = len(crew), crew
        who = np.array(crew)
        takes = problem.duration[task] + problem.slower[problem.pace[who], task].max()
        free[who], place[who] = comes[who].max() + takes, task
    return plan


def _completed(
    problem: CoalitionProblem, task: int, crew: Sequence[int], taken: set[int], comes: Ints
) -> list[int] | None:
    """Return a crew with the robots that it lacks, those that come first; None if there are none.

    Of those that are added nobody is spare.
    """
    counts, needs = problem.counts, problem.needs[task]
    kept = [robot for robot in crew if robot not in taken]
    added: list[int] = []
    while (lacking := needs - counts[[*kept, *added]].sum(axis=0)).max() > 0:
        helps = [
            robot
            for robot in range(len(counts))
            if robot not in taken and robot not in kept and robot not in added
            if (counts[robot][lacking > 0] > 0).any()
        ]
        if not helps:
            return None
        added.append(min(helps, key=lambda robot: (comes[robot], robot)))
    return [*kept, *added] if not added else without_spares(counts, needs, [*kept, *added])
