"""`teamformer view MAP`: the free cells of a mission's map, or of a map alone, as text."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from teamformer.base.errors import MissionError, TeamformerError
from teamformer.base.file_access import read_text
from teamformer.cli.terminal.console import out, say
from teamformer.files.maps.formats import is_map, read_map
from teamformer.files.mission_files import read_mission, read_world_of
from teamformer.mission.model import World
from teamformer.mission.parts.grid import BLOCKED, FREE, Grid, Place
from teamformer.mission.parts.roads import Roads

LARGEST = 10_000_000  # bytes
HINT = "name a mission, or a map: a .map or a map_server .yaml file"

TENTH = 10
"""Every so many columns and rows one has its number."""


def draw_map(path: Path) -> int:
    """Print the map in a file with the numbers of its columns and rows; return the exit status."""
    if is_map(path.name, read_text(path, LARGEST, HINT)):
        grid: World = read_map(path)
        name, marks = path.stem, dict[Place, str]()
    else:
        grid, name, marks = _of_mission(path)
    if isinstance(grid, Roads):
        hint = "`teamformer plan MISSION --out DIR` draws a plan as a Gantt chart"
        raise TeamformerError(f"{path}: its world is of roads, which have no map", hint)
    if not isinstance(grid, Grid):
        raise TeamformerError(
            f"{path}: its world is a plane, which has no cells",
            "every point that is not inside an obstacle is free",
        )
    for line in lines_of(grid, name, marks):
        out.print(line, markup=False, highlight=False, soft_wrap=True)
    return 0


def _of_mission(path: Path) -> tuple[World, str, dict[Place, str]]:
    """Return a mission's world, its name, and the signs of its tasks and robots by their places.

    What is wrong with these is said, and then there are no signs: the map is there to mend them.
    """
    try:
        mission = read_mission(path)
    except MissionError as error:
        world = read_world_of(path)
        say(str(error))
        return world, path.stem, {}
    marks = {task.at: "t" for task in mission.tasks}
    return mission.world, mission.name, marks | {robot.at: "r" for robot in mission.robots}


def lines_of(grid: Grid, name: str, marks: Mapping[Place, str]) -> list[str]:
    """Return a map in lines: what it is, the numbers of columns, its rows from the top."""
    rows = grid.rows or (FREE * grid.width,) * grid.height
    free = sum(row.count(FREE) for row in rows)
    wide = len(str(grid.height - 1))
    numbers = "".join(f"{x:<{TENTH}}" for x in range(0, grid.width, TENTH))
    drawn = []
    for y, row in enumerate(rows):
        cells = (marks.get((x, y), FREE if cell == FREE else BLOCKED) for x, cell in enumerate(row))
        drawn.append(f"{y:>{wide}} {''.join(cells)}")
    signs = f"{FREE} free, {BLOCKED} blocked" + (", r robot, t task" if marks else "")
    return [
        f"{name}: {grid.width} x {grid.height} cells, {free} free ({signs})",
        f"{'':{wide}} {numbers.rstrip()}",
        *(reversed(drawn) if grid.y_axis == "up" else drawn),
    ]
