"""Lower bounds by when tasks can start, for missions in steps.

Tours of the robots with a capability narrow the steps in which tasks start. A task that needs
several capabilities starts when all of these are there, so each narrows the others. For missions
in continuous time `continuous_bounds/makespan.py` does the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from teamformer.base.array_types import Array
from teamformer.mission.model import Mission
from teamformer.planning.bounds.earliest import earliest_in_order
from teamformer.planning.bounds.forming import steps_of_forming
from teamformer.planning.bounds.legs import least_legs, one_for_each_place
from teamformer.planning.bounds.refutation import (
    MOST_TASKS_A_TOUR,
    Chains,
    Detours,
    Refuter,
    Tours,
    tours_through,
)
from teamformer.planning.problem.relaxed_problem import (
    Relaxed,
    cells_between,
    may_set_down,
    steps_from_starts,
    without_directions,
)
from teamformer.world.rules.constants import FAR, NOBODY

IN_ONE_PLACE = 4
"""So many times the tasks of a tour are looked at to find enough that are not in one place."""

HALVINGS = (0, 1, 4, 16)
"""How many windows are halved to refute a makespan, in turn; more hardly refute more."""


def raise_by_windows(
    mission: Mission,
    problem: Relaxed,
    bound: int,
    offer: Callable[[int], None],
    is_over: Callable[[], bool],
) -> int:
    """Raise a lower bound on the makespan of any policy, and return the best one.

    `problem` is the mission's, of which no task is called off. Bounds are offered as they are
    proven.
    """
    if may_set_down(mission) or is_over():
        return bound
    start = earliest_in_order(mission, problem)
    refuter = refuter_in_steps(mission, problem, start, MOST_TASKS_A_TOUR, is_over)
    for halvings in HALVINGS:
        bound = refuter.raised(bound, halvings)
        offer(bound)
    return bound


def refuter_in_steps(
    mission: Mission,
    problem: Relaxed,
    start: Array,
    most: int,
    is_over: Callable[[], bool] = lambda: False,
) -> Refuter:
    """Return a refuter of makespans in steps, by tours of so many tasks at most.

    No task starts before `start` (tasks,); what can never be done refutes nothing.
    """
    is_possible = start < FAR
    head = np.where(is_possible, start, 0).astype(np.int64)
    duration = np.where(is_possible, problem.duration, 0).astype(np.int64)
    chains = Chains(head, duration, np.zeros_like(head), problem.before)
    keeps_robots = not any(r.absences or r.breaks or r.battery for r in mission.robots)
    forming = steps_of_forming(mission) if keeps_robots else 0  # who is lost parts without a split
    problem = without_directions(problem)
    tours = list(_tours(problem, start, duration, most))
    if forming:
        toured = np.unique(np.concatenate([np.zeros(0, np.int64), *(t.tasks for _, t in tours)]))
        tours = [(cap, _with_detours(problem, cap, one, toured)) for cap, one in tours]
    return Refuter(chains, [one for _, one in tours], is_over, forming)


def _tours(
    problem: Relaxed, start: Array, duration: Array, most: int
) -> Iterator[tuple[int, Tours]]:
    """Yield capabilities, and the tours of the robots with each.

    A robot that does not walk whole cells in every step may do a task in passing, and so be sooner
    at the next one than the way takes: its capabilities are left out.
    """
    for cap, robots in enumerate(problem.able):
        able = robots[robots != NOBODY]
        tasks = np.flatnonzero((start < FAR) & (problem.needs[:, cap] > 0))
        if len(tasks) and (problem.speed[able] % 1 == 0).all():
            urgent = np.argsort(-(start + duration)[tasks], kind="stable")[: IN_ONE_PLACE * most]
            tasks = one_for_each_place(problem, tasks[urgent], start)
            legs, _ = least_legs(problem, able, tasks)  # nobody gains steps in passing
            ways = legs.astype(np.int64)
            yield cap, tours_through(start + duration, tasks, ways, duration, len(able), most)


def _with_detours(problem: Relaxed, cap: int, tours: Tours, toured: Array) -> Tours:
    """Return tours with what the only robot with a capability could come by, if there is one."""
    robots, others = problem.able[cap], toured[problem.needs[toured, cap] == 0]
    if tours.robots > 1:
        return tours
    pace = problem.steps[problem.pace[robots[0]]]
    ways = pace[cells_between(problem, others, tours.tasks)].T.astype(np.int64)
    begin = steps_from_starts(problem, others)[:, robots[0]].astype(np.int64)
    return tours._replace(detours=Detours(others, ways, begin))
