"""Why tasks were left out of a mission in continuous time."""

from __future__ import annotations

from teamformer.mission.model import Mission
from teamformer.world.continuous.ways import Ways
from teamformer.world.rules import left_out


def why_left_out(truth: Mission, ways: Ways, task: int) -> str:
    """Return why nobody has begun a task of a mission, in a word of `WHY_MISSED`."""
    at = truth.tasks[task].at
    comes = (
        (ways.length(robot.at, at, robot.moves) / robot.speed, number)
        for number, robot in enumerate(truth.robots)
    )
    return left_out.why_left_out(truth, task, comes)
