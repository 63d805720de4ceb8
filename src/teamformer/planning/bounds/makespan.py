"""No plan is faster: lower bounds on the makespan, whatever the policy.

Each bound of a relaxed problem looks at one capability alone. It holds for the step rules too,
whatever `forming_steps` is: forming never brings a robot nearer to a task. `lower_bound` also
counts the steps that forming costs before a task can start at all and, by windows, that tasks of
several capabilities start when all of these are there.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Array, Floats
from teamformer.mission.model import Mission, as_believed
from teamformer.planning.bounds.earliest import earliest_in_order, earliest_starts
from teamformer.planning.bounds.legs import least_legs, one_for_each_place
from teamformer.planning.bounds.open_paths import bound_paths, span
from teamformer.planning.bounds.start_windows import refuter_in_steps
from teamformer.planning.problem.relaxed_problem import (
    Relaxed,
    may_set_down,
    relax,
    without_directions,
)
from teamformer.world.rules.constants import FAR, NOBODY

EFFORT = 1.3e7
"""Legs looked at in all; about a tenth of a second."""

TASKS_A_TOUR, FEW_TOURS = 12, 8
"""Tours of so many tasks each are quick if there are few. With three times as many tours each has a
task less, which makes it three times as quick."""

MOST_ROUNDS = 150
"""More rounds of raising the penalties gain nothing."""


def lower_bound(mission: Mission) -> int:
    """Return a number of steps in which no policy can complete a mission faster.

    Tasks that are called off and optional ones do not count: they need not be done.
    """
    mission = _that_must_be_done(mission)
    if not mission.tasks:
        return 0
    if not may_set_down(mission):
        problem = relax(mission, in_table=False)
        start = earliest_in_order(mission, problem)
        bound = bound_makespan(problem, start)
        refuter = refuter_in_steps(mission, problem, start, _tasks_a_tour(problem))
        return refuter.raised(bound)
    robots = tuple(replace(robot, absences=()) for robot in mission.robots)
    mission = as_believed(mission, robots=robots)
    problem = relax(mission, in_table=False)
    is_whole = np.array([task.to is None for task in mission.tasks])
    return bound_makespan(problem, earliest_in_order(mission, problem), is_whole)


def _tasks_a_tour(problem: Relaxed) -> int:
    """Return the most tasks of a tour that take about a tenth of a second, all tours together."""
    more = max(1.0, len(problem.able) / FEW_TOURS)
    return TASKS_A_TOUR - round(math.log(more, 3))


def _that_must_be_done(mission: Mission) -> Mission:
    """Return a mission with those tasks only that have to be done."""
    gone = {t.name for t in mission.tasks if t.cancelled is not None or t.optional}
    if not gone:
        return mission
    tasks = (
        replace(task, after=tuple(name for name in task.after if name not in gone))
        for task in mission.tasks
        if task.name not in gone
    )
    return as_believed(mission, tasks=tuple(tasks))


def bound_makespan(
    problem: Relaxed,
    start: Array | None = None,
    is_whole: npt.NDArray[np.bool_] | None = None,
) -> int:
    """Return a lower bound on the makespan of a relaxed problem, and of any plan by the rules.

    `start` (tasks,), if given, is a step that no task starts before. `is_whole` (tasks,) says which
    tasks are done from their beginning to their end by one team; without it all are.
    """
    start = earliest_starts(problem) if start is None else start
    problem = without_directions(problem)
    is_possible = start < FAR  # what can never be done bounds nothing
    bounds = (start + problem.duration)[is_possible].tolist()
    caps = np.flatnonzero(problem.needs[is_possible].any(axis=0)).tolist()
    for cap in caps:
        is_on_paths = is_possible if is_whole is None else is_possible & is_whole
        tasks = np.flatnonzero(is_on_paths & (problem.needs[:, cap] > 0))
        if len(tasks) == 0:
            continue
        bounds.append(_bound_capability(problem, cap, tasks, start, EFFORT / len(caps)))
    return max(bounds, default=0)


def _bound_capability(problem: Relaxed, cap: int, tasks: Array, start: Array, effort: float) -> int:
    """Bound the makespan by what the robots with one capability have to walk.

    One task stands for each place: fewer tasks take no longer, and tasks in one place may be done
    together. For each task choose one robot of its coalition that has the capability; these choices
    cut the tasks into one path for each of u robots. A robot ends its path no sooner than
    the start of its first task, its legs and its services together, so the slowest of u robots
    ends no sooner than the mean; and u is unknown, so the least mean counts.
    """
    tasks = one_for_each_place(problem, tasks, start)
    able = problem.able[cap][problem.able[cap] != NOBODY]
    legs, gained = least_legs(problem, able, tasks)
    ready = start[tasks].astype(np.float64) - gained
    duration = problem.duration[tasks].astype(np.float64)
    visits = _fewest_robots(problem.counts[able, cap], problem.needs[tasks, cap])
    most = min(len(able), len(tasks))
    rounds = int(np.clip(effort / len(tasks) ** 2, 2, MOST_ROUNDS))
    lengths = bound_paths(legs, ready, most, rounds)
    slowest = (lengths + duration.sum()) / np.arange(1, most + 1)
    shared = _bound_visits(legs, ready, duration, visits, len(able))
    return max(shared, _whole(slowest.min()))


def _bound_visits(legs: Floats, ready: Floats, duration: Floats, visits: Array, robots: int) -> int:
    """Bound the makespan by all visits that robots have to make, some to one task together.

    One visit of each task, with the leg to it, makes a tree: a leg leads from a task to one that
    starts no sooner. Each further visit costs at least the shortest leg to its task.
    """
    apart = legs + np.where(np.eye(len(ready), dtype=bool), np.inf, 0.0)
    nearest = np.minimum(apart.min(axis=1), ready)  # (places,)
    walked = span(legs, ready) + ((visits - 1) * nearest).sum()
    return _whole((walked + (visits * duration).sum()) / robots)


def _fewest_robots(counts: Array, needs: Array) -> Array:
    """Return how many robots at least bring what is needed, as (tasks,)."""
    most = np.sort(counts)[::-1].cumsum()
    fewest: Array = 1 + np.searchsorted(most, needs)
    return fewest


def _whole(steps: float) -> int:
    return math.ceil(steps - 1e-6)
