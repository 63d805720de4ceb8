"""The keys of a world, by its form."""

from __future__ import annotations

from teamformer.mission.keys.key import Key
from teamformer.mission.keys.kinds import (
    KeyedPart,
    Number,
    OneOf,
    Origin,
    Rows,
    Sides,
    Tables,
    Text,
    Whole,
)
from teamformer.mission.parts.plane import LONGEST_SIDE, LONGEST_STEP, SHORTEST_STEP, SHORTEST_UNIT

FRAME_KEYS = (
    Key("cell", Number(0, is_above=True), "the side of a cell in metres"),
    Key(
        "origin",
        Origin(),
        "`[x, y, yaw]`: the lower left corner of the cell `[0, 0]` in metres, and the angle in "
        "radians by which the grid is turned about it",
        default=(0, 0, 0),
        without="`[0, 0, 0]`",
    ),
)

TURNED = (
    Key(
        "y_axis",
        OneOf(("up", "down")),
        "which way up a drawing shows the map: `up` or `down`",
        default=None,
        without="`up` beside `grid`, `down` beside `rows`",
    ),
    Key(
        "frame",
        KeyedPart(FRAME_KEYS),
        "where the grid lies in the metres of a map",
        default=None,
        without="nowhere",
    ),
)

PLANE_KEYS = (
    Key(
        "plane",
        Sides(Number(0, LONGEST_SIDE, is_above=True)),
        "width and height in metres, up to 100 km",
        example=[3.2, 2.0],
    ),
    Key(
        "step",
        Number(SHORTEST_STEP, LONGEST_STEP),
        "seconds that a step takes, 0.01 to 1000",
        default=1.0,
    ),
    Key(
        "arrival_radius",
        Number(0, LONGEST_SIDE),
        "two teams, or a team and a task, are in the same place if they are at most this far "
        "apart, in metres",
        default=0.05,
        without="0.05, or the way of the slowest robot in a step if that is less",
    ),
    Key(
        "unit",
        Number(SHORTEST_UNIT, LONGEST_SIDE),
        "the length in metres that a policy trained on grids takes for one cell",
        default=0.20,
        without="0.20",
    ),
)

FORMS = {
    "grid": (
        Key(
            "grid", Sides(Whole(1)), "a width and a height in cells, no obstacles", example=[24, 16]
        ),
        *TURNED,
    ),
    "rows": (
        Key(
            "rows",
            Rows(),
            "a map drawn in the file: `.` is free, `@` or `#` is blocked. The first row is y = 0",
            example=["..@.", "...."],
        ),
        *TURNED,
    ),
    "map": (
        Key("map", Text(), "a MovingAI map or a ROS map_server map, beside this file"),
        Key(
            "cell",
            Number(0, is_above=True),
            "the side of a cell in metres, a multiple of the map's resolution",
            default=None,
            without="the map's resolution",
        ),
    ),
    "plane": PLANE_KEYS,
    "roads": (
        Key(
            "roads",
            Tables(),
            "a table that says how long the ways between named places take, or one for each way "
            "of moving, in continuous time only",
            example="clinic.csv",
        ),
    ),
}
"""Keys by the one that names the form."""
