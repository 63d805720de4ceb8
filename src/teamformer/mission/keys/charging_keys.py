"""The keys of a battery and of a charger."""

from __future__ import annotations

from teamformer.mission.keys.key import Key
from teamformer.mission.keys.kinds import LARGEST_NUMBER, Number, Place, Whole

MOST_SPENT = 1000
"""How much more than walking serving or waiting may take at most."""

MOST_ROOM = 1000
"""Robots that charge at one charger at once."""

NEW = "0.2.0"

BATTERY_KEYS = (
    Key(
        "lasts",
        Number(0, LARGEST_NUMBER, is_above=True),
        "how long the robot walks with a full battery, alone and at its own speed",
        since=NEW,
    ),
    Key(
        "fills",
        Number(0, LARGEST_NUMBER),
        "how long it takes from empty to full",
        since=NEW,
    ),
    Key(
        "starts",
        Number(0, 1),
        "the share of a full battery that it starts with",
        default=1.0,
        since=NEW,
    ),
    Key(
        "serving",
        Number(0, MOST_SPENT),
        "what a unit of time at a task takes, beside a unit of walking",
        default=0.0,
        since=NEW,
    ),
    Key(
        "waiting",
        Number(0, MOST_SPENT),
        "what a unit of time takes in which it waits or forms at a task, beside a unit of walking",
        default=0.0,
        since=NEW,
    ),
)

CHARGER_KEYS = (
    Key(
        "at",
        Place(),
        "the cell or point `[x, y]` where the charger is; on roads the name of a place",
        since=NEW,
    ),
    Key(
        "room",
        Whole(1, MOST_ROOM, is_checked_later=True),
        "how many robots charge there at once; others queue",
        default=1,
        since=NEW,
    ),
)
