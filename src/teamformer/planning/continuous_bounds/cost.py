"""A lower bound of what plans cost, by the ways of robots and how late these let them be.

Each visit to a task, and each robot at its start, goes on to one other visit or home: an assignment
problem (Carpaneto and Toth 1980). A way from one task to the next costs the travel, and what the
next one is late at least if it comes after the other. Left out is that routes may close in circles,
and that those who do a task wait for one another.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Floats, Ints
from teamformer.planning.continuous_bounds.relaxations import (
    Relaxation,
    bound_by_chains_and_work,
    relax,
)
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.links import (
    COMPLETION,
    FREE,
    MAKESPAN,
    MAX_TARDINESS,
    TARDINESS,
    TRAVEL,
)


class _Ways(NamedTuple):
    """How long the shortest ways take by a robot that can; infinite where none can."""

    between: Floats  # (tasks, tasks)
    first: Floats  # (robots, tasks) from where each robot starts
    home: Floats  # (tasks,)


def least_cost(problem: CoalitionProblem) -> float:
    """Return what no plan costs less than, weighted as the problem says, in ticks."""
    relaxation, weight = relax(problem), problem.links.weight
    ends = relaxation.head + problem.duration
    late = np.maximum(0, ends - problem.due)
    return (
        float(weight[MAKESPAN]) * bound_by_chains_and_work(problem, relaxation)
        + float(weight[MAX_TARDINESS]) * int(late.max(initial=0))
        + float(weight[COMPLETION]) * float(problem.links.task_weight @ ends)
        + _travel_and_tardiness(problem, relaxation)
    )


def _travel_and_tardiness(problem: CoalitionProblem, relaxation: Relaxation) -> float:
    """Return what travel and tardiness together cost at least, each with its weight."""
    from ortools.graph.python.linear_sum_assignment import SimpleLinearSumAssignment

    table = _costs_of_going_on(problem, relaxation)
    goes, on = np.nonzero(np.isfinite(table))
    solver = SimpleLinearSumAssignment()
    whole = np.floor(table[goes, on]).astype(np.int64)
    solver.add_arcs_with_cost(goes.astype(np.int32), on.astype(np.int32), whole)
    is_solved = solver.solve() == SimpleLinearSumAssignment.Status.OPTIMAL
    return float(solver.optimal_cost()) if is_solved else 0.0


def _costs_of_going_on(problem: CoalitionProblem, relaxation: Relaxation) -> Floats:
    """Return (visits + robots, visits + robots) what each costs that goes on to each.

    Rows are the visits, then the robots at their starts; columns the visits, then ways home.
    """
    tasks, robots, weight = len(problem.needs), len(problem.origin), problem.links.weight
    ways, visits = _ways(problem, relaxation), _fewest_visits(problem)
    late = weight[TARDINESS] * problem.links.task_weight / visits  # of each visit

    def costs(leaves: Ints, way: Floats) -> Floats:
        is_way, short = np.isfinite(way), np.where(np.isfinite(way), way, 0.0)
        ends = np.maximum(leaves[:, None] + short, problem.release) + problem.duration
        cost = weight[TRAVEL] * short + late * np.maximum(0, ends - problem.due)
        return np.where(is_way, cost, np.inf)

    ready = problem.ready[problem.origin - tasks]
    task = np.repeat(np.arange(tasks), visits)  # (visits,)
    count = len(task)
    table = np.full((count + robots, count + robots), np.inf)
    table[:count, :count] = costs(relaxation.head + problem.duration, ways.between)[task][:, task]
    table[count:, :count] = costs(ready, ways.first)[:, task]
    table[:count, count:] = (weight[TRAVEL] * ways.home[task])[:, None]
    table[count:, count:] = (weight[TRAVEL] * relaxation.home[problem.kind, problem.origin])[
        :, None
    ]
    return table


def _fewest_visits(problem: CoalitionProblem) -> Ints:
    """Return (tasks,) how many robots come to each at least: some capability takes so many."""
    most = np.maximum(problem.counts.max(axis=0), 1)  # (caps,)
    return np.asarray((-(-problem.needs // most)).max(axis=1), np.int64)


def _ways(problem: CoalitionProblem, relaxation: Relaxation) -> _Ways:
    """Return ways of robots that bring something to both ends."""
    tasks, gap = len(problem.needs), problem.links.gap
    brings = (problem.counts[:, None] > 0) & (problem.needs > 0)  # (robots, tasks, caps)
    able = np.asarray(brings.any(axis=2))
    first = np.where(able, relaxation.ways[problem.pace, problem.origin], np.inf)
    between, home = np.full((tasks, tasks), np.inf), np.full(tasks, np.inf)
    for robot, can in enumerate(able):
        ways = relaxation.ways[problem.pace[robot], :tasks]
        between = np.minimum(between, np.where(can[:, None] & can, ways, np.inf))
        back = relaxation.home[problem.kind[robot], :tasks]
        home = np.minimum(home, np.where(can, back, np.inf))
    np.fill_diagonal(between, np.inf)  # nobody visits a task twice
    if len(gap):  # tasks that are linked are done by different robots
        between[(gap != FREE) | (gap.T != FREE)] = np.inf
    return _Ways(between, first, home)
