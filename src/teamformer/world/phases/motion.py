"""Motion: one step of a team towards its assignment or its partner.

The seam between the step and the world it happens in: `travel` and `travel_between` are all that
the other phases know about walking.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import allocating_kernel, kernel
from teamformer.world.phases.carrying import is_carrying
from teamformer.world.phases.delays import delay_teams
from teamformer.world.phases.energy import spend_walking
from teamformer.world.phases.formation import JOIN, is_in_same_place, join_teams
from teamformer.world.rules.constants import MICROMETRES, NOBODY, ROUNDING
from teamformer.world.rules.distances import UNREACHABLE, fill_field
from teamformer.world.rules.steps import downhill
from teamformer.world.state.arrays import ANYWHERE

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@allocating_kernel
def move_teams(world: World) -> None:
    """Phase 5: teams that maintain walk first, then joiners walk to their partner's new place."""
    if world.rules.has_delays:
        delay_teams(world)
    for team in range(world.rules.robots):
        world.teams[team].has_walked = False
        if _can_walk(world, team) and world.teams[team].intent != JOIN:
            _walk_to_task(world, team)
    for team in range(world.rules.robots):
        if _can_walk(world, team) and world.teams[team].intent == JOIN:
            _walk_to_partner(world, team)


@kernel
def _can_walk(world: World, team: int) -> bool:
    if world.teams[team].size == 0:
        return False
    if world.teams[team].serves > 0 and not (world.rules.has_loads and is_carrying(world, team)):
        return False
    if world.rules.has_delays and world.teams[team].is_delayed:
        return False
    return world.rules.forming_steps == 0 or not world.teams[team].has_formed


@kernel
def _walk_to_task(world: World, team: int) -> None:
    task = world.teams[team].task
    if task == NOBODY:
        world.teams[team].credit = 0.0
        return
    if world.rules.has_batteries and world.teams[team].charger != NOBODY:
        _walk_to_charger(world, team, world.teams[team].charger)
        return
    if world.rules.is_plane:
        _walk_straight(world, team, world.tasks[task].x, world.tasks[task].y)
        return
    flies = world.teams[team].region == ANYWHERE
    to_go = travel(world, world.teams[team].x, world.teams[team].y, task, flies)
    for _ in range(_cells_to_walk(world, team, to_go)):
        x, y = advance(world, world.teams[team].x, world.teams[team].y, task, flies)
        world.teams[team].x, world.teams[team].y = x, y


@kernel
def _walk_to_charger(world: World, team: int, charger: int) -> None:
    goal_x, goal_y = world.chargers[charger].x, world.chargers[charger].y
    if world.rules.is_plane:
        _walk_straight(world, team, goal_x, goal_y)
        return
    x, y = world.teams[team].x, world.teams[team].y
    to_go = int(abs(goal_x - x) + abs(goal_y - y))
    if world.rules.has_walls:
        to_go = world.to_charger[charger, int(y), int(x)]
    for _ in range(_cells_to_walk(world, team, to_go)):
        if world.rules.has_walls:
            x, y = _go_downhill(world.to_charger[charger], x, y, goal_x, goal_y)
        else:
            x, y = _go_straight(x, y, goal_x, goal_y)
    world.teams[team].x, world.teams[team].y = x, y


@allocating_kernel
def _walk_to_partner(world: World, team: int) -> None:
    partner = world.robots[world.teams[team].partner].team
    if world.rules.is_plane:
        _walk_straight(world, team, world.teams[partner].x, world.teams[partner].y)
    elif world.teams[team].region == ANYWHERE:
        _fly_to_partner(world, team, partner)
    else:
        _walk_cells_to_partner(world, team, partner)
    _merge_on_the_way(world, team, partner)


@kernel
def _fly_to_partner(world: World, team: int, partner: int) -> None:
    goal_x, goal_y = world.teams[partner].x, world.teams[partner].y
    to_go = int(abs(goal_x - world.teams[team].x) + abs(goal_y - world.teams[team].y))
    for _ in range(_cells_to_walk(world, team, to_go)):
        x, y = _go_straight(world.teams[team].x, world.teams[team].y, goal_x, goal_y)
        world.teams[team].x, world.teams[team].y = x, y


@allocating_kernel
def _walk_cells_to_partner(world: World, team: int, partner: int) -> None:
    """Walk as far as the speed allows; nobody walks to a partner that is over an obstacle."""
    if world.rules.has_walls:
        column, row = int(world.teams[partner].x), int(world.teams[partner].y)
        if world.blocked[row, column]:
            world.teams[team].credit = 0.0
            return
    field = field_towards(world, world.teams[partner].x, world.teams[partner].y)
    to_go = field[int(world.teams[team].y), int(world.teams[team].x)]
    goal_x, goal_y = world.teams[partner].x, world.teams[partner].y
    for _ in range(_cells_to_walk(world, team, to_go)):
        x, y = _go_downhill(field, world.teams[team].x, world.teams[team].y, goal_x, goal_y)
        world.teams[team].x, world.teams[team].y = x, y


@kernel
def _merge_on_the_way(world: World, team: int, partner: int) -> None:
    """Join a partner at once that has been reached, where forming costs no step."""
    formed = world.teams[team].has_formed or world.teams[partner].has_formed
    if world.rules.forming_steps == 0 and not formed and is_in_same_place(world, team, partner):
        join_teams(world, team, partner)
        world.count.joins += 1


@kernel
def _walk_straight(world: World, team: int, goal_x: float, goal_y: float) -> None:
    """Walk what the team walks in a step towards a point of a plane, or onto it if that is less."""
    x, y, pace = world.teams[team].x, world.teams[team].y, world.teams[team].pace
    to_x, to_y = straight_on(x, y, goal_x, goal_y, pace)
    world.teams[team].x, world.teams[team].y = to_x, to_y
    away_x, away_y = to_x - x, to_y - y
    spend_walking(world, team, np.sqrt(away_x * away_x + away_y * away_y))


@kernel
def straight_on(x: float, y: float, goal_x: float, goal_y: float, length: float) -> tuple[Any, Any]:
    """Return where one is on a plane after so much of the way to a point, at most all of it."""
    to_go = np.sqrt((goal_x - x) * (goal_x - x) + (goal_y - y) * (goal_y - y))
    if to_go <= length + ROUNDING:
        return goal_x, goal_y
    x = np.rint((x + (goal_x - x) * length / to_go) * MICROMETRES) / MICROMETRES
    y = np.rint((y + (goal_y - y) * length / to_go) * MICROMETRES) / MICROMETRES
    return x, y


@kernel
def place_teams(world: World, places: Array) -> None:
    """Phase 5 with motion from outside: put every team where `places` (robots, 2) has its slot.

    Where forming costs no step, teams that have met join.
    """
    for team in range(world.rules.robots):
        if world.teams[team].size > 0:
            world.teams[team].x, world.teams[team].y = places[team, 0], places[team, 1]
    for team in range(world.rules.robots):
        if _can_walk(world, team) and world.teams[team].intent == JOIN:
            _merge_on_the_way(world, team, world.robots[world.teams[team].partner].team)


@kernel
def _cells_to_walk(world: World, team: int, to_go: int) -> int:
    """Spend the team's speed: whole cells to cross now; the fraction is kept for the next step."""
    if to_go == 0 or to_go >= UNREACHABLE:
        world.teams[team].credit = 0.0
        return 0
    world.teams[team].credit += world.teams[team].pace
    cells = int(world.teams[team].credit + ROUNDING)
    if cells >= to_go:
        world.teams[team].credit = 0.0
        cells = to_go
    else:
        world.teams[team].credit -= cells
    spend_walking(world, team, cells)
    return cells


@kernel
def travel(world: World, x: float, y: float, task: int, flies: bool) -> np.int64:
    """Return the way from a place to a task as a whole number: cells, on a plane micrometres.

    Walls are in nobody's way who flies.
    """
    if world.rules.is_plane:
        away_x, away_y = world.tasks[task].x - x, world.tasks[task].y - y
        return np.int64(np.rint(np.sqrt(away_x * away_x + away_y * away_y) * MICROMETRES))
    if world.rules.has_walls and not flies:
        return np.int64(world.fields[task, int(y), int(x)])
    away_x = abs(world.tasks[task].x - x)
    return np.int64(away_x + abs(world.tasks[task].y - y))


@kernel
def is_way(region: int, goal: int) -> bool:
    """Say whether a way leads from one connected part of the map to another, or to itself."""
    return bool(region == goal) | bool(region == ANYWHERE)


@kernel
def travel_between(world: World, task: int, other: int, flies: bool) -> int:
    """Return the way between two tasks, as `travel` does."""
    return travel(world, world.tasks[other].x, world.tasks[other].y, task, flies)


@kernel
def advance(world: World, x: float, y: float, task: int, flies: bool) -> tuple[Any, Any]:
    """Return the next cell on a shortest way from (x, y) to a task that is not there."""
    goal_x, goal_y = world.tasks[task].x, world.tasks[task].y
    if world.rules.has_walls and not flies:
        return _go_downhill(world.fields[task], x, y, goal_x, goal_y)
    return _go_straight(x, y, goal_x, goal_y)


@kernel
def _go_straight(x: float, y: float, goal_x: float, goal_y: float) -> tuple[Any, Any]:
    """Return the next cell towards a goal where nothing is in the way."""
    away_x, away_y = goal_x - x, goal_y - y
    if abs(away_x) >= abs(away_y):
        return x + np.sign(away_x), y
    return x, y + np.sign(away_y)


@kernel
def _go_downhill(field: Array, x: float, y: float, goal_x: float, goal_y: float) -> Any:
    """Return a neighbouring cell that is one nearer to the goal.

    Of several, one on the axis with more left to go, as `advance` does where nothing is in the way.
    """
    along_x = abs(goal_x - x) >= abs(goal_y - y)
    column, row = downhill(field, int(x), int(y), along_x)
    return np.float64(column), np.float64(row)


@allocating_kernel
def field_towards(world: World, x: float, y: float) -> Array:
    """Return every cell's distance to a place, as (height, width); for partners, who move."""
    if world.rules.has_walls:
        blocked = world.blocked
    else:
        blocked = np.zeros((world.rules.height, world.rules.width), dtype=np.bool_)
    field = np.full(blocked.shape, UNREACHABLE, dtype=np.int32)
    fill_field(blocked, int(x), int(y), field)
    return field
