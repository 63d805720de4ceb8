"""Who is near whom: teams listed by cell, so that looking around costs what is there."""

from __future__ import annotations

from teamformer.jit import kernel
from teamformer.sim.arrays import NOBODY


@kernel
def list_teams_by_cell(world):  # type: ignore[no-untyped-def]
    """Chain the teams of each cell, lowest slot first."""
    for team in range(world.rules.robots - 1, -1, -1):
        if world.teams[team].size > 0:
            cell = cell_of(world, world.teams[team].x, world.teams[team].y)
            world.teams[team].next_here = world.cells[cell].first_team
            world.cells[cell].first_team = team


@kernel
def forget_cells(world):  # type: ignore[no-untyped-def]
    """Empty the lists again; call it before any team changes its cell."""
    for team in range(world.rules.robots):
        if world.teams[team].size > 0:
            cell = cell_of(world, world.teams[team].x, world.teams[team].y)
            world.cells[cell].first_team = NOBODY


@kernel
def cell_of(world, x, y):  # type: ignore[no-untyped-def]
    """Return the number of the cell at a place."""
    return int(y) * world.rules.width + int(x)


@kernel
def find_near(world, team, radius):  # type: ignore[no-untyped-def]
    """Collect the other teams within a Euclidean radius in `world.near`; return how many.

    Looks at the cells around, or at all teams where these are fewer.
    """
    found = 0
    x, y = world.teams[team].x, world.teams[team].y
    reach = int(min(radius, world.rules.width + world.rules.height))
    if (2 * reach + 1) ** 2 > world.rules.robots:
        for other in range(world.rules.robots):
            is_other = other != team and world.teams[other].size > 0
            if is_other and distance_squared(world, team, other) <= radius * radius:
                world.near[found] = other
                found += 1
        return found
    for cell_y in range(max(0, int(y) - reach), min(world.rules.height, int(y) + reach + 1)):
        for cell_x in range(max(0, int(x) - reach), min(world.rules.width, int(x) + reach + 1)):
            other = world.cells[cell_y * world.rules.width + cell_x].first_team
            while other != NOBODY:
                if other != team and distance_squared(world, team, other) <= radius * radius:
                    world.near[found] = other
                    found += 1
                other = world.teams[other].next_here
    return found


@kernel
def distance_squared(world, team, other):  # type: ignore[no-untyped-def]
    """Return the squared Euclidean distance between two teams."""
    away_x = world.teams[team].x - world.teams[other].x
    away_y = world.teams[team].y - world.teams[other].y
    return away_x * away_x + away_y * away_y
