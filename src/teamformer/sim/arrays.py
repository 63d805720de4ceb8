"""The arrays that the kernels work on: a batch of worlds, and one world in it.

Everything about one robot, team, task or cell is one record, so that a kernel reads
`world.teams[team].task`. Worlds of different sizes share a batch by padding: a padded robot is in
no team, a padded task is never open.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numba as nb
import numpy as np
import numpy.typing as npt

from teamformer.errors import ScenarioError
from teamformer.grid import Grid, Place
from teamformer.mission_rules import (
    ALLOCATIONS,
    is_known_from_start,
    opening_step,
    rules_not_played,
)
from teamformer.model import Scenario
from teamformer.plane import DECIMALS, Plane
from teamformer.planning.distances import UNREACHABLE, blocked_cells, distance_fields
from teamformer.rules.constants import NOBODY as NOBODY

Array = npt.NDArray[Any]

NEVER = 2**30
MIXED = -2
"""The crew of a team whose robots are of several."""

RUNNING, COMPLETED, STEP_LIMIT, INFEASIBLE = 0, 1, 2, 3
STATUS_NAMES = ("running", "completed", "step limit", "infeasible")

RESOLVE, NEAREST = 0, 1
"""What happens to the order when tasks appear: a new tour, or each after its nearest."""

PAPER, NEAREST_ALONE, CREWS, PLAN = 0, 1, 2, 3
"""Who heads for which task: allocations as in `mission_rules.ALLOCATIONS`."""

RULES = np.dtype(
    [
        ("robots", np.int32),  # how many there are
        ("tasks", np.int32),
        ("width", np.int32),  # cells; on a plane they only serve to look around
        ("height", np.int32),
        ("forming_steps", np.int32),
        ("step_limit", np.int32),
        ("new_tasks", np.int32),  # RESOLVE or NEAREST
        ("allocation", np.int32),  # PAPER, NEAREST_ALONE, CREWS or PLAN
        ("has_schedule", np.bool_),  # the order is planned, no tour
        ("has_walls", np.bool_),
        ("is_plane", np.bool_),
        ("sensing_radius", np.float64),  # cells, on a plane metres
        ("join_radius", np.float64),
        ("start_x", np.float64),  # the place at the robots' centroid, where the first tour begins
        ("start_y", np.float64),
        ("arrival_radius", np.float64),  # teams so near to each other are in the same place
        ("unit", np.float64),  # the length that counts as one cell for a learned policy
        ("cells_per_length", np.float64),  # 1 on a grid
    ],
    align=True,
)
COUNT = np.dtype(
    [
        ("steps", np.int32),
        ("open", np.int32),  # released tasks that are not done
        ("arrived", np.int32),  # of these, tasks that the order does not know yet
        ("done", np.int32),
        ("noted", np.int32),  # of these, tasks that the crews know of
        ("plans", np.int32),  # how often the order, the crews or the shared plan were made
        ("lost", np.int32),  # how often robots were lost
        ("back", np.int32),  # how often robots came back
        ("broken_off", np.int32),  # services
        ("planned_lost", np.int32),  # losses that the shared plan knows of
        ("planned_back", np.int32),  # returns that it knows of
        ("planned_broken_off", np.int32),  # services that it knows to be broken off
        ("reason", np.int32),  # why the shared plan was made last, in bits
        ("joins", np.int32),
        ("splits", np.int32),
        ("illegal", np.int32),
        ("status", np.int32),
    ],
    align=True,
)
ROBOT = np.dtype(
    [
        ("team", np.int32),  # slot of its team, or NOBODY while lost
        ("formed", np.int32),  # the same after this step's formations, before its losses
        ("region", np.int32),  # connected part of the map
        ("lost", np.int32),  # the step it counts for nothing from, or NEVER
        ("back", np.int32),  # the step it is there again from, or NEVER
        ("x", np.float64),  # where it was lost
        ("y", np.float64),
        ("stays", np.bool_),  # in the split being made
        ("crew", np.int32),  # NOBODY once it is known to be lost
        ("next", np.int32),  # its first open task by its crew's list or the shared plan, or NOBODY
        ("kind", np.int32),  # the lowest robot that brings the same and is as fast
        ("took", np.int32),  # the robot whose part of the shared plan it has just taken, or NOBODY
        # What everybody knows of it: that it was there then, together with others.
        ("spot_x", np.float64),
        ("spot_y", np.float64),
        ("left_at", np.int32),  # step
        ("company", np.int32),  # the lowest robot among them
        ("pace", np.float64),  # cells a step, on a plane metres a step
    ],
    align=True,
)
TEAM = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("pace", np.float64),  # of the slowest member
        ("credit", np.float64),  # fraction of a cell walked
        ("size", np.int32),  # robots; 0 where the slot has no team
        ("task", np.int32),  # assignment, or NOBODY
        ("serves", np.int32),  # how many tasks it is serving
        ("is_detour", np.bool_),  # the assignment was taken out of order
        # What follows lasts for one step.
        ("has_formed", np.bool_),
        ("is_commanded", np.bool_),  # its decision names tasks: the allocator leaves it alone
        ("intent", np.int32),  # MAINTAIN, SPLIT or JOIN
        ("partner", np.int32),  # whom it wants to join
        ("row", np.int32),  # of its decision
        ("pursued", np.int32),  # assignment during the step
        ("next_here", np.int32),  # the next team in the same cell
        ("next", np.int32),  # the earliest of its robots' next tasks
        ("crew", np.int32),  # that of all its robots, or MIXED
        ("is_parting", np.bool_),  # its robots have different next tasks by the shared plan
    ],
    align=True,
)
TASK = np.dtype(
    [
        ("x", np.float64),
        ("y", np.float64),
        ("duration", np.int32),  # steps
        ("appears", np.int32),  # steps made when it becomes known, if it awaits no other
        ("awaits", np.int32),  # how many tasks that it comes after are undone
        ("region", np.int32),
        ("next_here", np.int32),  # the next task in the same cell
        ("rank", np.int32),  # place in the order while open
        ("crew", np.int32),  # whose list it is on
        ("server", np.int32),  # team that serves it, or NOBODY
        ("waiting", np.int32),  # a team that waits at it for others by the shared plan, or NOBODY
        ("remaining", np.int32),  # steps of service
        ("done_at", np.int32),  # step, or NOBODY
        ("done_by", np.int32),  # slot
        ("is_open", np.bool_),  # released and not done
    ],
    align=True,
)
CELL = np.dtype([("first_task", np.int32), ("first_team", np.int32)], align=True)


class Worlds(NamedTuple):
    """A batch of worlds: what they are and how they stand.

    A team is kept at its slot, the lowest robot number in it.
    """

    rules: Array  # (worlds,) RULES
    count: Array  # type: ignore[assignment]  # (worlds,) COUNT
    robots: Array  # (worlds, robots) ROBOT
    teams: Array  # (worlds, robots) TEAM
    tasks: Array  # (worlds, tasks) TASK
    cells: Array  # (worlds, cells) CELL
    brings: Array  # (worlds, robots, caps) counts of each robot
    has: Array  # (worlds, robots, caps) counts of each team
    needs: Array  # (worlds, tasks, caps)
    precedes: Array  # (worlds, tasks, tasks) which are done before which, or (worlds, 0, 0)
    demand: Array  # (worlds, caps) open tasks that need each capability
    order: Array  # (worlds, tasks) open tasks in order, the first count.open of them
    blocked: Array  # (worlds, height, width), or (worlds, 0, 0) if no world has walls
    fields: Array  # (worlds, tasks, height, width) distances to tasks, or (worlds, 0, 0, 0)
    near: Array  # (worlds, robots) teams found nearby
    near_key: Array  # (worlds, robots) what these are sorted by
    room: Array  # (worlds, caps) what still fits into a split
    here: Array  # (worlds, tasks) tasks found where a team is
    coalition: Array  # (worlds, tasks, robots) who does what by the shared plan, or (worlds, 0, 0)
    planned: Array  # (worlds, robots, caps) what it wants each team to have, or (worlds, 0, 0)


if TYPE_CHECKING:

    class World(NamedTuple):
        """One world as kernels see it: `world.teams[team].task`, as numba types its records."""

        rules: Any
        count: Any
        robots: Any
        teams: Any
        tasks: Any
        cells: Any
        brings: Array
        has: Array
        needs: Array
        precedes: Array
        demand: Array
        order: Array
        blocked: Array
        fields: Array
        near: Array
        near_key: Array
        room: Array
        here: Array
        coalition: Array
        planned: Array

else:
    World = Worlds
    """The same fields for one world, without the leading axis."""


@nb.njit(inline="always")
def world_at(worlds, w):  # type: ignore[no-untyped-def]
    """Return one world of a batch; writing to it writes to the batch."""
    return Worlds(
        worlds.rules[w],
        worlds.count[w],
        worlds.robots[w],
        worlds.teams[w],
        worlds.tasks[w],
        worlds.cells[w],
        worlds.brings[w],
        worlds.has[w],
        worlds.needs[w],
        worlds.precedes[w],
        worlds.demand[w],
        worlds.order[w],
        worlds.blocked[w],
        worlds.fields[w],
        worlds.near[w],
        worlds.near_key[w],
        worlds.room[w],
        worlds.here[w],
        worlds.coalition[w],
        worlds.planned[w],
    )


def pack_worlds(scenarios: Sequence[Scenario]) -> Worlds:
    """Lay scenarios out as they stand before the first step, padded to the largest of them.

    Raises `ScenarioError` for missions whose rules are not those of the steps.
    """
    problems = [problem for scenario in scenarios for problem in rules_not_played(scenario)]
    if problems:
        raise ScenarioError(problems)
    worlds = _empty_worlds(scenarios)
    for w, scenario in enumerate(scenarios):
        _pack_rules(worlds, w, scenario)
        _pack_robots(worlds, w, scenario)
        _pack_tasks(worlds, w, scenario)
        if isinstance(scenario.world, Grid) and scenario.world.rows:
            _pack_map(worlds, w, scenario.world, [task.at for task in scenario.tasks])
    return worlds


def _empty_worlds(scenarios: Sequence[Scenario]) -> Worlds:
    count = len(scenarios)
    robots = max(len(s.robots) for s in scenarios)
    tasks = max(len(s.tasks) for s in scenarios)
    caps = max(len(s.capabilities) for s in scenarios)
    cells = max(width * height for width, height, _ in map(_cells_of, scenarios))
    maps = [s.world for s in scenarios if isinstance(s.world, Grid) and s.world.rows]
    has_precedence = any(task.after for s in scenarios for task in s.tasks)
    precedes = (count, tasks, tasks) if has_precedence else (count, 0, 0)
    has_plan = any(s.allocation == "plan" for s in scenarios)
    walls = (max((m.height for m in maps), default=0), max((m.width for m in maps), default=0))
    worlds = Worlds(
        rules=np.zeros(count, dtype=RULES),
        count=np.zeros(count, dtype=COUNT),
        robots=np.zeros((count, robots), dtype=ROBOT),
        teams=np.zeros((count, robots), dtype=TEAM),
        tasks=np.zeros((count, tasks), dtype=TASK),
        cells=np.zeros((count, cells), dtype=CELL),
        brings=np.zeros((count, robots, caps), dtype=np.int16),
        has=np.zeros((count, robots, caps), dtype=np.int16),
        needs=np.zeros((count, tasks, caps), dtype=np.int16),
        precedes=np.zeros(precedes, dtype=np.bool_),
        demand=np.zeros((count, caps), dtype=np.int32),
        order=np.full((count, tasks), NOBODY, dtype=np.int32),
        blocked=np.ones((count, *walls), dtype=np.bool_),
        fields=np.full((count, tasks if walls[0] else 0, *walls), UNREACHABLE, dtype=np.int32),
        near=np.zeros((count, robots), dtype=np.int32),
        near_key=np.zeros((count, robots), dtype=np.int64),
        room=np.zeros((count, caps), dtype=np.int32),
        here=np.zeros((count, tasks), dtype=np.int32),
        coalition=np.zeros((count, tasks, robots) if has_plan else (count, 0, 0), dtype=np.bool_),
        planned=np.zeros((count, robots, caps) if has_plan else (count, 0, 0), dtype=np.int16),
    )
    worlds.robots["team"] = NOBODY
    worlds.robots["lost"] = worlds.robots["back"] = NEVER
    worlds.teams["task"] = NOBODY
    worlds.cells["first_team"] = worlds.cells["first_task"] = NOBODY
    worlds.tasks["appears"] = NEVER
    for field in ("next_here", "server", "done_at", "done_by", "crew", "waiting"):
        worlds.tasks[field] = NOBODY
    worlds.robots["crew"] = worlds.robots["next"] = worlds.robots["took"] = NOBODY
    return worlds


def _pack_rules(worlds: Worlds, w: int, scenario: Scenario) -> None:
    width, height, cells_per_length = _cells_of(scenario)
    plane = scenario.world if isinstance(scenario.world, Plane) else None
    here = plane.arrival_radius if plane else 0.0
    rules = {
        "robots": len(scenario.robots),
        "tasks": len(scenario.tasks),
        "width": width,
        "height": height,
        "forming_steps": scenario.forming_steps,
        "step_limit": scenario.step_limit,
        "new_tasks": NEAREST if scenario.new_tasks == "nearest" else RESOLVE,
        "allocation": ALLOCATIONS.index(scenario.allocation),
        "has_schedule": scenario.order == "schedule",
        "has_walls": bool(scenario.world.rows),
        "is_plane": plane is not None,
        "sensing_radius": max(scenario.sensing_radius, here),
        "join_radius": max(scenario.join_radius, here),
        "arrival_radius": here,
        "unit": plane.unit if plane else 1.0,
        "cells_per_length": cells_per_length,
    }
    for name, value in rules.items():
        worlds.rules[name][w] = value
    worlds.rules["start_x"][w], worlds.rules["start_y"][w] = _centroid(scenario)


def _cells_of(scenario: Scenario) -> tuple[int, int, float]:
    """Return how many cells across and up, and how many a length; on a plane, to look around.

    There a cell is wider than any finite radius, so that what is near lies in the cells around,
    and there are no more of them than a few for each robot and task.
    """
    world = scenario.world
    if isinstance(world, Grid):
        return world.width, world.height, 1.0
    radii = (scenario.sensing_radius, scenario.join_radius, world.arrival_radius)
    widest = max((radius for radius in radii if radius < math.inf), default=0.0)
    most = 4 * (len(scenario.robots) + len(scenario.tasks))
    area, longest = world.width * world.height, max(world.width, world.height)
    side = max(1.001 * widest, math.sqrt(area / most), longest / most)
    return int(world.width / side) + 1, int(world.height / side) + 1, 1 / side


def _centroid(scenario: Scenario) -> Place:
    """Return the place at the robots' centroid; where that is blocked, the nearest robot's."""
    places = [robot.at for robot in scenario.robots]
    x = sum(x for x, _ in places) / len(places)
    y = sum(y for _, y in places) / len(places)
    if isinstance(scenario.world, Plane):
        return round(x, DECIMALS), round(y, DECIMALS)
    cell = (int(x + 0.5), int(y + 0.5))
    if scenario.world.is_free(cell):
        return cell
    return min(places, key=lambda at: (at[0] - x) ** 2 + (at[1] - y) ** 2)


def _pack_robots(worlds: Worlds, w: int, scenario: Scenario) -> None:
    column = {name: c for c, name in enumerate(scenario.capabilities)}
    for r, robot in enumerate(scenario.robots):
        record = worlds.robots[w, r]
        record["pace"] = scenario.world.pace(robot.speed)
        record["lost"] = NEVER if robot.lost is None else robot.lost
        record["back"] = NEVER if robot.back is None else robot.back
        record["region"] = scenario.world.region(robot.at)
        record["spot_x"], record["spot_y"] = robot.at
        for name, count in robot.can.items():
            worlds.brings[w, r, column[name]] = count
    kinds: dict[tuple[object, ...], int] = {}
    for r, robot in enumerate(scenario.robots):
        kind = (*sorted(robot.can.items()), robot.speed, scenario.world.region(robot.at))
        worlds.robots["kind"][w, r] = kinds.setdefault(kind, r)
    for members in scenario.starting_teams:
        slot, robots = members[0], list(members)
        team = worlds.teams[w, slot]
        team["x"], team["y"] = scenario.robots[slot].at
        team["size"] = len(members)
        team["pace"] = worlds.robots[w, robots]["pace"].min()
        worlds.robots["team"][w, robots] = worlds.robots["company"][w, robots] = slot
        worlds.has[w, slot] = worlds.brings[w, robots].sum(axis=0)


def _pack_tasks(worlds: Worlds, w: int, scenario: Scenario) -> None:
    cap_of = {name: c for c, name in enumerate(scenario.capabilities)}
    number_of = {task.name: k for k, task in enumerate(scenario.tasks)}
    width, height, cells_per_length = _cells_of(scenario)
    for k in reversed(range(len(scenario.tasks))):  # so that each cell's chain is in task order
        task, record = scenario.tasks[k], worlds.tasks[w, k]
        record["x"], record["y"] = task.at
        record["duration"] = task.duration
        record["appears"], record["awaits"] = opening_step(task), len(task.after)
        for name in task.after:
            worlds.precedes[w, number_of[name], k] = True
        record["region"] = scenario.world.region(task.at)
        record["is_open"] = is_known_from_start(task)
        column, row = (int(along * cells_per_length) for along in task.at)
        cell = worlds.cells[w, min(row, height - 1) * width + min(column, width - 1)]
        record["next_here"], cell["first_task"] = cell["first_task"], k
        for name, count in task.needs.items():
            worlds.needs[w, k, cap_of[name]] = count
    known = np.flatnonzero(worlds.tasks["is_open"][w])
    worlds.order[w, : len(known)] = known
    worlds.demand[w] = (worlds.needs[w, known] > 0).sum(axis=0)
    worlds.count["open"][w] = worlds.count["arrived"][w] = len(known)


def _pack_map(worlds: Worlds, w: int, grid: Grid, places: Sequence[Place]) -> None:
    worlds.blocked[w, : grid.height, : grid.width] = blocked_cells(grid)
    worlds.fields[w, : len(places), : grid.height, : grid.width] = distance_fields(grid, places)
