"""The keys of a zone."""

from __future__ import annotations

from teamformer.mission.keys.key import Key
from teamformer.mission.keys.kinds import Names, Places, Whole

MOST_ROOM = 1000
"""Services that go on in one zone at once."""

NEW = "0.2.0"

ZONE_KEYS = (
    Key(
        "area",
        Places(),
        "two corners, the one with the smaller coordinates first, as in `[[2, 3], [6, 8]]`: all "
        "tasks between them, and on the border, are in the zone",
        default=(),
        without="`tasks` or `places` say which are",
        since=NEW,
    ),
    Key(
        "tasks",
        Names(),
        "the names of the tasks in the zone",
        default=(),
        without="`area` or `places` say which are",
        since=NEW,
    ),
    Key(
        "places",
        Places(),
        "cells or points, on roads names of places: all tasks there are in the zone",
        default=(),
        without="`area` or `tasks` say which are",
        since=NEW,
    ),
    Key(
        "room",
        Whole(1, MOST_ROOM, is_checked_later=True),
        "how many services go on in the zone at once",
        default=1,
        since=NEW,
    ),
)
