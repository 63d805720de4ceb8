"""The relaxed problem: what is left of a scenario when robots join and split at no cost.

Every robot goes its own way from task to task. A task starts at a step not before `appears + 1` and
not before every robot of its coalition is there; it ends `duration` steps later, and its coalition
stays until then. A coalition is any set of robots that together have what the task needs. A robot
that stays in one place may serve all tasks there at once, as a team does. A robot lost at step l
serves only tasks that end before l; one that comes back counts as always there. The makespan is the
last end.

A load ends elsewhere than it begins: the way from its task begins where it is brought to, so ways
differ by direction. Its duration counts the least steps that a team that can do it carries it, and
its unloading.

On a plane, ways are counted in cells that are a small fraction of a step long. They are counted
from the edge of one place to the edge of the next, so that tasks whose places touch are in the same
place here, and in favour of the robots, so that no plan under the rules is faster.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.capabilities import Counts
from teamformer.grid import Grid, Place
from teamformer.mission.rules import opening_step
from teamformer.model import Robot, Scenario, Task
from teamformer.plane import Plane
from teamformer.rules.constants import FAR, MICROMETRES, NOBODY, ROUNDING
from teamformer.rules.distances import UNREACHABLE, straight_ways, travel_matrix

Whole = npt.NDArray[np.int32]

SHORTEST_CELL = 1e-4  # metres
MOST_CELLS = 200_000
"""Of a plane: how long a cell is, and how many the longest way has at most."""


class Relaxed(NamedTuple):
    """The relaxed problem as plain arrays; times are in steps."""

    cells: (
        Whole  # (tasks, places) from places to tasks; places are the tasks' ends, then the starts
    )
    steps: Whole  # (paces, cells) steps that 0, 1, ... cells take; last column: no way, FAR
    pace: Whole  # (robots,) row of `steps`
    speed: npt.NDArray[np.float64]  # (robots,) cells a step
    counts: Whole  # (robots, caps)
    needs: Whole  # (tasks, caps)
    able: Whole  # (caps, robots) numbers of the robots with each capability, then NOBODY
    duration: Whole  # (tasks,)
    appears: Whole  # (tasks,) steps made when the task becomes known
    lost: Whole  # (robots,) first step the robot is missing from; FAR for never
    ready: Whole  # (robots,) the step from which the robot is free; 0 at the start
    carry: Whole  # (tasks,) cells that a load is carried; 0 for other tasks
    quickest: Whole  # (tasks,) steps that this takes at least, which `duration` counts


class Future(NamedTuple):
    """What will happen, in steps."""

    appears: Whole  # (tasks,) as in Relaxed
    lost: Whole  # (robots,) as in Relaxed


def relax(scenario: Scenario) -> Relaxed:
    """Return the relaxed problem of a scenario."""
    future = future_of(scenario)
    return relax_ways(
        scenario,
        scenario.tasks,
        scenario.robots,
        *_ways(scenario),
        future,
        ready=np.zeros(len(scenario.robots), dtype=np.int32),
    )


def relax_ways(
    scenario: Scenario,
    tasks: Sequence[Task],
    robots: Sequence[Robot],
    cells: Whole,
    speed: npt.NDArray[np.float64],
    future: Future,
    ready: Whole,
) -> Relaxed:
    """Return the relaxed problem of some tasks and robots of a scenario.

    `cells` are the ways from the ends of tasks and from starts to tasks, (tasks, places), and
    `speed` (robots,) is what robots walk of them in a step.
    """
    no_way = 1 + int(cells[cells < UNREACHABLE].max())
    speeds, pace = np.unique(speed, return_inverse=True)
    counts = count_table([robot.can for robot in robots], scenario)
    needs = count_table([task.needs for task in tasks], scenario)
    steps = steps_of_cells(speeds, no_way)
    cells = np.ascontiguousarray(np.minimum(cells, no_way))
    carry = cells.diagonal().copy()
    np.fill_diagonal(cells, 0)  # which is not the way from a task's end to its beginning
    quickest = steps[[fastest_pace(counts, pace, need) for need in needs], carry]
    duration = np.array([task.duration + task.unload for task in tasks], np.int32)
    return Relaxed(
        cells=cells,
        steps=steps,
        pace=pace.astype(np.int32),
        speed=speed,
        counts=counts,
        needs=needs,
        able=able_robots(counts),
        duration=duration + quickest,
        appears=future.appears,
        lost=future.lost,
        ready=ready,
        carry=carry,
        quickest=quickest,
    )


def fastest_pace(counts: Whole, pace: npt.NDArray[np.intp], need: Whole) -> int:
    """Return the pace at which a team goes at most that has what is needed; 0 if none has it."""
    paces = range(int(pace.max()), 0, -1)
    return next((p for p in paces if (counts[pace >= p].sum(axis=0) >= need).all()), 0)


def ends_of(tasks: Sequence[Task]) -> list[Place]:
    """Return where robots are once they have done each task."""
    return [task.at if task.to is None else task.to for task in tasks]


def without_directions(problem: Relaxed) -> Relaxed:
    """Return a problem whose ways between tasks are as short as the shorter of both directions.

    So they are no longer, whoever goes which way.
    """
    if not problem.carry.any():
        return problem
    cells, tasks = problem.cells.copy(), len(problem.cells)
    cells[:, :tasks] = np.minimum(cells[:, :tasks], cells[:, :tasks].T)
    return problem._replace(cells=cells)


def future_of(scenario: Scenario) -> Future:
    """Return when tasks may begin and robots are missing."""
    return Future(
        appears=np.array([opening_step(task) for task in scenario.tasks], dtype=np.int32),
        lost=np.array([_lost_for_good(robot) for robot in scenario.robots], dtype=np.int32),
    )


def _lost_for_good(robot: Robot) -> int:
    """Return the step that a robot is missing from; one that comes back counts as always there."""
    return FAR if robot.lost_for_good is None else robot.lost_for_good


def may_set_down(scenario: Scenario) -> bool:
    """Say whether loads may be set down on their way, so that several teams bring them by turns.

    Then robots that will be lost help with what ends later, and nobody has to go all the way: a
    relaxed schedule bounds nothing.
    """
    has_losses = any(robot.absences for robot in scenario.robots)
    return has_losses and any(task.to is not None for task in scenario.tasks)


def is_true_relaxation(problem: Relaxed) -> bool:
    """Say whether no plan under the rules is faster than the best relaxed one.

    So it is on planes, and if all speeds are whole numbers. At 0.5 cells a step a robot on its way
    stands in each cell for two steps, and a task that appears there in the second costs it nothing;
    and at 0.8 two legs of a cell take 2 + 2 steps, but two cells at a stretch 3.
    """
    return bool((problem.speed % 1 == 0).all())


def _ways(scenario: Scenario) -> tuple[Whole, npt.NDArray[np.float64]]:
    """Return the cells from places to tasks, (tasks, places), and what robots walk in a step."""
    tasks, speed = [t.at for t in scenario.tasks], np.array([r.speed for r in scenario.robots])
    places = ends_of(scenario.tasks) + [robot.at for robot in scenario.robots]
    if isinstance(scenario.world, Grid):
        return travel_matrix(scenario.world, places, tasks).T, speed
    assert isinstance(scenario.world, Plane)
    pace = _most_walked(scenario.world, speed, scenario.forming_steps)
    touching = np.where(np.arange(len(places)) < len(tasks), 2, 1) * scenario.world.arrival_radius
    metres = straight_ways(tasks, places) * (1 - 1 / (MICROMETRES * pace.min())) - touching
    cell = max(SHORTEST_CELL, float(metres.max()) / MOST_CELLS)
    cells = np.floor(np.maximum(metres, 0.0) / cell).astype(np.int32)
    return cells, np.ceil(pace / cell - ROUNDING)


def _most_walked(
    plane: Plane, speed: npt.NDArray[np.float64], forming_steps: int
) -> npt.NDArray[np.float64]:
    """Return how many metres each robot gets on in a step at most.

    A join puts the joiner where its partner is, which may be the arrival radius away; robots walk
    in that step too where forming costs none.
    """
    pace: npt.NDArray[np.float64] = speed * plane.step
    if forming_steps == 0:
        return pace + plane.arrival_radius
    return np.maximum(pace, plane.arrival_radius)


def steps_of_cells(speeds: npt.NDArray[np.float64], no_way: int) -> Whole:
    """Return the steps that 0, 1, ... cells take at each speed, (paces, no_way + 1)."""
    steps = np.ceil(np.arange(no_way + 1) / speeds[:, None] - ROUNDING)  # (paces, cells)
    steps[:, no_way] = FAR
    return np.minimum(steps, FAR).astype(np.int32)


def count_table(parts: Sequence[Counts], scenario: Scenario) -> Whole:
    """Return how much each part has of each capability, (parts, caps), in units."""
    rows = (scenario.in_units(part) for part in parts)
    return np.array([[row.get(cap, 0) for cap in scenario.capabilities] for row in rows], np.int32)


def least_brought(counts: Whole) -> Whole:
    """Return the least that a robot brings of each capability, (caps,); FAR where nobody does."""
    least: Whole = np.where(counts > 0, counts, FAR).min(axis=0).astype(np.int32)
    return least


def most_in_coalitions(problem: Relaxed) -> Whole:
    """Return how many robots are in a coalition that can spare nobody at most, (tasks,).

    Of each capability so many that they have enough whatever each of them brings.
    """
    robots = -(-problem.needs // least_brought(problem.counts))  # (tasks, caps)
    most: Whole = np.minimum(robots.sum(axis=1), len(problem.pace))
    return most


def able_robots(counts: Whole) -> Whole:
    """Return the robots with each capability, (caps, robots), then NOBODY."""
    able = np.full(counts.T.shape, NOBODY, dtype=np.int32)
    for row, count in zip(able, counts.T, strict=True):
        row[: np.count_nonzero(count)] = np.flatnonzero(count)
    return able
