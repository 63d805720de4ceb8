"""The `world` of a scenario file: a bare grid, rows of cells, or a map in another file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from teamformer.errors import TeamformerError
from teamformer.model import BLOCKED, FREE, Grid
from teamformer.scenarios.maps import LARGEST_MAP, read_movingai, read_ros_map
from teamformer.scenarios.reading import Reader

FORMS = {"grid": {"grid"}, "rows": {"rows", "y_axis"}, "map": {"map", "cell"}, "plane": {"plane"}}
WHERE = ("world",)
HARMLESS = Grid(1, 1)


def read_world(reader: Reader, value: Any, folder: Path | None) -> Grid:
    """Return the map; problems are noted in the reader. `folder` is where map files lie."""
    keys = dict.fromkeys(("grid", "rows", "y_axis", "map", "cell", "plane", "step"), False)
    world = reader.mapping(WHERE, value, keys)
    forms = [form for form in FORMS if form in world]
    if "plane" in forms:
        reader.refuse((*WHERE, "plane"), "planes are not supported yet; use a grid or a map")
    elif len(forms) != 1:
        if isinstance(value, dict):
            reader.refuse(WHERE, "the world needs one of grid: [w, h], rows: [...] and map: FILE")
    elif set(world) - FORMS[forms[0]]:
        extra = min(set(world) - FORMS[forms[0]])
        reader.refuse((*WHERE, extra), f"'{extra}' does not go with '{forms[0]}'; remove it")
    elif forms == ["grid"]:
        return _read_grid(reader, world["grid"])
    elif forms == ["rows"]:
        return _read_rows(reader, world)
    else:
        return _read_map(reader, world, folder)
    return HARMLESS


def _read_grid(reader: Reader, value: Any) -> Grid:
    where = (*WHERE, "grid")
    if not isinstance(value, list) or len(value) != 2:
        reader.refuse(where, "the grid is not a pair; write it as [width, height]")
        return HARMLESS
    width, height = (reader.whole((*where, axis), part, 1) for axis, part in enumerate(value))
    if width * height > LARGEST_MAP:
        reader.refuse(where, f"the grid has {width * height} cells; {LARGEST_MAP} are possible")
        return HARMLESS
    return Grid(width, height)


def _read_rows(reader: Reader, world: dict[str, Any]) -> Grid:
    where = (*WHERE, "rows")
    rows = tuple(row.replace("#", BLOCKED) for row in reader.names(where, world["rows"]))
    y_axis = reader.text((*WHERE, "y_axis"), world.get("y_axis", "down"))
    if y_axis not in ("up", "down"):
        reader.refuse((*WHERE, "y_axis"), f"y_axis is '{y_axis}'; write up or down")
        return HARMLESS
    if not rows:
        reader.refuse(where, "the map has no rows; write a text of cells for each")
        return HARMLESS
    for number, row in enumerate(rows):
        strange = sorted(set(row) - {FREE, BLOCKED})
        if strange:
            what = f"'{strange[0]}' is no cell; use '{FREE}' for free and '{BLOCKED}' for blocked"
            reader.refuse((*where, number), what)
        elif len(row) != len(rows[0]):
            what = f"this row has {len(row)} cells and the first {len(rows[0])}; make them alike"
            reader.refuse((*where, number), what)
    return Grid(len(rows[0]), len(rows), rows, "up" if y_axis == "up" else "down")


def _read_map(reader: Reader, world: dict[str, Any], folder: Path | None) -> Grid:
    where = (*WHERE, "map")
    name = reader.text(where, world["map"])
    cell = None if "cell" not in world else reader.number((*WHERE, "cell"), world["cell"])
    if folder is None:
        reader.refuse(where, "a map in another file cannot be read here; write its rows")
        return HARMLESS
    try:
        if name.endswith(".map"):
            if cell is not None:
                reader.refuse((*WHERE, "cell"), "a .map file has cells already; remove 'cell'")
            return read_movingai(folder / name)
        return read_ros_map(folder / name, cell)
    except TeamformerError as error:
        reader.refuse(where, f"the map cannot be used: {error}")
        return HARMLESS
