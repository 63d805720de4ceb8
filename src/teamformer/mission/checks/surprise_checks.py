"""What is wrong with what a mission leaves open: ranges, probabilities, rates."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.keys.mission_keys import LONGEST_ARRIVALS
from teamformer.mission.parts.capabilities import Counts, covers, describe, missing, total

if TYPE_CHECKING:
    from teamformer.mission.model import Arrivals, Breakdown, Mission, Robot, Task


def find_surprise_problems(mission: Mission) -> Iterator[Problem]:
    """Return what is wrong with a mission's uncertain durations, needs and breakdowns."""
    for number, robot in enumerate(mission.robots):
        if robot.breaks is not None:
            least = 1 if mission.time == "steps" else 0
            where: tuple[str | int, ...] = ("robots", number, "breaks")
            yield from _problems_of_breaks(robot, robot.breaks, where, least)
        if robot.delays is not None and not 0 <= robot.delays.chance < 1:  # NaN too
            message = f"robot '{robot.name}' stands still with probability {robot.delays.chance:g}"
            yield Problem(("robots", number, "delays"), f"{message}; use 0 to less than 1")
    if mission.arrivals is not None:
        yield from _problems_of_arrivals(mission.arrivals)
    is_unsure = any(task.may_need for task in mission.tasks)
    everybody = total(robot.can for robot in mission.robots) if is_unsure else {}
    for number, task in enumerate(mission.tasks):
        if task.lasts is not None:
            where = ("tasks", number, "duration")
            yield from _problems_of_range(task.lasts, 0, where, f"task '{task.name}' takes")
        if task.may_need:
            where = ("tasks", number, "may_need")
            yield from _problems_of_may_need(mission, task, everybody, where)


def _problems_of_arrivals(arrivals: Arrivals) -> Iterator[Problem]:
    if not 0 <= arrivals.rate <= 1:  # NaN too
        message = f"tasks appear at a rate of {arrivals.rate:g} a step; use 0 to 1"
        yield Problem(("arrivals", "rate"), message)
    if not 0 <= arrivals.until <= LONGEST_ARRIVALS:
        message = f"tasks appear until step {arrivals.until}; use 0 to {LONGEST_ARRIVALS:,}"
        yield Problem(("arrivals", "until"), message)
    if not 0 <= arrivals.since <= LONGEST_ARRIVALS:
        message = f"tasks appear since step {arrivals.since}; use 0 to {LONGEST_ARRIVALS:,}"
        yield Problem(("arrivals", "since"), message)
    if not 0 <= arrivals.duration <= LARGEST_NUMBER:
        message = f"tasks that appear take {arrivals.duration} steps; use 0 to {LARGEST_NUMBER:,}"
        yield Problem(("arrivals", "duration"), message)
    if arrivals.most_needs < 0:
        message = f"tasks that appear need {arrivals.most_needs} capabilities; use 1 or more"
        yield Problem(("arrivals", "needs"), message)


def _problems_of_range(
    bounds: tuple[float, float], lowest: float, where: tuple[str | int, ...], what: str
) -> Iterator[Problem]:
    least, most = bounds
    if not lowest <= least <= LARGEST_NUMBER or not most <= LARGEST_NUMBER:
        message = f"{what} {least} to {most} steps; use {lowest} to {LARGEST_NUMBER:,}"
        yield Problem(where, message)
    elif most < least:
        message = f"{what} {least} to {most} steps, but the least comes first; swap the two"
        yield Problem(where, message)


def _problems_of_breaks(
    robot: Robot, breaks: Breakdown, where: tuple[str | int, ...], least: int
) -> Iterator[Problem]:
    what = f"robot '{robot.name}'"
    if not 0 <= breaks.rate <= 1:  # NaN too
        message = f"{what} breaks down at a rate of {breaks.rate:g} a step; use 0 to 1"
        yield Problem((*where, "rate"), message)
    if breaks.repair is not None:
        yield from _problems_of_range(
            breaks.repair, least, (*where, "repair"), f"{what} is repaired in"
        )
    if robot.absences:
        yield Problem(where, f"{what} has both lost and breaks; keep one of the two")


def _problems_of_may_need(
    mission: Mission, task: Task, everybody: Counts, where: tuple[str | int, ...]
) -> Iterator[Problem]:
    what = f"task '{task.name}' may need"
    for name, probability in task.may_need.items():
        if name not in mission.capabilities:
            message = f"{what} '{name}', which is not under capabilities; add it there"
            yield Problem((*where, name), message)
        if not 0 <= probability <= 1:  # NaN too
            message = f"{what} '{name}' with probability {probability:g}; use 0 to 1"
            yield Problem((*where, name), message)
    known = {n: count for n, count in task.worst_needs.items() if n in mission.capabilities}
    sure = {name: count for name, count in task.needs.items() if name in mission.capabilities}
    if covers(everybody, sure) and not covers(everybody, known):
        short = describe(missing(everybody, known))
        message = f"{what} {describe(known)} but all robots together lack {short}"
        yield Problem(where, f"{message}; add such a robot or drop it from may_need")
