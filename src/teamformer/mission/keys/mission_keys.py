"""The keys of the mission file itself, and of its cost and its arrivals."""

from __future__ import annotations

from teamformer.mission.keys.charging_keys import CHARGER_KEYS, NEW
from teamformer.mission.keys.key import FLEETS, ROBOTARIUM, STEPS, Key, Unknown
from teamformer.mission.keys.kinds import (
    LARGEST_NUMBER,
    Either,
    Forms,
    KeyedPart,
    KeyedParts,
    NamedParts,
    Names,
    Number,
    OneOf,
    Place,
    TeamLists,
    Text,
    Time,
    Whole,
)
from teamformer.mission.keys.robot_keys import NOT_KNOWN, ROBOT_KEYS
from teamformer.mission.keys.task_keys import (
    CONTINUOUS_TIME,
    LARGEST_WEIGHT,
    SMALLEST_WEIGHT,
    TASK_KEYS,
)
from teamformer.mission.keys.world_keys import FORMS
from teamformer.mission.keys.zone_keys import ZONE_KEYS

VERSION = 1

TIMES = ("steps", "continuous")
HOME = "home"

LONGEST_ARRIVALS = 10_000
"""Steps: the room for all that may appear is made at the start."""

WEIGHT = Number(SMALLEST_WEIGHT, LARGEST_WEIGHT)

COST_KEYS = (
    Key("makespan", WEIGHT, "when the mission is over", None),
    Key(
        "travel",
        WEIGHT,
        "the time that all robots together spend on their ways, the ways home included",
        None,
    ),
    Key("tardiness", WEIGHT, "how late tasks are, added up", None),
    Key("max_tardiness", WEIGHT, "how late the latest task is", None),
    Key("completion", WEIGHT, "when tasks end, added up", None),
    Key(
        "missed",
        WEIGHT,
        "optional tasks that were not done, added up by weight",
        None,
        since="0.2.0",
    ),
)

ARRIVALS_KEYS = (
    Key(
        "rate",
        Number(0, 1),
        "the probability that a task appears after a step, in continuous time after a whole unit",
    ),
    Key(
        "until",
        Whole(0, LONGEST_ARRIVALS, is_checked_later=True),
        "after so many steps no more appear",
    ),
    Key(
        "needs",
        Whole(1),
        "the most capabilities that one of them needs",
        default=0,
        without="all that robots bring",
        held_as="most_needs",
    ),
    Key("duration", Whole(0, is_checked_later=True), "steps that each of them takes", default=0),
    Key(
        "since",
        Whole(0, LONGEST_ARRIVALS, is_checked_later=True),
        "none appear before so many steps are made",
        default=0,
    ),
)

RADIUS = Number(0, can_be_infinite=True)

MISSION_KEYS = (
    Key("teamformer", Whole(1, VERSION), "version of this format: 1"),
    Key("name", Text(), "name of the mission", default="", without="the file's name"),
    Key("world", Forms(FORMS), "the map ([the world](mission/world.md))"),
    Key(
        "capabilities",
        Names(),
        "the names of all capabilities",
        example=["lift", "scan"],
    ),
    Key(
        "robots", KeyedParts(ROBOT_KEYS), "a list of at least one robot ([keys](#keys-of-a-robot))"
    ),
    Key("tasks", KeyedParts(TASK_KEYS), "a list of at least one task ([keys](#keys-of-a-task))"),
    Key(
        "teams",
        TeamLists(),
        "lists of robots that start as one team, by name as for `only`; they must start at the "
        "same cell or point",
        default=(),
        without="every robot starts alone",
    ),
    Key(
        "sensing_radius",
        RADIUS,
        "how far a team sees other teams, in cells or metres, Euclidean; `.inf` is everybody",
        default=1.0,
        is_always_written=True,
    ),
    Key(
        "join_radius",
        RADIUS,
        "how far away a team may be that another one joins; at most `sensing_radius`",
        default=0.0,
        without="0: the same place",
        is_always_written=True,
    ),
    Key(
        "forming_steps",
        Whole(0, 1, is_checked_later=True),
        "steps that a split or join costs: 1 or 0",
        default=1,
        is_always_written=True,
    ),
    Key(
        "step_limit",
        Whole(1),
        "steps after which a trial counts as failed",
        default=0,
        without="the sum described [below the table](#the-default-step-limit)",
        is_always_written=True,
    ),
    Key(
        "time",
        OneOf(TIMES),
        f"`steps` or `continuous` {CONTINUOUS_TIME}",
        default="steps",
    ),
    Key(
        "ends",
        Either(OneOf((HOME,)), Place()),
        "in continuous time, when the mission is over: `home`, when every robot is back where it "
        "started; or `[x, y]` (on roads the name of a place), when all robots are there",
        default=None,
        without="with its last task",
        unknown=Unknown((STEPS,), "in steps missions end with the last task"),
    ),
    Key(
        "forming",
        Number(0, LARGEST_NUMBER),
        "in continuous time, how long it takes to form a coalition whose robots do not come "
        "together from one place",
        default=0.0,
        unknown=Unknown((STEPS,), "in steps forming_steps says what forming takes"),
    ),
    Key(
        "cost",
        KeyedPart(COST_KEYS),
        f"what plans minimise, such as `{{makespan: 1, tardiness: 2}}` {CONTINUOUS_TIME}",
        default=None,
        without="the makespan or, if tasks have windows, `{makespan: 1, tardiness: 2}`",
    ),
    Key(
        "finding_radius",
        RADIUS,
        "a task with `within` is found by a team this near to it, Euclidean, in cells or metres; "
        "on roads by a team in its place; `.inf` is everywhere",
        default=1.0,
    ),
    Key(
        "arrivals",
        KeyedPart(ARRIVALS_KEYS, makes="Arrivals"),
        f"`{{rate: 0.05, until: 60}}`: tasks that appear at random {NOT_KNOWN}",
        default=None,
        without="none",
        unknown=Unknown((FLEETS, ROBOTARIUM), "tasks appear at random", is_surprise=True),
    ),
    Key(
        "until",
        Time(is_above=True),
        "the step, in continuous time the time, at which the mission is over, whatever is left "
        "([optional tasks](mission/optional.md)); needed if a task is optional",
        default=None,
        without="with its last task",
        since="0.2.0",
        unknown=Unknown((ROBOTARIUM,), "until says when the mission is over"),
    ),
    Key(
        "chargers",
        KeyedParts(CHARGER_KEYS, makes="Charger"),
        "`[{at: [1, 1], room: 2}]`: where robots with a battery charge "
        "([batteries and chargers](mission/charging.md))",
        default=(),
        without="none",
        example=[{"at": [1, 1]}],
        since=NEW,
    ),
    Key(
        "zones",
        NamedParts(ZONE_KEYS, makes="Zone"),
        "`{dock: {area: [[2, 3], [6, 8]], room: 2}}`: where only so many services go on at once "
        "([zones](mission/zones.md))",
        default=(),
        without="none",
        example={"dock": {"area": [[2, 3], [6, 8]], "room": 2}},
        since=NEW,
        unknown=Unknown((ROBOTARIUM,), "the mission has zones"),
    ),
)
