"""Pictures of worlds for learners: as text, and as pixels."""

from __future__ import annotations

import numpy as np

from teamformer.base.array_types import Array
from teamformer.base.errors import TeamformerError
from teamformer.mission.parts.grid import BLOCKED, Grid
from teamformer.world.env import TeamFormation
from teamformer.world.rules.constants import NOBODY

RENDER_MODES = ("ansi", "rgb_array")

CELL = 12
"""Pixels of a cell."""

MOST_CELLS = 60
"""Cells that a plane is drawn in, along its longer side."""

GROUND, WALL = (255, 255, 255), (90, 90, 90)
OPEN, SERVED = (214, 140, 40), (60, 150, 90)
TEAM, JOINED = (40, 90, 200), (120, 40, 160)


def draw_text(env: TeamFormation, w: int = 0) -> str:
    """Return a world as lines of text, the top first.

    A cell shows the number of robots there (`+` for more than nine), `o` for an open task, `*` for
    one that is being served, `#` for a wall, else a dot. Robots hide tasks.
    """
    pictured = _cells(env, w)
    signs = {1: "#", 2: "o", 3: "*"}
    rows = []
    for ground, robots in zip(*pictured, strict=True):
        both = zip(ground.tolist(), robots.tolist(), strict=True)
        rows.append(
            "".join(_sign(count) if count else signs.get(what, ".") for what, count in both)
        )
    tally = env.tally(w)
    return "\n".join([*rows, f"step {tally.steps}: {tally.tasks_done} tasks done"])


def draw_pixels(env: TeamFormation, w: int = 0) -> Array:
    """Return a world as pixels (height, width, 3) uint8, the top first.

    Tasks fill their cells; teams are squares in them, of another colour where there are several
    robots.
    """
    ground, robots = _cells(env, w)
    colours = np.array([GROUND, WALL, OPEN, SERVED], np.uint8)
    picture: Array = np.kron(colours[ground], np.ones((CELL, CELL, 1), np.uint8))
    edge = CELL // 4
    for y, x in np.argwhere(robots > 0).tolist():
        square = slice(y * CELL + edge, (y + 1) * CELL - edge)
        across = slice(x * CELL + edge, (x + 1) * CELL - edge)
        picture[square, across] = TEAM if robots[y, x] == 1 else JOINED
    return picture


def _sign(count: int) -> str:
    return str(count) if count < 10 else "+"


def _cells(env: TeamFormation, w: int) -> tuple[Array, Array]:
    """Return what is in each cell: 0 nothing, 1 a wall, 2 a task, 3 a served one; and robots.

    Both are (rows, columns), the top row first.
    """
    world, worlds = env.missions[w].world, env.worlds
    far_x, far_y = world.corner
    is_grid = isinstance(world, Grid)
    scale = 1.0 if is_grid else (MOST_CELLS - 1) / max(far_x, far_y)
    shape = int(far_y * scale) + 1, int(far_x * scale) + 1
    ground, robots = np.zeros(shape, np.int64), np.zeros(shape, np.int64)
    if isinstance(world, Grid) and world.rows:
        is_wall = np.array([[cell == BLOCKED for cell in row] for row in world.rows])
        ground[: is_wall.shape[0], : is_wall.shape[1]][is_wall] = 1
    for task in worlds.tasks[w][worlds.tasks[w]["is_open"]]:
        cell = int(task["y"] * scale), int(task["x"] * scale)
        ground[cell] = 2 if task["server"] == NOBODY else 3
    for team in worlds.teams[w][worlds.teams[w]["size"] > 0]:
        robots[int(team["y"] * scale), int(team["x"] * scale)] += team["size"]
    if isinstance(world, Grid) and world.y_axis == "down":
        return ground, robots
    return ground[::-1], robots[::-1]


def check_render_mode(mode: str | None) -> str | None:
    """Return a way to render, None for none; raises `TeamformerError` for one that there is not."""
    if mode is not None and mode not in RENDER_MODES:
        raise TeamformerError(f"render_mode is '{mode}'", f"use {' or '.join(RENDER_MODES)}")
    return mode


def draw(env: TeamFormation, mode: str | None, w: int = 0) -> str | Array | None:
    """Return a world as text or pixels, None without a mode."""
    if mode is None:
        return None
    return draw_text(env, w) if mode == "ansi" else draw_pixels(env, w)
