"""The relaxed problem: what is left of a mission when robots join and split at no cost.

Every robot goes its own way from task to task. A task starts at a step not before `appears + 1` and
not before every robot of its coalition is there; it ends `duration` steps later, and its coalition
stays until then. A coalition is any set of robots that together have what the task needs. A robot
that stays in one place may serve all tasks there at once, as a team does. A robot lost at step l
serves only tasks that end before l; one that comes back counts as always there. The makespan is the
last end.

A load ends elsewhere than it begins: the way from its task begins where it is brought to, so ways
differ by direction. Its duration counts the least steps that a team that can do it carries it, and
its unloading.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from teamformer.base.array_types import Array, Floats, Int32s
from teamformer.base.kernels.jit import kernel
from teamformer.mission.checks.windows import opening_step
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.capabilities import Counts
from teamformer.mission.parts.grid import Place
from teamformer.mission.precedence import tasks_before
from teamformer.planning.problem.coalition_problem import listed
from teamformer.planning.problem.misses import Misses, misses_of, no_misses
from teamformer.planning.problem.permits import Permits, no_permits
from teamformer.planning.problem.prices import (
    SHARES,
    STEP,
    Prices,
    prices_of,
    step_of_missed,
)
from teamformer.planning.problem.rotas import Rotas, rotas_in_ticks
from teamformer.planning.problem.team_batteries import TeamBatteries, no_team_batteries
from teamformer.planning.problem.ways import (
    are_ways_straight,
    ends_of,
    flights,
    lengths_to,
    number_ways,
    paces_of,
    steps_of_ways,
    ways_of,
)
from teamformer.world.rules.constants import FAR, NOBODY
from teamformer.world.rules.distances import longest_straight, way_between

BLOCK = 4_000_000
"""Ways that are looked at at once where there is no table of them."""


class Relaxed(NamedTuple):
    """The relaxed problem as plain arrays; times are in steps."""

    cells: Int32s  # (tasks, places) ways from places to tasks, as column of `steps` and `lengths`;
    # without walls to fly over that is their cells; places are the tasks' ends, then the starts;
    # (0, 0) where ways are worked out from `spots` and `goals` as they are needed
    spots: Int32s  # (places, 2) where the places are, or (0, 2) where ways are in the table
    goals: Int32s  # (tasks, 2) where the tasks are, or (0, 2)
    lengths: Int32s  # (movers, ways) cells on the ground and, if some robots fly over walls, in the
    # air; last column, and where there is none on the ground: more than any way has
    steps: Int32s  # (paces, ways) steps that ways take; last column, and where there is none: FAR
    pace: Int32s  # (robots,) row of `steps`: by speed, first those on the ground, then in the air
    speed: Floats  # (robots,) cells a step
    counts: Int32s  # (robots, caps)
    needs: Int32s  # (tasks, caps)
    able: Int32s  # (caps, robots) numbers of the robots with each capability, then NOBODY
    duration: Int32s  # (tasks,)
    appears: Int32s  # (tasks,) steps made when the task becomes known
    lost: Int32s  # (robots,) first step the robot is missing from; FAR for never
    ready: Int32s  # (robots,) the step from which the robot is free; 0 at the start
    carry: Int32s  # (tasks,) cells that a load is carried; 0 for other tasks
    quickest: Int32s  # (tasks,) steps that this takes at least, which `duration` counts
    before: Int32s  # (tasks, most) the tasks that must be done before each, then NOBODY; nothing
    # that is relaxed counts them
    prices: Prices  # what plans in steps are searched by besides the makespan
    misses: Misses  # what is missed if the mission is over before a task is done, in steps
    rotas: Rotas  # of each robot, in steps; empty where all always work. Nothing relaxed counts it
    permits: Permits  # room in zones, in steps; nothing relaxed counts it
    batteries: TeamBatteries  # nothing relaxed counts them


class Future(NamedTuple):
    """What will happen, in steps."""

    appears: Int32s  # (tasks,) as in Relaxed
    lost: Int32s  # (robots,) as in Relaxed


def relax(mission: Mission, in_table: bool = True) -> Relaxed:
    """Return the relaxed problem of a mission.

    Without `in_table` it has no table of ways where these can be worked out as they are needed.
    """
    future = future_of(mission)
    places = [*ends_of(mission.tasks), *(robot.at for robot in mission.robots)]
    if not in_table and are_ways_straight(mission.world, mission.tasks):
        ways: tuple[Int32s | None, np.ndarray] = (
            None,
            np.array([r.speed for r in mission.robots]),
        )
    else:
        ways = ways_of(mission)
    return relax_ways(
        mission,
        mission.tasks,
        mission.robots,
        places,
        *ways,
        future,
        ready=np.zeros(len(mission.robots), dtype=np.int32),
    )


def relax_ways(
    mission: Mission,
    tasks: Sequence[Task],
    robots: Sequence[Robot],
    places: Sequence[Place],
    walked: Int32s | None,
    speed: Floats,
    future: Future,
    ready: Int32s,
) -> Relaxed:
    """Return the relaxed problem of some tasks and robots of a mission.

    `places` are the ends of tasks, then starts; `walked` are the cells from there to tasks on the
    ground, (tasks, places), and `speed` (robots,) is what robots walk of them in a step. Without
    `walked` ways are straight, and there is no table of them.
    """
    spots = goals = np.zeros((0, 2), np.int32)
    if walked is None:
        spots, goals = np.array(places, np.int32), np.array([task.at for task in tasks], np.int32)
        cells, lengths = np.zeros((0, 0), np.int32), lengths_to(longest_straight(spots, goals))
    else:
        cells, lengths = number_ways(walked, flights(mission, [task.at for task in tasks], places))
    speeds, rank = np.unique(speed, return_inverse=True)
    counts = count_table([robot.can for robot in robots], mission)
    needs = count_table([task.needs for task in tasks], mission)
    steps, pace = steps_of_ways(speeds, lengths), paces_of(rank, robots, lengths)
    carry = cells.diagonal().copy() if len(cells) else np.zeros(len(tasks), np.int32)
    np.fill_diagonal(cells, 0)  # which is not the way from a task's end to its beginning
    quickest = [
        least_carried(counts, steps[pace, way], need) if way > 0 else 0
        for way, need in zip(carry, needs, strict=True)
    ]
    duration = np.array([task.duration + task.unload for task in tasks], np.int32)
    before = tasks_before(tasks)
    problem = Relaxed(
        cells=cells,
        spots=spots,
        goals=goals,
        lengths=lengths,
        steps=steps,
        pace=pace,
        speed=speed,
        counts=counts,
        needs=needs,
        able=able_robots(counts),
        duration=duration + np.array(quickest, np.int32),
        appears=future.appears,
        lost=future.lost,
        ready=ready,
        carry=carry,
        quickest=np.array(quickest, np.int32),
        before=listed([before.get(task, []) for task in range(len(tasks))]),
        prices=prices_of(mission, tasks),
        misses=no_misses(),
        rotas=rotas_in_ticks([robot.rota for robot in robots], int, FAR, 0),
        permits=no_permits(len(tasks)),
        batteries=no_team_batteries(),
    )
    if mission.until is None or not tasks:
        return problem
    return problem._replace(misses=_misses(mission, tasks, problem))


def _misses(mission: Mission, tasks: Sequence[Task], problem: Relaxed) -> Misses:
    """Return what is missed of tasks when the mission is over, in what plans of steps cost."""
    assert mission.until is not None, "the mission is over at a time"
    until, everything, prices = int(mission.until), cost_of_step(problem), problem.prices
    most = everything
    if has_prices(problem):
        most = int(prices.whole.sum() + prices.late.sum() + prices.ends.sum())
    numbers = np.arange(len(tasks))
    ways = problem.steps[problem.pace.max(), cells_between(problem, numbers, numbers)]
    walked = float(ways[ways < FAR].mean()) if (ways < FAR).any() else 0.0
    leg = int(everything * (problem.duration.mean() + walked + 1))
    price = step_of_missed(mission, tasks)
    return misses_of(mission, tasks, until, most * (until + 1), leg, price)


def cost_of_step(problem: Relaxed) -> int:
    """Return what a step of everything costs in a plan in steps."""
    return (SHARES if has_prices(problem) else STEP) * len(problem.duration)


def least_carried(counts: Int32s, takes: Array, need: Int32s) -> Any:
    """Return how long a load is carried at least by robots that have what is needed.

    `takes` (robots,) is how long each of them takes for the way; it is what the slowest of all
    takes if even together they have not enough.
    """
    times = np.unique(takes)
    able = (when for when in times if (counts[takes <= when].sum(axis=0) >= need).all())
    return next(able, times[-1])


def without_directions(problem: Relaxed) -> Relaxed:
    """Return a problem whose ways between tasks are as short as the shorter of both directions.

    So they are no longer, whoever goes which way.
    """
    if not problem.carry.any():
        return problem
    cells, tasks = problem.cells.copy(), len(problem.cells)
    if len(problem.lengths) > 1:  # ways on the ground and in the air have one number: none counts
        cells[:, :tasks] = 0
    else:
        cells[:, :tasks] = np.minimum(cells[:, :tasks], cells[:, :tasks].T)
    return problem._replace(cells=cells)


def future_of(mission: Mission) -> Future:
    """Return when tasks may begin and robots are missing."""
    return Future(
        appears=np.array([opening_step(task) for task in mission.tasks], dtype=np.int32),
        lost=np.array([_lost_for_good(robot) for robot in mission.robots], dtype=np.int32),
    )


def _lost_for_good(robot: Robot) -> int:
    """Return the step that a robot is missing from; one that comes back counts as always there."""
    return FAR if robot.lost_for_good is None else int(robot.lost_for_good)


def may_set_down(mission: Mission) -> bool:
    """Say whether loads may be set down on their way, so that several teams bring them by turns.

    Then robots that will be lost help with what ends later, and nobody has to go all the way: a
    relaxed schedule bounds nothing.
    """
    has_losses = any(robot.absences for robot in mission.robots)
    return has_losses and any(task.to is not None for task in mission.tasks)


def is_true_relaxation(problem: Relaxed) -> bool:
    """Say whether no plan under the rules is faster than the best relaxed one.

    So it is on planes, and if all speeds are whole numbers. At 0.5 cells a step a robot on its way
    stands in each cell for two steps, and a task that appears there in the second costs it nothing;
    and at 0.8 two legs of a cell take 2 + 2 steps, but two cells at a stretch 3.
    """
    return bool((problem.speed % 1 == 0).all())


def cells_between(problem: Relaxed, tasks: Array, places: Array) -> Int32s:
    """Return the ways from some places to some tasks, (tasks, places), as column of `steps`."""
    if len(problem.cells):
        listed: Int32s = problem.cells[np.ix_(tasks, places)]
        return listed
    goals, spots = problem.goals[tasks], problem.spots[places]
    cells: Int32s = np.abs(goals[:, None, 0] - spots[:, 0])
    cells += np.abs(goals[:, None, 1] - spots[:, 1])
    return cells


@kernel
def way_number(problem: Relaxed, place: int, task: int) -> int:
    """Return the way from a place to a task, as column of `steps`."""
    return way_between(problem.cells, problem.spots, problem.goals, place, task)


def steps_from_starts(problem: Relaxed, tasks: Array) -> Int32s:
    """Return the steps that each robot takes from its start to some tasks, (tasks, robots)."""
    starts = len(problem.appears) + np.arange(len(problem.pace))
    steps: Int32s = problem.steps[problem.pace, cells_between(problem, tasks, starts)]
    return steps


def in_blocks(tasks: Array, each: int) -> Iterator[Array]:
    """Yield tasks in turn, so many at once that tables with `each` columns are no burden."""
    rows = max(1, BLOCK // max(1, each))
    for begin in range(0, len(tasks), rows):
        yield tasks[begin : begin + rows]


def has_prices(problem: Relaxed) -> bool:
    """Say whether more than the makespan counts."""
    return len(problem.prices.due) > 0


def walked_cells(problem: Relaxed) -> Int32s:
    """Return the cells of ways on the ground, (tasks, places); many where there is none."""
    if len(problem.lengths) == 1:  # the number of a way is its cells
        return problem.cells
    cells: Int32s = problem.lengths[0, problem.cells]
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


def count_table(parts: Sequence[Counts], mission: Mission) -> Int32s:
    """Return how much each part has of each capability, (parts, caps), in units."""
    rows = (mission.in_units(part) for part in parts)
    return np.array([[row.get(cap, 0) for cap in mission.capabilities] for row in rows], np.int32)


def least_brought(counts: Int32s) -> Int32s:
    """Return the least that a robot brings of each capability, (caps,); FAR where nobody does."""
    least: Int32s = np.where(counts > 0, counts, FAR).min(axis=0).astype(np.int32)
    return least


def most_in_coalitions(problem: Relaxed) -> Int32s:
    """Return how many robots are in a coalition that can spare nobody at most, (tasks,).

    Of each capability so many that they have enough whatever each of them brings.
    """
    robots = -(-problem.needs // least_brought(problem.counts))  # (tasks, caps)
    most: Int32s = np.minimum(robots.sum(axis=1), len(problem.pace))
    return most


def able_robots(counts: Int32s) -> Int32s:
    """Return the robots with each capability, (caps, robots), then NOBODY."""
    able = np.full(counts.T.shape, NOBODY, dtype=np.int32)
    for row, count in zip(able, counts.T, strict=True):
        row[: np.count_nonzero(count)] = np.flatnonzero(count)
    return able
