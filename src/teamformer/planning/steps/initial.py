"""First plans with forming counted: complete crews that share the tour out and keep together."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.planning.problem.coalition_plan import CoalitionPlan, plan_of_lists
from teamformer.planning.problem.relaxed_problem import Relaxed, walked_cells
from teamformer.world.rules.constants import FAR
from teamformer.world.rules.tour import shortest_tour


def crew_plans(problem: Relaxed) -> list[CoalitionPlan]:
    """Return a plan for the most complete crews, for half as many, and so on down to one."""
    tasks = len(problem.appears)
    cells = walked_cells(problem)
    between = cells[:, :tasks].astype(np.int64)
    between = np.minimum(between, between.T)
    from_start = np.sort(cells[:, tasks:], axis=1)[:, (len(problem.pace) - 1) // 2]
    tour = shortest_tour(between, from_start.astype(np.int64))
    plans, crews = [], _deal(problem)
    number = len(crews)
    while number > 0:
        plans.append(_share_out(problem, tour, crews[:number]))
        number //= 2
    return plans


def _deal(problem: Relaxed) -> list[list[int]]:
    """Deal the robots out into crews that can do every task, and one of those left over."""
    demand, left = problem.needs.max(axis=0), list(range(len(problem.pace)))
    crews: list[list[int]] = []
    while left:
        crew, lacking = [], demand.astype(np.int64).copy()
        for robot in list(left):
            if (np.minimum(problem.counts[robot], lacking) > 0).any():
                crew.append(robot)
                left.remove(robot)
                lacking = np.maximum(lacking - problem.counts[robot], 0)
        if lacking.any():
            return crews or [list(range(len(problem.pace)))]
        crews.append(crew)
    return crews


def _share_out(problem: Relaxed, tour: Array, crews: list[list[int]]) -> CoalitionPlan:
    """Give each crew a stretch of the tour; what it cannot do, everybody who can comes to."""
    parts = np.array_split(tour, len(crews))
    chosen: list[list[int]] = [[] for _ in tour]
    turn = np.zeros(len(tour))
    for crew, part in zip(crews, parts, strict=True):
        for position, task in enumerate(part.tolist()):
            turn[task] = position
            chosen[task] = _able_crew(problem, task, crew)
    return plan_of_lists(np.argsort(turn, kind="stable").tolist(), chosen)


def _able_crew(problem: Relaxed, task: int, crew: list[int]) -> list[int]:
    """Return the robots of a crew that can get to a task, with others if these are too few."""
    starts = problem.cells[task, len(problem.appears) :]
    can_come = problem.steps[problem.pace, starts] + problem.duration[task] < problem.lost
    can_come &= problem.steps[problem.pace, starts] < FAR
    coming = [robot for robot in crew if can_come[robot]]
    lacking = problem.needs[task] - problem.counts[coming].sum(axis=0, dtype=np.int64)
    by_way = np.argsort(starts, kind="stable").tolist()
    for robot in by_way:
        if (lacking <= 0).all():
            break
        brings = (np.minimum(problem.counts[robot], lacking) > 0).any()
        if brings and robot not in coming and can_come[robot]:
            coming.append(robot)
            lacking = lacking - problem.counts[robot]
    return coming
