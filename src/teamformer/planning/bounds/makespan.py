"""No plan is faster: lower bounds on the makespan, whatever the policy.

Each bound looks at one capability alone. Those of a relaxed problem hold for the step rules too,
whatever `forming_steps` is: forming never brings a robot nearer to a task. `lower_bound` adds the
steps that forming costs before a task can start at all.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from teamformer.arrays import Array, Floats
from teamformer.model import Scenario
from teamformer.planning.bounds.forming import raise_for_forming
from teamformer.planning.bounds.open_paths import LARGEST_EXACT, bound_paths, shortest_path, span
from teamformer.planning.relaxation.problem import (
    Relaxed,
    cells_between,
    in_blocks,
    may_set_down,
    relax,
    steps_from_starts,
    without_directions,
)
from teamformer.planning.steps.team_plan import keep_order
from teamformer.rules.constants import FAR, NOBODY

EFFORT = 4e7
"""Legs looked at in all; about a tenth of a second."""

MOST_ROUNDS = 150
"""More rounds of raising the penalties gain nothing."""

LEFT_OUT = (0.0, 0.5, 0.8)
"""Shares of the tasks, those that can start first, to leave out: far tasks bound better alone."""


def lower_bound(scenario: Scenario) -> int:
    """Return a number of steps in which no policy can complete a scenario faster.

    Tasks that are called off do not count: they need not be done.
    """
    if all(task.cancelled is not None for task in scenario.tasks):
        return 0
    scenario = _without_cancelled(scenario)
    if not may_set_down(scenario):
        problem = relax(scenario, in_table=False)
        return bound_makespan(problem, _behind_others(problem, earliest_formed(scenario, problem)))
    robots = tuple(replace(robot, absences=()) for robot in scenario.robots)
    scenario = replace(scenario, robots=robots)
    problem = relax(scenario, in_table=False)
    is_whole = np.array([task.to is None for task in scenario.tasks])
    start = _behind_others(problem, earliest_formed(scenario, problem))
    return bound_makespan(problem, start, is_whole)


def _behind_others(problem: Relaxed, start: Array) -> Array:
    """Return steps that no task starts before, (tasks,), raised by those that it comes after."""
    for task in keep_order(problem.before, list(range(len(start)))):
        before = problem.before[task][problem.before[task] != NOBODY]
        ends = start[before] + problem.duration[before]
        start[task] = max([start[task], *(ends + 1).tolist()])
    return np.minimum(start, FAR)


def _without_cancelled(scenario: Scenario) -> Scenario:
    gone = {task.name for task in scenario.tasks if task.cancelled is not None}
    if not gone:
        return scenario
    tasks = (
        replace(task, after=tuple(name for name in task.after if name not in gone))
        for task in scenario.tasks
        if task.name not in gone
    )
    return replace(scenario, tasks=tuple(tasks))


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


def earliest_formed(scenario: Scenario, problem: Relaxed) -> Array:
    """Return the first step in which a team that can do it can be at each task, as (tasks,).

    Like `earliest_starts`, with what forming costs.
    """
    walked = earliest_starts(problem._replace(appears=np.full_like(problem.appears, -1)))
    formed = raise_for_forming(scenario, problem, walked)
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
    legs, gained = _legs(problem, able, tasks)
    ready = start[tasks].astype(np.float64) - gained
    duration = problem.duration[tasks].astype(np.float64)
    if len(able) == 1 and len(tasks) <= LARGEST_EXACT:
        return _whole(shortest_path(legs, ready, duration))
    visits = _fewest_robots(problem.counts[able, cap], problem.needs[tasks, cap])
    bounds = [_bound_visits(legs, ready, duration, visits, len(able))]
    rounds = int(np.clip(effort / (len(LEFT_OUT) * len(tasks) ** 2), 2, MOST_ROUNDS))
    by_start = np.argsort(ready, kind="stable")
    for share in LEFT_OUT:
        late = by_start[int(share * len(tasks)) :]
        most = min(len(able), len(late))
        lengths = bound_paths(legs[np.ix_(late, late)], ready[late], most, rounds)
        slowest = (lengths + duration[late].sum()) / np.arange(1, most + 1)
        bounds.append(_whole(slowest.min()))
    return max(bounds)


def _bound_visits(legs: Floats, ready: Floats, duration: Floats, visits: Array, robots: int) -> int:
    """Bound the makespan by all visits that robots have to make, some to one task together.

    One visit of each task, with the leg to it, makes a tree: a leg leads from a task to one that
    starts no sooner. Each further visit costs at least the shortest leg to its task.
    """
    apart = legs + np.where(np.eye(len(ready), dtype=bool), np.inf, 0.0)
    nearest = np.minimum(apart.min(axis=1), ready)  # (places,)
    walked = span(legs, ready) + ((visits - 1) * nearest).sum()
    return _whole((walked + (visits * duration).sum()) / robots)


def one_for_each_place(problem: Relaxed, tasks: Array, start: Array) -> Array:
    """Keep the task that ends last of those in one place, or whose places touch on a plane."""
    by_end = tasks[np.argsort(-(start + problem.duration)[tasks], kind="stable")]
    is_same = cells_between(problem, by_end, by_end) == 0  # (tasks, tasks)
    kept: Array = by_end[_are_apart(is_same)]
    return kept


def _are_apart(is_same: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Choose, in turn, what is not in the same place as anything chosen before, as (tasks,) bool.

    On a plane one place may touch two that do not touch each other.
    """
    is_chosen = np.zeros(len(is_same), np.bool_)
    for task in range(len(is_same)):
        is_chosen[task] = not (is_same[task] & is_chosen).any()
    return is_chosen


def _legs(problem: Relaxed, robots: Array, tasks: Array) -> tuple[Floats, float]:
    """Return times that the legs of these robots are not shorter than, as (tasks, tasks).

    At whole speeds, the steps of the fastest robot, on the ground or in the air. Else the shorter
    way's cells over the highest speed: a robot may do a task in passing, with up to a cell walked
    of the next leg; the steps that gains come second. Where no way is, any time is sound, and the
    longest leg does.
    """
    cells = cells_between(problem, tasks, tasks)
    speed = float(problem.speed[robots].max())
    legs: Floats = problem.steps[np.unique(problem.pace[robots])][:, cells].min(axis=0)
    legs = legs.astype(np.float64)
    is_way, gained = legs < FAR, 0.0
    if (problem.speed[robots] % 1 != 0).any():
        legs[is_way] = problem.lengths[:, cells[is_way]].min(axis=0) / speed
        gained = 1 / speed
    legs[~is_way] = legs[is_way].max()
    return legs, gained


def _fewest_robots(counts: Array, needs: Array) -> Array:
    """Return how many robots at least bring what is needed, as (tasks,)."""
    most = np.sort(counts)[::-1].cumsum()
    fewest: Array = 1 + np.searchsorted(most, needs)
    return fewest


def _whole(steps: float) -> int:
    return math.ceil(steps - 1e-6)
