"""When robots are lost and back: what is wrong with that."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.checks.rules import problems_of_steps
from teamformer.mission.keys.kinds import LARGEST_NUMBER, LATEST_RETURN

if TYPE_CHECKING:
    from teamformer.mission.model import Robot


def find_absence_problems(
    robot: Robot, where: tuple[str | int, ...], time: str
) -> Iterator[Problem]:
    """Return what is wrong with when a robot is lost and back; `where` is its place in the file."""
    if time == "continuous":
        yield from _problems_of_times_away(robot, where)
        return
    what, before = f"robot '{robot.name}' is", None
    for number, away in enumerate(robot.absences):
        place: tuple[str | int, ...] = (number,) if len(robot.absences) > 1 else ()
        lost, back = (*where, "lost", *place), (*where, "back", *place)
        if before is None:
            least, advice, again = 1.0, "the first step is 1", ""
        elif before.back is None:
            message = f"{what} lost at step {away.lost}, but was lost in step {before.lost}"
            yield Problem(
                lost, f"{message}; write under back when it returns, or drop one of the two"
            )
            return
        else:
            least, advice = before.back + 1, "it must be lost later"
            again = f"back at step {before.back} and "
        yield from problems_of_steps(away.lost, least, lost, f"{what} {again}lost at step", advice)
        if away.back is not None:
            steps = f"{what} lost at step {away.lost} and back at step"
            advice = "it must be back later"
            least = away.lost + 1
            yield from problems_of_steps(away.back, least, back, steps, advice, LATEST_RETURN)
        before = away


def _problems_of_times_away(robot: Robot, where: tuple[str | int, ...]) -> Iterator[Problem]:
    """Return what is wrong with when a robot is lost and back in continuous time."""
    since: float | None = 0.0
    for number, away in enumerate(robot.absences):
        place: tuple[str | int, ...] = (number,) if len(robot.absences) > 1 else ()
        what = f"robot '{robot.name}' is lost at {away.lost:g}"
        if since is None:
            message = f"{what}, but has not come back before; say under back when it has"
            yield Problem((*where, "lost", *place), message)
            return
        if not since < away.lost <= LARGEST_NUMBER:  # NaN too
            message = f"{what}; use a time after {since:g}, up to 1e9"
            yield Problem((*where, "lost", *place), message)
        if away.back is not None and not away.lost < away.back <= LATEST_RETURN:
            message = f"{what} and back at {away.back:g}; it must be back later"
            yield Problem((*where, "back", *place), message)
        since = away.back
