"""Who is near whom: teams and tasks listed by cell, so that looking around costs what is there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from teamformer.base.kernels.jit import kernel
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.world.state.arrays import World


@kernel
def list_teams_by_cell(world: World) -> None:
    """Chain the teams of each cell, lowest slot first."""
    for team in range(world.rules.robots - 1, -1, -1):
        if world.teams[team].size > 0:
            cell = cell_of(world, world.teams[team].x, world.teams[team].y)
            world.teams[team].next_here = world.cells[cell].first_team
            world.cells[cell].first_team = team


@kernel
def forget_cells(world: World) -> None:
    """Empty the lists again; call it before any team changes its cell."""
    for team in range(world.rules.robots):
        if world.teams[team].size > 0:
            cell = cell_of(world, world.teams[team].x, world.teams[team].y)
            world.cells[cell].first_team = NOBODY


@kernel
def cell_of(world: World, x: float, y: float) -> int:
    """Return the number of the cell at a place; what rounding puts past an edge counts as on it."""
    per_length = world.rules.cells_per_length
    column = max(0, min(int(x * per_length), world.rules.width - 1))
    row = max(0, min(int(y * per_length), world.rules.height - 1))
    return row * world.rules.width + column


@kernel
def cells_around(world: World, at: int, radius: float, count: int) -> tuple[Any, Any]:
    """Return the first and the last of `count` columns or rows that lie within a radius."""
    middle = int(at * world.rules.cells_per_length)
    reach = int(min(radius * world.rules.cells_per_length, count)) + world.rules.is_plane
    return max(0, middle - reach), min(count - 1, middle + reach)


@kernel
def find_near(world: World, team: int, radius: float) -> int:
    """Collect the other teams within a Euclidean radius in `world.near`; return how many.

    Looks at the cells around, or at all teams where these are fewer.
    """
    found = 0
    x, y = world.teams[team].x, world.teams[team].y
    left, right = cells_around(world, x, radius, world.rules.width)
    low, high = cells_around(world, y, radius, world.rules.height)
    if (right - left + 1) * (high - low + 1) > world.rules.robots:
        for other in range(world.rules.robots):
            is_other = other != team and world.teams[other].size > 0
            if is_other and distance_squared(world, team, other) <= radius * radius:
                world.near[found] = other
                found += 1
        return found
    for row in range(low, high + 1):
        for column in range(left, right + 1):
            other = world.cells[row * world.rules.width + column].first_team
            while other != NOBODY:
                if other != team and distance_squared(world, team, other) <= radius * radius:
                    world.near[found] = other
                    found += 1
                other = world.teams[other].next_here
    return found


@kernel
def find_tasks_here(world: World, team: int) -> int:
    """Collect the tasks that a team stands at in `world.here`; return how many."""
    found = 0
    radius = world.rules.arrival_radius
    left, right = cells_around(world, world.teams[team].x, radius, world.rules.width)
    low, high = cells_around(world, world.teams[team].y, radius, world.rules.height)
    for row in range(low, high + 1):
        for column in range(left, right + 1):
            task = world.cells[row * world.rules.width + column].first_task
            while task != NOBODY:
                if stands_at(world, team, task):
                    world.here[found] = task
                    found += 1
                task = world.tasks[task].next_here
    return found


@kernel
def stands_at(world: World, team: int, task: int) -> bool:
    """Say whether a team is in the place of a task."""
    return distance_squared_to(world, team, task) <= world.rules.arrival_radius**2


@kernel
def distance_squared(world: World, team: int, other: int) -> float:
    """Return the squared Euclidean distance between two teams."""
    away_x = world.teams[team].x - world.teams[other].x
    away_y = world.teams[team].y - world.teams[other].y
    return away_x * away_x + away_y * away_y


@kernel
def distance_squared_to(world: World, team: int, task: int) -> float:
    """Return the squared Euclidean distance from a team to a task."""
    away_x = world.teams[team].x - world.tasks[task].x
    away_y = world.teams[team].y - world.tasks[task].y
    return away_x * away_x + away_y * away_y
