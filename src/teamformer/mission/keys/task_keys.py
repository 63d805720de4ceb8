"""The keys of a task."""

from __future__ import annotations

from teamformer.mission.keys.key import (
    BEFOREHAND,
    CONTINUOUS,
    FLEETS,
    ROBOTARIUM,
    Key,
    Unknown,
)
from teamformer.mission.keys.kinds import (
    Chances,
    Counts,
    Either,
    Names,
    Number,
    Place,
    Range,
    RobotNames,
    StartLinks,
    Text,
    Time,
    Truth,
    Window,
)
from teamformer.mission.keys.robot_keys import NOT_KNOWN

SMALLEST_WEIGHT, LARGEST_WEIGHT = 1e-3, 1e6
"""Of the weights of a cost and of tasks: they are told apart however far apart they are."""

CONTINUOUS_TIME = "([continuous time](mission/time.md))"

TASK_KEYS = (
    Key(
        "name",
        Text(),
        "a name that no other task has",
        default="",
        without="`t1`, `t2`, ... by place in the list",
    ),
    Key(
        "at",
        Place(),
        "the cell or point `[x, y]` where the task is; on roads the name of a place",
        example=[18, 9],
    ),
    Key(
        "needs",
        Counts(),
        "the capabilities that *one team* must bring together: names or counts, as for `can`",
        example={"lift": 2, "weld": 1},
    ),
    Key(
        "duration",
        Either(Time(), Range(0, "write steps, or [least, most]")),
        "steps that the team must stay; in continuous time it may be a fraction. It may be a range "
        f"`[least, most]` {NOT_KNOWN}",
        default=0,
        label="Duration, steps",
        unknown=Unknown(
            (ROBOTARIUM,), "has an uncertain duration", is_surprise=True, field="lasts"
        ),
    ),
    Key(
        "appears",
        Time(),
        "the step after which everybody knows the task, in continuous time the time; 0: it is "
        "known from the start",
        default=0,
        label="Appears after step",
    ),
    Key(
        "cancelled",
        Time(is_above=True),
        "the step in which the task is called off, in continuous time the time, if it is not done "
        "by then ([called off](mission/tasks.md#called-off))",
        default=None,
        without="it never is",
        label="Called off in step",
        unknown=Unknown((CONTINUOUS, BEFOREHAND, ROBOTARIUM), "is cancelled"),
    ),
    Key(
        "after",
        Names(),
        f"names of tasks that must have ended before this one begins {CONTINUOUS_TIME}",
        default=(),
        without="none",
        unknown=Unknown((ROBOTARIUM,), "has after"),
    ),
    Key(
        "between",
        Window(),
        "`[begin, end]`: the task may not begin before `begin`, and is late if it ends after "
        f"`end` {CONTINUOUS_TIME}",
        default=None,
        without="any time",
        example=[0, 20],
        unknown=Unknown((ROBOTARIUM,), "has between"),
    ),
    Key(
        "starts",
        StartLinks(),
        "in continuous time: `{TASK: [least, most]}`, this task starts at least and at most this "
        f"long after TASK starts, and other robots do it {CONTINUOUS_TIME}",
        default={},
        without="whenever it can",
        example={"drip": [5, 10]},
        unknown=Unknown((FLEETS,), "has starts"),
    ),
    Key(
        "to",
        Place(),
        "the cell or point `[x, y]` to which the task's load is brought "
        "([loads](mission/tasks.md#loads))",
        default=None,
        without="nothing is carried",
    ),
    Key(
        "unload",
        Time(),
        "steps that the team stays there with the load; in continuous time it may be a fraction",
        default=0,
    ),
    Key(
        "may_need",
        Chances(),
        "`{weld: 0.4}`: with this probability the task needs one more of the capability "
        f"{NOT_KNOWN}",
        default={},
        without="nothing",
        example={"weld": 0.4},
        unknown=Unknown((ROBOTARIUM,), "has uncertain needs", is_surprise=True),
    ),
    Key(
        "within",
        Number(0),
        "the task is somewhere within this distance of `at`, in a straight line, in cells or "
        "metres; on roads in a place to which the way from `at` takes no longer, at speed 1, by "
        f"whatever is quickest. Where exactly shows only when a team comes near {NOT_KNOWN}",
        default=0.0,
        without="0: it is at `at`",
        label="Within (cells, m, time)",
        unknown=Unknown((ROBOTARIUM,), "has an uncertain place", is_surprise=True),
    ),
    Key(
        "weight",
        Number(SMALLEST_WEIGHT, LARGEST_WEIGHT),
        "how much the task counts in `cost`: when it ends, how late it is, and if it is missed; "
        "0.001 to 1,000,000",
        default=1.0,
    ),
    Key(
        "only",
        RobotNames(),
        "names of robots, or the name of an entry with `count` for all its robots: what other "
        "robots bring does not count for this task ([pins](mission/tasks.md#pins))",
        default=(),
        without="every robot may do it",
    ),
    Key(
        "with",
        RobotNames(),
        "names of robots that must take part, as for `only` ([pins](mission/tasks.md#pins))",
        default=(),
        without="none",
    ),
    Key(
        "note",
        Text(),
        "a text for people, which pages and tables show with the task",
        default="",
        without="none",
        label="Note",
        is_in_details=True,
        since="0.2.0",
    ),
    Key(
        "optional",
        Truth(),
        "`true`: the task may be left out, it is *missed* then "
        "([optional tasks](mission/optional.md))",
        default=False,
        without="it must be done",
        since="0.2.0",
        unknown=Unknown((ROBOTARIUM,), "is optional"),
    ),
)

NOT_ALIKE = {
    "only": "becomes capabilities that only these robots bring",
    "with": "becomes capabilities that only these robots bring",
    "lasts": "duration says it, as a range",
    "has_arrived": "a task that appears at random stands in no file",
}
"""Keys without a field of their own in the model, and fields without a key: why."""
