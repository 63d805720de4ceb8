"""First plans for the search: what crews would do, what robots that join freely would, the old."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.planning.crews.deal import deal_crews
from teamformer.planning.crews.routes import Shared, bits_of
from teamformer.planning.problem.coalition_plan import CoalitionPlan, plan_of_lists
from teamformer.planning.problem.misses import can_miss
from teamformer.planning.problem.relaxed_problem import (
    Relaxed,
    has_prices,
    steps_from_starts,
    walked_cells,
)
from teamformer.planning.relaxation.threshold import ThresholdSearch
from teamformer.world.rules.constants import FAR, NOBODY


def plan_from_crews(problem: Relaxed, company: Array, rounds: int) -> CoalitionPlan:
    """Return what crews do, who meet at their tasks and go on together.

    `company` (robots,) is the lowest robot of the team that each is in; `rounds` is how many
    changes the planner of crews tries.
    """
    shared = _shared(problem, company)
    crew = np.full(len(problem.pace), NOBODY, np.int64)
    task_crew = np.full(len(problem.appears), NOBODY, np.int64)
    sequence = deal_crews(shared, crew, task_crew, rounds)
    parties: list[list[set[int]]] = [[] for _ in range(int(crew.max()) + 1)]
    for leader in np.unique(company).tolist():
        together = np.flatnonzero(company == leader)
        for number in np.unique(crew[together]).tolist():
            parties[number].append(set(together[crew[together] == number].tolist()))
    coalitions: list[list[int]] = [[] for _ in task_crew]
    brings = problem.counts > 0  # (robots, caps)
    for task in sequence.tolist():
        needed = problem.needs[task] > 0  # (caps,)
        of_crew = parties[int(task_crew[task])]
        helpers = [party for party in of_crew if (brings[list(party)] & needed).any()]
        united = set[int]().union(*helpers)
        parties[int(task_crew[task])] = [p for p in of_crew if p not in helpers] + [united]
        coalitions[task] = sorted(united)
    if len(problem.lengths) > 1:  # crews know nothing of who flies
        return complete_plan(problem, sequence.tolist(), coalitions)
    return plan_of_lists(sequence.tolist(), coalitions)


def _shared(problem: Relaxed, company: Array) -> Shared:
    """Return what the planner of crews goes by."""
    tasks = len(problem.appears)
    if len(problem.cells):
        no_way = problem.steps.shape[1] - 1
        task_region, robot_region = _regions(problem.cells < no_way)
    else:  # a grid without walls is one region
        task_region, robot_region = np.zeros(tasks, np.int64), np.zeros(len(company), np.int64)
    slowness, walked = 1 / problem.speed, problem.lengths[0]  # (ways,) cells on the ground
    return Shared(
        np.int64(problem.appears.min()),
        problem.appears.astype(np.int64),
        walked_cells(problem),
        problem.spots,
        problem.goals,
        slowness,
        problem.counts.astype(np.int64),
        problem.needs.astype(np.int64),
        bits_of(problem.needs),
        (problem.duration - problem.quickest).astype(np.int64),
        walked[problem.carry].astype(np.int64),
        robot_region,
        task_region,
        tasks + company.astype(np.int64),
        problem.ready.astype(np.int64),
        company.astype(np.int64),
    )


def _regions(is_way: Array) -> tuple[Array, Array]:
    """Return the connected part of the map of each task and robot; `is_way` (tasks, places)."""
    tasks = len(is_way)
    first = np.argmax(is_way[:, :tasks], axis=1)  # the lowest task in the same part
    parts, task_region = np.unique(first, return_inverse=True)
    robot_region = np.full(is_way.shape[1] - tasks, len(parts), np.int64)
    for part, task in enumerate(parts):
        robot_region[is_way[task, tasks:]] = part
    return task_region.astype(np.int64), robot_region


def plan_from_coalitions(problem: Relaxed, rounds: int, seed: int = 0) -> CoalitionPlan | None:
    """Return coalitions that are good where joining is free, by the cost if plans have one."""
    search = ThresholdSearch(problem, seed)
    if has_prices(problem):
        search.go_by_price()
    search.run(rounds)
    return search.best


def complete_plan(
    problem: Relaxed, order: Sequence[int], coalitions: Sequence[Sequence[int]]
) -> CoalitionPlan:
    """Return a plan in which each coalition that lacks something gets the nearest who bring it.

    `order` holds all tasks; `coalitions` has robots for each, by number. Optional tasks for nobody
    are left out.
    """
    may_miss = can_miss(problem.misses)
    chosen = [
        []
        if may_miss and problem.misses.optional[task] and not coalition
        else _complete(problem, task, list(coalition))
        for task, coalition in enumerate(coalitions)
    ]
    return plan_of_lists(order, chosen)


def _complete(problem: Relaxed, task: int, coalition: list[int]) -> list[int]:
    ways = steps_from_starts(problem, np.array([task]))[0]  # (robots,)
    coalition = [robot for robot in coalition if ways[robot] < FAR]
    lacking = problem.needs[task] - problem.counts[coalition].sum(axis=0, dtype=np.int64)
    if not (lacking > 0).any():
        return coalition
    for robot in np.argsort(ways, kind="stable").tolist():
        brings = (np.minimum(problem.counts[robot], lacking) > 0).any()
        if brings and robot not in coalition and ways[robot] < FAR:
            coalition.append(robot)
            lacking = lacking - problem.counts[robot]
    return coalition
