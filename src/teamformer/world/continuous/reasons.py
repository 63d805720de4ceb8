"""Why tasks were left out."""

from __future__ import annotations

from teamformer.mission.checks.optional import is_in_time
from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission
from teamformer.mission.parts.capabilities import covers, total
from teamformer.world.continuous.ways import Ways


def why_left_out(truth: Mission, ways: Ways, task: int) -> str:
    """Return why nobody has begun a task of a mission, in a word of `WHY_MISSED`.

    It is too far if not even those who would be there first from the start could end it in time.
    """
    wanted = truth.tasks[task]
    begins = earliest_start(truth, ways, task)
    if begins is None:
        return "nobody able"
    if not is_in_time(
        max(begins, release_of(wanted)) + wanted.duration + wanted.unload, truth.until
    ):
        return "too far"
    if truth.cost is not None and wanted.optional:
        return "not worth it"
    return "nobody free"


def earliest_start(truth: Mission, ways: Ways, task: int) -> float | None:
    """Return when enough robots can be at a task that go there at once, from the start; or None."""
    wanted = truth.tasks[task]
    comes = sorted(
        (ways.length(robot.at, wanted.at, robot.moves) / robot.speed, number)
        for number, robot in enumerate(truth.robots)
    )
    there: list[int] = []
    for at, number in comes:
        there.append(number)
        if covers(total(truth.robots[robot].can for robot in there), wanted.needs):
            return at
    return None
