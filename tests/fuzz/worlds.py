"""Small worlds as they stand in files, and the places in them that somebody can be at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from drawing import now_and_then, pick
from teamformer.mission.parts.grid import Grid

Place = list[float] | str

SIDES = st.integers(1, 7)
CENTIMETRES = st.integers(0, 600)
WALLS = st.integers(0, 2**42 - 1)
STEPS, ARRIVAL_RADII, UNITS = (1, 0.5, 0.2), (0.05, 0, 0.2, 1.0, 3.0), (0.2, 0.1, 0.5)
WAYS = (1, 0, 2.5, 7, 0.125, 30)
FRAME = {"cell": 0.25, "origin": [-1.5, 2.0, 0.1]}


@dataclass(frozen=True)
class Drawn:
    """A world of a file, places where somebody can be, and the connected parts of a map.

    Places are as they stand in the file: `[x, y]`, on roads names. `movers` is of roads.
    """

    tree: dict[str, Any]
    places: Sequence[Place]
    blocked: Sequence[Place] = ()
    parts: Sequence[int] = ()  # of the places
    unit: float = 1.0
    movers: Sequence[str] = ()

    def part(self, place: Place) -> int:
        """Return the connected part of the world that a place lies in."""
        return self.parts[self.places.index(place)] if self.parts else 0


def draw_world(draw: st.DrawFn, can_be_roads: bool = False) -> Drawn:
    """Return a grid without walls or with them, a plane, or roads where they may be."""
    worlds = (open_grid, walled_grid, plane)
    return pick(draw, (*worlds, roads) if can_be_roads else worlds)(draw)


def open_grid(draw: st.DrawFn) -> Drawn:
    """Return a grid without walls."""
    width, height = draw(SIDES), draw(SIDES)
    cells = [[x, y] for y in range(height) for x in range(width)]
    return Drawn({"grid": [width, height], **_drawn_as(draw)}, cells)


def walled_grid(draw: st.DrawFn) -> Drawn:
    """Return a grid with walls, of which some parts may be cut off."""
    width, height = draw(SIDES), min(6, draw(SIDES))
    walls = draw(WALLS) & draw(WALLS)  # a quarter of the cells
    cells = [[x, y] for y in range(height) for x in range(width)]
    is_free = [not walls >> number & 1 or number == 0 for number in range(len(cells))]
    mark = pick(draw, "@#")
    rows = [
        "".join("." if is_free[y * width + x] else mark for x in range(width))
        for y in range(height)
    ]
    grid = Grid(width, height, tuple(row.replace("#", "@") for row in rows))
    free = [cell for cell, is_open in zip(cells, is_free, strict=True) if is_open]
    blocked = [cell for cell, is_open in zip(cells, is_free, strict=True) if not is_open]
    parts = [grid.region((cell[0], cell[1])) for cell in free]
    value: Any = "\n".join(rows) if now_and_then(draw) else rows
    return Drawn({"rows": value, **_drawn_as(draw)}, free, blocked, parts)


def plane(draw: st.DrawFn) -> Drawn:
    """Return a plane with points in it, some at corners, some hardly apart."""
    width, height = (max(30, draw(CENTIMETRES)) for _ in range(2))
    tree: dict[str, Any] = {"plane": [width / 100, height / 100]}
    for key, values in (("step", STEPS), ("arrival_radius", ARRIVAL_RADII), ("unit", UNITS)):
        if now_and_then(draw, 3):
            tree[key] = pick(draw, values)
    points = [(draw(CENTIMETRES) % (width + 1), draw(CENTIMETRES) % (height + 1)) for _ in range(4)]
    points += [(min(width, points[0][0] + 4), points[0][1]), (width, points[1][1]), (0, 0)]
    places = [[x / 100, y / 100] for x, y in points]
    return Drawn(tree, places, unit=tree.get("unit", 0.2))


def roads(draw: st.DrawFn) -> Drawn:
    """Return roads as a text, some by air too; ways back may differ, and detours be shorter.

    Some direct ways are not there, but never those from each place to the next, and round.
    """
    names = [f"p{number}" for number in range(1 + draw(SIDES))]
    tables = {}
    for mover in ("ground", "air")[: 1 + now_and_then(draw, 2)]:
        rows = [",".join(["from", *names])]
        has_gaps = now_and_then(draw)
        for number, name in enumerate(names):
            after = names[(number + 1) % len(names)]
            times = ["0" if other == name else f"{pick(draw, WAYS):g}" for other in names]
            if has_gaps:
                is_kept = [other == after or now_and_then(draw, 2) for other in names]
                times = [time if kept else "" for time, kept in zip(times, is_kept, strict=True)]
            rows.append(",".join([name, *times]))
        tables[mover] = "\n".join([*rows, ""])
    is_one = len(tables) == 1
    return Drawn({"roads": tables["ground"] if is_one else tables}, names, movers=tuple(tables))


def _drawn_as(draw: st.DrawFn) -> dict[str, Any]:
    told: dict[str, Any] = {}
    if now_and_then(draw):
        told["y_axis"] = pick(draw, ("up", "down"))
    if now_and_then(draw, 8):
        told["frame"] = FRAME
    return told
