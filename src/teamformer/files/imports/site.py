"""Sites of other programs: named places, ways between them, and who and what is there.

Lanes become tables of times in seconds. Where a file limits no speed, a way takes its length at
`USUAL_SPEED`. A robot's `speed` in the mission divides all times of its table.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from teamformer.files.trees.writer import robot_to_tree, task_to_tree, world_to_tree
from teamformer.mission.keys.mission_keys import VERSION
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.parts.roads import GROUND, Roads

USUAL_SPEED = 1.0
"""Metres a second where a file limits no speed; nobody is taken for faster where it does."""

CARRY = "carry"
"""What robots of a site can and its tasks need: files of sites say nothing of either."""

MILLISECONDS = 3
"""Places after the point to which times are rounded."""


@dataclass(frozen=True)
class Lane:
    """A way in one direction between two places, by number, and the seconds that it takes."""

    begin: int
    end: int
    seconds: float


@dataclass(frozen=True)
class Site:
    """Roads, with the robots and tasks that a file has; a mission as soon as it has both."""

    name: str
    world: Roads
    robots: tuple[Robot, ...] = ()
    tasks: tuple[Task, ...] = ()

    def complete(self) -> Mission | Site:
        """Return the mission of the site; the site itself while it lacks robots or tasks."""
        if not self.robots or not self.tasks:
            return self
        return Mission(
            name=self.name,
            world=self.world,
            capabilities=(CARRY,),
            robots=self.robots,
            tasks=self.tasks,
            time="continuous",
        )


def site_to_tree(site: Site) -> dict[str, Any]:
    """Return the tree of a mission file that lacks robots or tasks, for somebody to complete."""
    return {
        "teamformer": VERSION,
        "name": site.name,
        "time": "continuous",
        "world": world_to_tree(site.world),
        "capabilities": [CARRY],
        "robots": [robot_to_tree(robot, site.world) for robot in site.robots],
        "tasks": [task_to_tree(task, site.world) for task in site.tasks],
    }


def roads_of(places: Sequence[str], lanes: Mapping[str, Iterable[Lane]]) -> Roads:
    """Return roads with the quickest lane of each pair of places; `lanes` are by mover.

    A single mover is the one that robots are without `moves`.
    """
    times = {}
    for mover, ways in lanes.items():
        rows = [[math.inf] * len(places) for _ in places]  # (from, to)
        for place, row in enumerate(rows):
            row[place] = 0.0
        for lane in ways:
            if lane.begin != lane.end:
                seconds = round(lane.seconds, MILLISECONDS)
                rows[lane.begin][lane.end] = min(rows[lane.begin][lane.end], seconds)
        times[mover_of(mover, lanes)] = tuple(map(tuple, rows))
    return Roads(tuple(places), times)


def mover_of(mover: str, movers: Iterable[str]) -> str:
    """Return what a mover is called in the mission: one alone has the usual name."""
    return mover if len(list(movers)) > 1 else GROUND


def seconds_of(metres: float, limit: float) -> float:
    """Return how long a lane takes; a limit of 0 is none."""
    return metres / (min(limit, USUAL_SPEED) if limit > 0 else USUAL_SPEED)


def told_apart(names: Sequence[str], others: Sequence[str]) -> list[str]:
    """Return one name for each place: `others`, all different, where names are empty or twice."""
    taken = {name for name in names if name and names.count(name) == 1}
    found = []
    for name, other in zip(names, others, strict=True):
        if name not in taken:
            name = other if other not in taken else f"{other} (unnamed)"
        found.append(name)
    return found
