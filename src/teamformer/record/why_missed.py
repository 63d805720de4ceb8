"""Why tasks of missions in steps were missed."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.reach import can_reach
from teamformer.world.reference.ways import MICROMETRES, ROUNDING, PlainWays
from teamformer.world.rules.left_out import why_left_out


def why_missed(
    truth: Mission, task: int, served: Collection[int], headed_for: Collection[int]
) -> str:
    """Return why a task was missed in a step, in a word of `WHY_MISSED`.

    `served` are the tasks that were being served before it, `headed_for` those that teams headed
    for in it.
    """
    if task in served:
        return "under way"
    why = why_left_out(truth, task, _comes(truth, task))
    is_late = task in headed_for and why not in ("nobody able", "too far")
    return "too late" if is_late else why


def _comes(truth: Mission, task: int) -> Iterator[tuple[float, int]]:
    """Yield the first step in which each robot can be at a task, from the start, and its number."""
    world, at = truth.world, truth.tasks[task].at
    assert isinstance(world, Grid | Plane)
    ways, unit = PlainWays(world), 1.0 if isinstance(world, Grid) else MICROMETRES
    for number, robot in enumerate(truth.robots):
        if can_reach(world, robot, at):
            way = ways.length(robot.at, at, robot.flies) / unit
            yield math.ceil(way / world.pace(robot.speed) - ROUNDING), number
