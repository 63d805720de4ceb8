"""What comes from outside by the truth of a mission, and when: losses, tasks, windows."""

from __future__ import annotations

from teamformer.mission.checks.windows import release_of
from teamformer.mission.model import Mission

KINDS_FROM_OUTSIDE = ("lost", "back", "cancel", "appear", "opens")

Due = tuple[float, str, int]
"""When something comes from outside, its kind, and the robot or task that it is about."""


def what_is_to_come(truth: Mission) -> list[Due]:
    """Return all that may come from outside, in the order of time.

    A task that is over by then is not called off, and does not open.
    """
    due: list[Due] = []
    for number, robot in enumerate(truth.robots):
        for away in robot.absences:
            due.append((float(away.lost), "lost", number))
            if away.back is not None:
                due.append((float(away.back), "back", number))
    for number, task in enumerate(truth.tasks):
        if task.appears > 0:
            due.append((float(task.appears), "appear", number))
        if task.cancelled is not None:
            due.append((float(task.cancelled), "cancel", number))
        if release_of(task) > task.appears:
            due.append((release_of(task), "opens", number))
    order = {kind: place for place, kind in enumerate(KINDS_FROM_OUTSIDE)}
    return sorted(due, key=lambda it: (it[0], order[it[1]], it[2]))
