"""The relaxed problem: what is left of a scenario when robots join and split at no cost.

Every robot goes its own way from task to task. A task starts at a step not before `appears + 1` and
not before every robot of its coalition is there; it ends `duration` steps later, and its coalition
stays until then. A coalition is any set of robots that together have what the task needs. A robot
that stays in one place may serve all tasks there at once, as a team does. A robot lost at step l
serves only tasks that end before l; one that comes back counts as always there. The makespan is the
last end.

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
from teamformer.jit import kernel
from teamformer.mission.rules import opening_step
from teamformer.model import Robot, Scenario
from teamformer.plane import Plane
from teamformer.planning.prices import Prices, prices_of
from teamformer.rules.constants import FAR, MICROMETRES, NOBODY, ROUNDING
from teamformer.rules.distances import UNREACHABLE, straight_ways, travel_matrix

Whole = npt.NDArray[np.int32]

SHORTEST_CELL = 1e-4  # metres
MOST_CELLS = 200_000
"""Of a plane: how long a cell is, and how many the longest way has at most."""


class Relaxed(NamedTuple):
    """The relaxed problem as plain arrays; times are in steps."""

    cells: Whole  # (tasks, places) ways from places to tasks, as column of `steps` and `lengths`;
    # without walls to fly over that is their cells; places are the tasks, then the starts
    lengths: Whole  # (movers, ways) cells on the ground and, if some robots fly over walls, in the
    # air; last column, and where there is none on the ground: more than any way has
    steps: Whole  # (paces, ways) steps that ways take; last column, and where there is none: FAR
    pace: Whole  # (robots,) row of `steps`: by speed, first those on the ground, then in the air
    speed: npt.NDArray[np.float64]  # (robots,) cells a step
    counts: Whole  # (robots, caps)
    needs: Whole  # (tasks, caps)
    able: Whole  # (caps, robots) numbers of the robots with each capability, then NOBODY
    duration: Whole  # (tasks,)
    appears: Whole  # (tasks,) steps made when the task becomes known
    lost: Whole  # (robots,) first step the robot is missing from; FAR for never
    ready: Whole  # (robots,) the step from which the robot is free; 0 at the start
    prices: Prices  # what plans in steps are searched by besides the makespan


class Future(NamedTuple):
    """What will happen, in steps."""

    appears: Whole  # (tasks,) as in Relaxed
    lost: Whole  # (robots,) as in Relaxed


def relax(scenario: Scenario) -> Relaxed:
    """Return the relaxed problem of a scenario."""
    robots, tasks = scenario.robots, scenario.tasks
    walked, speed = _ways(scenario)
    places = [*(task.at for task in tasks), *(robot.at for robot in robots)]
    cells, lengths = number_ways(walked, flights(scenario, places[: len(tasks)], places))
    speeds, rank = np.unique(speed, return_inverse=True)
    future = future_of(scenario)
    counts = count_table([robot.can for robot in robots], scenario)
    return Relaxed(
        cells=cells,
        lengths=lengths,
        steps=steps_of_ways(speeds, lengths),
        pace=paces_of(rank, robots, lengths),
        speed=speed,
        counts=counts,
        needs=count_table([task.needs for task in tasks], scenario),
        able=able_robots(counts),
        duration=np.array([task.duration for task in tasks], dtype=np.int32),
        appears=future.appears,
        lost=future.lost,
        ready=np.zeros(len(robots), dtype=np.int32),
        prices=prices_of(scenario, tasks),
    )


def future_of(scenario: Scenario) -> Future:
    """Return when tasks may begin and robots are missing."""
    return Future(
        appears=np.array([opening_step(task) for task in scenario.tasks], dtype=np.int32),
        lost=np.array([_lost_for_good(robot) for robot in scenario.robots], dtype=np.int32),
    )


def _lost_for_good(robot: Robot) -> int:
    """Return the step that a robot is missing from; one that comes back counts as always there."""
    return FAR if robot.lost_for_good is None else robot.lost_for_good


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
    places = tasks + [robot.at for robot in scenario.robots]
    if isinstance(scenario.world, Grid):
        return travel_matrix(scenario.world, places, tasks).T, speed
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


def flights(scenario: Scenario, goals: Sequence[Place], places: Sequence[Place]) -> Whole | None:
    """Return the cells from places to goals in the air, (goals, places).

    None if nobody flies, or nothing is in the way, so that all ways are as on the ground.
    """
    if not scenario.world.rows or not any(robot.flies for robot in scenario.robots):
        return None
    apart = np.reshape(goals, (-1, 1, 2)) - np.reshape(places, (1, -1, 2))  # (goals, places, 2)
    cells: Whole = np.abs(apart).sum(axis=2).astype(np.int32)
    return cells


def number_ways(walked: Whole, flown: Whole | None) -> tuple[Whole, Whole]:
    """Return the number of each way, and the cells of the ways by number, (movers, ways).

    If nobody flies the number of a way is its cells. Else ways that are equally long, walked and
    flown, have one number: 0 if they lead nowhere, and less if they are shorter on the ground.
    """
    longest = int(walked[walked < UNREACHABLE].max())
    if flown is None:
        no_way = 1 + longest
        cells: Whole = np.ascontiguousarray(np.minimum(walked, no_way))
        return cells, np.arange(no_way + 1, dtype=np.int32)[None]
    no_way = 1 + max(longest, int(flown.max()))
    pairs = np.stack([np.minimum(walked, no_way), flown]).reshape(2, -1)  # (movers, ways)
    kinds, number = np.unique(pairs, axis=1, return_inverse=True)
    lengths = np.append(kinds, [[no_way], [no_way]], axis=1).astype(np.int32)
    return number.reshape(walked.shape).astype(np.int32), lengths


def paces_of(rank: npt.NDArray[np.intp], robots: Sequence[Robot], lengths: Whole) -> Whole:
    """Return each robot's row in the steps of ways, (robots,), by the rank of its speed."""
    flies = np.array([robot.flies for robot in robots], np.bool_)
    rows: Whole = (rank + np.where(flies & (len(lengths) > 1), rank.max() + 1, 0)).astype(np.int32)
    return rows


def steps_of_ways(speeds: npt.NDArray[np.float64], lengths: Whole) -> Whole:
    """Return the steps that ways take at each speed, (paces, ways): walked, then flown."""
    steps = np.ceil(lengths[:, None, :] / speeds[:, None] - ROUNDING)  # (movers, speeds, ways)
    steps[np.broadcast_to(lengths[:, None, :] == lengths[0, -1], steps.shape)] = FAR
    return np.minimum(steps, FAR).astype(np.int32).reshape(-1, lengths.shape[1])


def has_prices(problem: Relaxed) -> bool:
    """Say whether more than the makespan counts."""
    return len(problem.prices.due) > 0


def walked_cells(problem: Relaxed) -> Whole:
    """Return the cells of ways on the ground, (tasks, places); many where there is none."""
    cells: Whole = problem.lengths[0, problem.cells]
    return cells


@kernel
def pace_together(problem: Relaxed, one: int, other: int) -> int:
    """Return the row in the steps of ways of those who go together: the slowest of two.

    They fly only if both do.
    """
    if len(problem.lengths) == 1:
        return min(one, other)
    speeds = len(problem.steps) // 2
    rank = min(one % speeds, other % speeds)
    return rank + speeds if min(one, other) >= speeds else rank


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
