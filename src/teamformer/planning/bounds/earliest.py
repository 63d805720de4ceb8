"""The first steps in which tasks can start, whatever the policy."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.model import Mission
from teamformer.planning.bounds.forming import raise_for_forming
from teamformer.planning.problem.coalition_plan import keep_order
from teamformer.planning.problem.relaxed_problem import Relaxed, in_blocks, steps_from_starts
from teamformer.world.rules.constants import FAR, NOBODY


def earliest_in_order(mission: Mission, problem: Relaxed) -> Array:
    """Return the same as `earliest_formed`, raised by the tasks that each comes after."""
    start = earliest_formed(mission, problem)
    for task in keep_order(problem.before, list(range(len(start)))):
        before = problem.before[task][problem.before[task] != NOBODY]
        ends = start[before] + problem.duration[before]
        start[task] = max([start[task], *(ends + 1).tolist()])
    return np.minimum(start, FAR)


def earliest_formed(mission: Mission, problem: Relaxed) -> Array:
    """Return the first step in which a team that can do it can be at each task, as (tasks,).

    Like `earliest_starts`, with what forming costs.
    """
    walked = earliest_starts(problem._replace(appears=np.full_like(problem.appears, -1)))
    formed = raise_for_forming(mission, problem, walked)
    return np.maximum(earliest_starts(problem), formed)


def earliest_starts(problem: Relaxed) -> Array:
    """Return the first step in which enough of each capability can be at each task, as (tasks,).

    FAR where there will never be enough. Sound because a robot takes at least the steps of the
    direct way from its start, and is missing from the step it is lost.
    """
    start = problem.appears.astype(np.int64) + 1
    for tasks in in_blocks(np.arange(len(start)), len(problem.pace)):
        start[tasks] = _starts_of(problem, tasks)
    return start


def _starts_of(problem: Relaxed, tasks: Array) -> Array:
    """Return the same of some tasks."""
    start, needs = problem.appears[tasks].astype(np.int64) + 1, problem.needs[tasks]
    arrive = np.maximum(steps_from_starts(problem, tasks), start[:, None])  # (tasks, robots)
    arrive[arrive + problem.duration[tasks, None] >= problem.lost] = FAR
    for cap, robots in enumerate(problem.able):
        able = robots[robots != NOBODY]
        if len(able) == 0:
            continue  # nobody has it, so nobody needs it
        queue = np.argsort(arrive[:, able], axis=1)  # (tasks, able)
        brought = problem.counts[able, cap][queue].cumsum(axis=1)  # (tasks, able)
        last = (brought < needs[:, [cap]]).sum(axis=1)  # (tasks,) place in the queue
        in_turn = np.take_along_axis(arrive[:, able], queue, axis=1)  # (tasks, able)
        is_needed = needs[:, cap] > 0
        start[is_needed] = np.maximum(start, in_turn[np.arange(len(start)), last])[is_needed]
    return start
