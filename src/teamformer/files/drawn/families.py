"""The families of missions that people have: what worlds, robots and tasks of each are like.

Where the paper's worlds give a robot one capability and a task many, here a robot has a few and a
task needs a few, some of them twice; robots differ in speed, tasks take time, ways are blocked.
What is lifted may be in kilograms, and may have to be brought somewhere.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from teamformer.base.errors import TeamformerError
from teamformer.files.drawn.surprises import SURPRISES

SIZES = {"half": 0.5, "double": 2.0}
"""Of how many times the robots and tasks there are missions of a family, by ending of its name."""

EVERYBODY = 1000.0
"""Cells that robots sense in settings that end with `-senseall`."""

INCIDENTS = ("lost", "arrivals", "ordered", "shifts", "charging", "zones", *SURPRISES)


@dataclass(frozen=True)
class Amounts:
    """How much of a capability robots bring and tasks need; ranges include both ends."""

    brought: tuple[float, float]  # any amount alike
    needed: tuple[float, float]  # alike in its logarithm: light loads are frequent
    step: float = 0.5  # amounts are multiples of it


@dataclass(frozen=True)
class Family:
    """What missions of a kind have in common; ranges include both ends, `shares` add up to 1."""

    robots: tuple[int, int]
    tasks: tuple[int, int]
    capabilities: tuple[str, ...]
    abilities: tuple[float, ...]  # shares of the robots that have 1, 2, ... capabilities
    needs: tuple[float, ...]  # shares of the tasks that need 1, 2, ... of them
    twice: float = 0.0  # share of needs for two robots, where there are two
    amounts: Mapping[str, Amounts] = field(default_factory=dict)  # of those that are measured
    slow: float = 0.0  # share of the robots that walk half as fast
    serving: float = 0.0  # share of the tasks that take time
    duration: tuple[int, int] = (1, 10)
    width: tuple[int, int] = (20, 20)
    height: tuple[int, int] = (20, 20)
    blocked: float = 0.0  # share of the cells, scattered
    has_shelves: bool = False
    yards: float = 0.0  # share of the missions in the open, without shelves
    carried: float = 0.0  # share of the tasks with measured needs that are brought to a dock
    unload: tuple[int, int] = (0, 0)
    docks: int = 0
    walls: tuple[int, int] = (0, 0)  # across the map, each with a gap of one cell
    airborne: tuple[str, ...] = ()  # robots that have one of these fly
    due: float = 0.0  # share of the tasks that are due
    cost: Mapping[str, float] | None = None
    sensing_radius: float = 3.0


FAMILIES = {
    "real": Family(
        robots=(8, 16),
        tasks=(30, 60),
        capabilities=("lift", "scan", "weld", "power", "drill", "seal"),
        abilities=(0.4, 0.4, 0.2),
        needs=(0.4, 0.4, 0.2),
        twice=0.25,
        slow=1 / 3,
        serving=0.6,
        blocked=0.1,
    ),
    "sparse": Family(
        robots=(12, 12),
        tasks=(40, 40),
        capabilities=tuple(f"c{number}" for number in range(8)),
        abilities=(1.0,),
        needs=(1 / 3, 1 / 3, 1 / 3),
        sensing_radius=1.0,
    ),
    "warehouse": Family(
        robots=(6, 12),
        tasks=(14, 40),
        capabilities=("lift", "scan", "weld", "power"),
        abilities=(0.8, 0.2),
        needs=(0.5, 0.4, 0.1),
        twice=0.25,
        slow=0.15,
        serving=0.2,
        duration=(2, 6),
        width=(18, 36),
        height=(12, 24),
        has_shelves=True,
    ),
    "moving": Family(
        robots=(8, 12),
        tasks=(20, 40),
        capabilities=("lift", "steer"),
        abilities=(0.5, 0.5),
        needs=(0.5, 0.5),
        amounts={"lift": Amounts(brought=(20.0, 120.0), needed=(10.0, 400.0))},
        slow=0.25,
        serving=0.5,
        blocked=0.05,
    ),
    "carry": Family(
        robots=(6, 12),
        tasks=(14, 36),
        capabilities=("lift", "scan"),
        abilities=(0.7, 0.3),
        needs=(0.8, 0.2),
        amounts={"lift": Amounts(brought=(20.0, 120.0), needed=(10.0, 250.0))},
        slow=0.2,
        serving=0.5,
        duration=(1, 3),
        width=(18, 36),
        height=(12, 24),
        has_shelves=True,
        yards=0.5,
        carried=0.9,
        unload=(0, 3),
        docks=4,
    ),
    "air-ground": Family(
        robots=(8, 14),
        tasks=(24, 44),
        capabilities=("scan", "lift", "weld", "power"),
        abilities=(1.0,),
        needs=(0.5, 0.4, 0.1),
        twice=0.25,
        slow=0.25,
        serving=0.4,
        duration=(2, 6),
        width=(20, 32),
        height=(14, 24),
        has_shelves=True,
        walls=(2, 4),
        airborne=("scan",),
    ),
    "deadlines": Family(
        robots=(8, 14),
        tasks=(24, 44),
        capabilities=("lift", "scan", "weld", "power"),
        abilities=(0.5, 0.5),
        needs=(0.5, 0.4, 0.1),
        twice=0.2,
        slow=0.25,
        serving=0.5,
        duration=(1, 8),
        blocked=0.1,
        due=0.7,
        cost={"makespan": 1, "tardiness": 2, "completion": 0.1},
    ),
}


def family_in(setting: str) -> str | None:
    """Return the name of the family that the name of a setting begins with, if it does."""
    return next((name for name in FAMILIES if f"{setting}-".startswith(f"{name}-")), None)


def sized(family: Family, size: float) -> Family:
    """Return a family with so many times the robots and tasks, on as much more room."""
    least = len(family.capabilities) if len(family.abilities) == 1 else 3

    def times(ends: tuple[int, int], factor: float, most_least: int) -> tuple[int, int]:
        low, high = (max(most_least, round(factor * end)) for end in ends)
        return low, high

    side = math.sqrt(size)
    return replace(
        family,
        robots=times(family.robots, size, least),
        tasks=times(family.tasks, size, 4),
        width=times(family.width, side, 10),
        height=times(family.height, side, 10),
    )


def split_name(setting: str) -> tuple[Family, str | None] | None:
    """Return the family and the incident that a setting such as `real-lost` names, if it does.

    Before the incident may stand a size and how far robots sense: `real-double-sense5-lost`.
    """
    name = family_in(setting)
    if name is None:
        return None
    family, words = FAMILIES[name], setting[len(name) :].split("-")[1:]
    if words and words[0] in SIZES:
        family = sized(family, SIZES[words.pop(0)])
    if words and (sense := re.fullmatch(r"sense([1-9]\d?|all)", words[0])):
        words.pop(0)
        reach = EVERYBODY if sense[1] == "all" else float(sense[1])
        family = replace(family, sensing_radius=reach)
    incident = "-".join(words)
    if words and incident not in INCIDENTS:
        known = ", ".join([name, *(f"{name}-{one}" for one in (*SIZES, "sense5", *INCIDENTS))])
        raise TeamformerError(f"'{setting}' is no setting", f"of this family there are {known}")
    return family, incident or None
