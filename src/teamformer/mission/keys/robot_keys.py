"""The keys of a robot."""

from __future__ import annotations

from teamformer.mission.keys.charging_keys import BATTERY_KEYS, NEW
from teamformer.mission.keys.key import (
    CONTINUOUS,
    ROBOTARIUM,
    Key,
    Unknown,
)
from teamformer.mission.keys.kinds import (
    LARGEST_NUMBER,
    LATEST_RETURN,
    Counts,
    KeyedPart,
    Moments,
    Moves,
    Number,
    Place,
    Range,
    Shifts,
    Text,
    Time,
    Whole,
)
from teamformer.mission.parts.roads import AIR, GROUND

SLOWEST, FASTEST = 0.001, 1000
"""Cells a step, on a plane metres a second: others would overflow the step counts."""

MOST_ALIKE = 1000
"""Robots that one entry of a file stands for."""

NOT_KNOWN = "([what is not known](mission/unknown.md))"

BREAKS_KEYS = (
    Key(
        "rate",
        Number(0, 1),
        "the probability that the robot breaks down in a step; in continuous time how often it "
        "does so in a unit of time",
    ),
    Key(
        "repair",
        Range(1),
        "the least and the most steps until it is back, every whole number equally likely; in "
        "continuous time every time between them",
        default=None,
        without="it is lost for good",
    ),
)

DELAYS_KEYS = (
    Key(
        "chance",
        Number(0, 1, is_below=True),
        "the probability that it stands still in a step; in continuous time in a whole unit",
    ),
    Key("seed", Whole(), "decides in which steps it stands still, the same ones in every trial"),
)

ROBOT_KEYS = (
    Key(
        "name",
        Text(),
        "a name that no other robot has",
        default="",
        without="`r1`, `r2`, ... by place in the list",
    ),
    Key(
        "at",
        Place(),
        "where the robot starts: a cell `[x, y]`; on a plane a point in metres; on roads the name "
        "of a place",
        example=[2, 3],
    ),
    Key(
        "can",
        Counts(),
        "its capabilities: a list of names, or counts as in `{scan: 1, power: 2}`; counts may be "
        "[fractions](mission/tasks.md#fractions)",
        example=["lift"],
    ),
    Key(
        "speed",
        Number(SLOWEST, FASTEST),
        "cells per step, 0.001 to 1000; on a plane metres per second; on roads a factor: 2 halves "
        "all times. A team is as fast as its slowest robot",
        default=1.0,
        label="Speed",
    ),
    Key(
        "lost",
        Moments(1, LARGEST_NUMBER),
        "the step from which the robot is out of the mission; the first step is 1. So `lost: 15` "
        "is 14 steps after the start. In continuous time it is a time after the start. The mission "
        "stops then if some task can never be done any more, even if others could; `cancelled` "
        "calls a task off. A list if it is lost more than once",
        default=(),
        without="never",
        label="Lost in steps",
        unknown=Unknown((CONTINUOUS,), "is lost", field="absences"),
    ),
    Key(
        "back",
        Moments(2, LATEST_RETURN),
        "the step from which a lost robot takes part again, alone and where it was lost. A list "
        "if `lost` is one, as in `lost: [9, 40], back: [20]`",
        default=(),
        without="never",
        label="Back in steps",
    ),
    Key(
        "breaks",
        KeyedPart(BREAKS_KEYS, makes="Breakdown"),
        f"`{{rate: 0.001, repair: [10, 40]}}`: random breakdowns {NOT_KNOWN}",
        default=None,
        without="it does not break down",
        unknown=Unknown((ROBOTARIUM,), "may break down", is_surprise=True),
    ),
    Key(
        "delays",
        KeyedPart(DELAYS_KEYS, makes="Delays", alone="chance"),
        f"the probability that it stands still in a step {NOT_KNOWN}",
        default=None,
        without="0",
        label="Stands still (0 to 1)",
        unknown=Unknown((ROBOTARIUM,), "may stand still", is_surprise=True),
    ),
    Key(
        "moves",
        Moves((GROUND, AIR)),
        "`ground`, or `air` if obstacles do not stop it "
        "([robots that fly](mission/world.md#robots-that-fly)); on [roads](mission/world.md#roads) "
        "it says which of the tables the robot uses",
        default=GROUND,
        label="Flies",
    ),
    Key(
        "battery",
        KeyedPart(BATTERY_KEYS, makes="Battery"),
        "`{lasts: 300, fills: 60}`: what it has to spend before it has to charge "
        "([batteries and chargers](mission/charging.md))",
        default=None,
        without="it never has to charge",
        since=NEW,
        unknown=Unknown((ROBOTARIUM,), "has a battery"),
    ),
    Key(
        "count",
        Whole(1, MOST_ALIKE),
        "the number of robots with these properties, all at the same place. They are named "
        "`cart-1`, `cart-2`, ...; a name may have 200 letters, number included",
        default=None,
        without="1, with its own name",
    ),
    Key(
        "note",
        Text(),
        "a text for people, which pages and tables show with the robot",
        default="",
        without="none",
        label="Note",
        is_in_details=True,
        since="0.2.0",
    ),
    Key(
        "shifts",
        Shifts(),
        "when the robot works: `[[0, 480], [540, 960]]` ([shifts](mission/time.md#shifts))",
        default=(),
        without="always",
        since="0.2.0",
        example=[[0, 480], [540, 960]],
        unknown=Unknown((ROBOTARIUM,), "works in shifts"),
    ),
    Key(
        "every",
        Time(is_above=True),
        "after how long its shifts come again, and again; 1440 is a day of minutes",
        default=0.0,
        without="they do not come again",
        since="0.2.0",
    ),
)

NOT_ALIKE = {
    "lost": "absences have it",
    "back": "absences have it",
    "absences": "lost and back say them",
    "count": "becomes so many robots",
}
"""Keys without a field of their own in the model, and fields without a key: why."""
