"""Ways of the relaxed problem: how long they are, the numbers they have, the steps that they take.

On a plane, ways are counted in cells that are a small fraction of a step long. They are counted
from the edge of one place to the edge of the next, so that tasks whose places touch are in the same
place here, and in favour of the robots, so that no plan under the rules is faster.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from teamformer.base.array_types import Floats, Int32s
from teamformer.mission.model import Mission, Robot, Task, World
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.rules.constants import FAR, MICROMETRES, ROUNDING
from teamformer.world.rules.distances import UNREACHABLE, straight_ways, travel_matrix

SHORTEST_CELL = 1e-4  # metres
MOST_CELLS = 200_000
"""Of a plane: how long a cell is, and how many the longest way has at most."""


def ends_of(tasks: Sequence[Task]) -> list[Place]:
    """Return where robots are once they have done each task."""
    return [task.ends_at for task in tasks]


def are_ways_straight(world: World, tasks: Sequence[Task]) -> bool:
    """Say whether places tell how far it is: on grids without walls, where nothing is carried."""
    is_open = isinstance(world, Grid) and not world.rows
    return is_open and all(task.to is None for task in tasks)


def ways_of(mission: Mission) -> tuple[Int32s, Floats]:
    """Return the cells from places to tasks, (tasks, places), and what robots walk in a step."""
    tasks, speed = [t.at for t in mission.tasks], np.array([r.speed for r in mission.robots])
    places = ends_of(mission.tasks) + [robot.at for robot in mission.robots]
    if isinstance(mission.world, Grid):
        return travel_matrix(mission.world, places, tasks).T, speed
    assert isinstance(mission.world, Plane)
    pace = _most_walked(mission.world, speed, mission.forming_steps)
    touching = np.where(np.arange(len(places)) < len(tasks), 2, 1) * mission.world.arrival_radius
    metres = straight_ways(tasks, places) * (1 - 1 / (MICROMETRES * pace.min())) - touching
    cell = max(SHORTEST_CELL, float(metres.max()) / MOST_CELLS)
    cells = np.floor(np.maximum(metres, 0.0) / cell).astype(np.int32)
    return cells, np.ceil(pace / cell - ROUNDING)


def _most_walked(plane: Plane, speed: Floats, forming_steps: int) -> Floats:
    """Return how many metres each robot gets on in a step at most.

    A join puts the joiner where its partner is, which may be the arrival radius away; robots walk
    in that step too where forming costs none.
    """
    pace: Floats = speed * plane.step
    if forming_steps == 0:
        return pace + plane.arrival_radius
    return np.maximum(pace, plane.arrival_radius)


def flights(mission: Mission, goals: Sequence[Place], places: Sequence[Place]) -> Int32s | None:
    """Return the cells from places to goals in the air, (goals, places).

    None if nobody flies, or nothing is in the way, so that all ways are as on the ground.
    """
    if not mission.world.rows or not any(robot.flies for robot in mission.robots):
        return None
    apart = np.reshape(goals, (-1, 1, 2)) - np.reshape(places, (1, -1, 2))  # (goals, places, 2)
    cells: Int32s = np.abs(apart).sum(axis=2).astype(np.int32)
    return cells


def number_ways(walked: Int32s, flown: Int32s | None) -> tuple[Int32s, Int32s]:
    """Return the number of each way, and the cells of the ways by number, (movers, ways).

    If nobody flies the number of a way is its cells. Else ways that are equally long, walked and
    flown, have one number: 0 if they lead nowhere, and less if they are shorter on the ground.
    """
    longest = int(walked[walked < UNREACHABLE].max())
    if flown is None:
        no_way = 1 + longest
        cells: Int32s = np.ascontiguousarray(np.minimum(walked, no_way))
        return cells, lengths_to(longest)
    no_way = 1 + max(longest, int(flown.max()))
    pairs = np.stack([np.minimum(walked, no_way), flown]).reshape(2, -1)  # (movers, ways)
    pairs = np.append(pairs, [[0], [0]], axis=1)  # it is there, and so the first
    kinds, number = np.unique(pairs, axis=1, return_inverse=True)
    number = number.ravel()[:-1]
    lengths = np.append(kinds, [[no_way], [no_way]], axis=1).astype(np.int32)
    return number.reshape(walked.shape).astype(np.int32), lengths


def lengths_to(longest: int) -> Int32s:
    """Return the cells of ways whose number is their cells, (1, ways)."""
    return np.arange(longest + 2, dtype=np.int32)[None]


def paces_of(rank: npt.NDArray[np.intp], robots: Sequence[Robot], lengths: Int32s) -> Int32s:
    """Return each robot's row in the steps of ways, (robots,), by the rank of its speed."""
    flies = np.array([robot.flies for robot in robots], np.bool_)
    rows: Int32s = (rank + np.where(flies & (len(lengths) > 1), rank.max() + 1, 0)).astype(np.int32)
    return rows


def steps_of_ways(speeds: Floats, lengths: Int32s) -> Int32s:
    """Return the steps that ways take at each speed, (paces, ways): walked, then flown."""
    steps = np.ceil(lengths[:, None, :] / speeds[:, None] - ROUNDING)  # (movers, speeds, ways)
    steps[np.broadcast_to(lengths[:, None, :] == lengths[0, -1], steps.shape)] = FAR
    return np.minimum(steps, FAR).astype(np.int32).reshape(-1, lengths.shape[1])
