"""Why tasks were left out in continuous time."""

from __future__ import annotations

from teamformer.world.continuous.moving import MovingWorld
from teamformer.world.rules import left_out


def why_left_out(world: MovingWorld, task: int) -> str:
    """Return why nobody has begun a task, in a word of `WHY_MISSED`."""
    truth, at = world.truth, world.truth.tasks[task].at
    comes = (
        (world.ways.length(robot.at, at, robot.moves) / robot.speed, number)
        for number, robot in enumerate(truth.robots)
    )
    return left_out.why_left_out(truth, task, comes)
