"""The `world` of a mission file: a grid, rows of cells, a map in another file, a plane, or roads.

And where something is in it: `read_at`.
"""

from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any, Literal

from teamformer.base.errors import TeamformerError
from teamformer.base.file_access import read_text
from teamformer.files.maps.formats import read_map, read_origin
from teamformer.files.maps.road_tables import LARGEST_FILE, parse_times
from teamformer.files.yaml.reader import Where
from teamformer.files.yaml.tree_reader import Reader, name_of
from teamformer.files.yaml.words import describe, shorten
from teamformer.mission.keys.world_keys import FORMS, FRAME_KEYS, PLANE_KEYS
from teamformer.mission.model import World
from teamformer.mission.parts.frame import Frame
from teamformer.mission.parts.grid import BLOCKED, FREE, LARGEST_MAP, Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.roads import GROUND, Roads, Rows

KEYS = dict.fromkeys(sorted({key.name for form in FORMS.values() for key in form}), False)
WHERE = ("world",)
STAND_IN = Grid(1, 1)
"""Read instead of a world that is wrong, so that reading can go on."""


def read_world(reader: Reader, value: Any, folder: Path | None) -> World:
    """Return the map; problems are noted in the reader. `folder` is where map files lie."""
    world = reader.mapping(WHERE, value, KEYS)
    forms = [form for form in FORMS if form in world]
    if len(forms) != 1:
        if isinstance(value, dict):
            choice = "grid: [width, height], rows: [...], map: FILE, plane: [width, height]"
            reader.refuse(WHERE, f"the world needs exactly one of {choice} and roads: FILE")
        return STAND_IN
    for extra in sorted(set(world) - {key.name for key in FORMS[forms[0]]}):
        reader.refuse((*WHERE, extra), f"'{extra}' does not go with '{forms[0]}'; remove it")
    if forms == ["grid"]:
        return _read_grid(reader, world)
    if forms == ["rows"]:
        return _read_rows(reader, world)
    if forms == ["map"]:
        return _read_map(reader, world, folder)
    if forms == ["roads"]:
        return _read_roads(reader, world["roads"], folder)
    return _read_plane(reader, world)


def _read_grid(reader: Reader, world: dict[str, Any]) -> Grid:
    where, size = (*WHERE, "grid"), world["grid"]
    if not isinstance(size, list) or len(size) != 2:
        reader.refuse(where, "the grid is not a pair; write it as [width, height]")
        return STAND_IN
    width, height = (reader.whole((*where, axis), part, 1) for axis, part in enumerate(size))
    if not _is_possible(reader, "grid", width * height):
        return STAND_IN
    return Grid(
        width, height, y_axis=_read_y_axis(reader, world, "up"), frame=_read_frame(reader, world)
    )


def _read_rows(reader: Reader, world: dict[str, Any]) -> Grid:
    where, value = (*WHERE, "rows"), world["rows"]
    y_axis = _read_y_axis(reader, world, "down")
    parts = value.split() if isinstance(value, str) else value  # a block of text will do
    texts = reader.names(where, parts, longest=LARGEST_MAP)
    rows = tuple(row.replace("#", BLOCKED) for row in texts)
    if not rows:
        reader.refuse(where, "the map has no rows; write a text of cells for each")
        return STAND_IN
    for number, row in enumerate(rows):
        strange = sorted(set(row) - {FREE, BLOCKED, "?"})
        if strange:
            what = f"'{strange[0]}' is no cell; use '{FREE}' for free and '{BLOCKED}' for blocked"
            reader.refuse((*where, number), f"row {number + 1}: {what}")
        elif len(row) != len(rows[0]):
            what = f"{len(row)} cells, but the first has {len(rows[0])}; make them alike"
            reader.refuse((*where, number), f"row {number + 1} has {what}")
    if not _is_possible(reader, "rows", sum(map(len, rows))):
        return STAND_IN
    return Grid(len(rows[0]), len(rows), rows, y_axis, _read_frame(reader, world))


def _read_frame(reader: Reader, world: dict[str, Any]) -> Frame | None:
    if "frame" not in world:
        return None
    where = (*WHERE, "frame")
    said = reader.mapping(where, world["frame"], {key.name: key.is_required for key in FRAME_KEYS})
    cell = reader.number((*where, "cell"), said.get("cell", 1.0))
    return Frame(cell, *read_origin(reader, (*where, "origin"), said.get("origin", [0, 0, 0])))


def _read_map(reader: Reader, world: dict[str, Any], folder: Path | None) -> Grid:
    where = (*WHERE, "map")
    name = reader.text(where, world["map"])
    cell = reader.number((*WHERE, "cell"), world["cell"]) if "cell" in world else None
    if folder is None:
        reader.refuse(where, "a map in another file cannot be read here; write its rows")
    elif reader.is_faithful:
        try:
            return read_map(folder / name, cell)
        except TeamformerError as error:
            hint = f"; {error.hint}" if error.hint else ""
            reader.refuse(where, f"{error}{hint}")
    return STAND_IN


def _read_plane(reader: Reader, world: dict[str, Any]) -> Plane:
    where, size = (*WHERE, "plane"), world["plane"]
    if not isinstance(size, list) or len(size) != 2:
        reader.refuse(where, "the plane is not a pair; write it as [width, height], in metres")
        size = [1, 1]
    width, height = (reader.number((*where, axis), part) for axis, part in enumerate(size))
    more = [key.name for key in PLANE_KEYS if key.name in world and key.name != "plane"]
    given = {key: reader.number((*WHERE, key), world[key]) for key in more}
    return Plane(width, height, **given)


def _read_roads(reader: Reader, value: Any, folder: Path | None) -> Roads:
    """Return roads by a table, or one for each mover; they have no places if they are wrong."""
    where, places = (*WHERE, "roads"), tuple[str, ...]()
    times: dict[str, Rows] = {}
    tables = value if isinstance(value, dict) else {GROUND: value}
    if not tables:
        reader.refuse(where, "the roads name no file; name one, or one for each kind of mover")
    for key, table in tables.items():
        at = (*where, key) if isinstance(value, dict) else where
        mover = reader.text(at, key)
        if not isinstance(table, str):
            remedy = "name a file, or write the table as a text of lines"
            reader.refuse(at, f"{name_of(at)} is {describe(table)}; {remedy}")
        elif read := _read_table(reader, at, table, folder):
            if times and read[0] != places:
                other = next(iter(times))
                message = f"the places of {mover} are not those of {other}"
                reader.refuse(at, f"{message}; name them alike, in one order")
            places, times[mover] = read
    return Roads(places, times) if len(times) == len(tables) else Roads((), {})


def _read_table(
    reader: Reader, at: Where, table: str, folder: Path | None
) -> tuple[tuple[str, ...], Rows] | None:
    """Return the places and times of a table, the name of a file or the text of one."""
    text, name = table, f"{name_of(at)}, line "
    try:
        if "\n" not in table:
            if folder is None:
                remedy = "write the table as a text of lines"
                raise TeamformerError("roads in another file cannot be read here", remedy)
            text = read_text(folder / table, LARGEST_FILE, "name a table beside this file")
            name = f"{table}:"
        return parse_times(text, lambda line: f"{name}{line}:")
    except TeamformerError as error:
        reader.refuse(at, f"{error}; {error.hint}" if error.hint else str(error))
        return None


def _read_y_axis(
    reader: Reader, world: dict[str, Any], usual: Literal["up", "down"]
) -> Literal["up", "down"]:
    match world.get("y_axis", usual):
        case "up":
            return "up"
        case "down":
            return "down"
        case other:
            reader.refuse((*WHERE, "y_axis"), f"y_axis is {describe(other)}; write up or down")
            return usual


def _is_possible(reader: Reader, key: str, cells: int) -> bool:
    if cells > LARGEST_MAP:
        most = f"{LARGEST_MAP:,} are possible, so use larger cells"
        reader.refuse((*WHERE, key), f"the map has {cells:,} cells; {most}")
    return cells <= LARGEST_MAP


def read_at(reader: Reader, where: Where, value: Any, world: World) -> Place:
    """Return where something is: `[x, y]`, on roads the name of a place."""
    if not isinstance(world, Roads):
        return reader.place(where, value, isinstance(world, Plane))
    if not world.places:  # roads that are wrong were told
        return 0, 0
    if isinstance(value, list | dict):
        reader.refuse(where, f"{name_of(where)} is {describe(value)}; on roads name a place")
        return 0, 0
    name = reader.text(where, value)
    if name in world.places:
        return world.at(name)
    near = difflib.get_close_matches(name, world.places, 1)
    remedy = f"did you mean '{near[0]}'?" if near else "name a place that has a row there"
    reader.refuse(where, f"{name_of(where)} is '{shorten(name)}', which is on no road; {remedy}")
    return 0, 0
