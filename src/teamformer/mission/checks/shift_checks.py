"""What is wrong with the shifts of robots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice, pairwise
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.shifts import SAME, Rota

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Robot, Task

TURNS_LOOKED_AT = 100
"""Of each rota: so many shifts are compared with those of others."""


def find_shift_problems(mission: Mission) -> Iterator[Problem]:
    """Return which shifts are no time or overlap, and what fits into none that robots share."""
    faults = [p for n, robot in enumerate(mission.robots) for p in _problems_of_rota(robot, n)]
    yield from faults
    if not faults and any(robot.shifts for robot in mission.robots):
        yield from _linked_tasks(mission)
        yield from _problems_of_tasks(mission)


def _linked_tasks(mission: Mission) -> Iterator[Problem]:
    for number, task in enumerate(mission.tasks):
        if task.starts:
            message = f"task '{task.name}' has a linked start, and robots work in shifts"
            yield Problem(
                ("tasks", number, "starts"),
                f"{message}; plans know either of the two, so drop starts or shifts",
            )
            return


def _problems_of_rota(robot: Robot, number: int) -> Iterator[Problem]:
    where, what = ("robots", number, "shifts"), f"robot '{robot.name}' has a shift"
    is_good = True
    for entry, (begin, end) in enumerate(robot.shifts):
        if not 0 <= begin < end <= LARGEST_NUMBER:  # NaN too
            is_good = False
            message = f"{what} from {begin:g} to {end:g}; use [begin, end], 0 or more and in this"
            yield Problem((*where, entry), f"{message} order, up to 1e9")
    for entry, ((_, end), (begin, _)) in enumerate(pairwise(robot.shifts)):
        if is_good and begin < end:
            message = f"{what} from {begin:g} on, before the one before it ends at {end:g}"
            yield Problem((*where, entry + 1), f"{message}; put them in order, or join the two")
    if not robot.every:
        return
    where = ("robots", number, "every")
    if not robot.shifts:
        yield Problem(where, f"robot '{robot.name}' has every but no shifts; add shifts or drop it")
    elif not 0 < robot.every <= LARGEST_NUMBER:
        message = f"the shifts of robot '{robot.name}' come again every {robot.every:g}"
        yield Problem(where, f"{message}; use more than 0, up to 1e9")
    elif is_good and (lasts := robot.shifts[-1][1] - robot.shifts[0][0]) > robot.every:
        message = f"the shifts of robot '{robot.name}' come again every {robot.every:g}"
        yield Problem(where, f"{message}, but take {lasts:g} from first to last; use {lasts:g}")


def _problems_of_tasks(mission: Mission) -> Iterator[Problem]:
    """Return which tasks fit into no shift that able robots have in common."""
    robots_of: dict[Rota, list[Robot]] = {}
    for robot in mission.robots:
        robots_of.setdefault(robot.rota, []).append(robot)
    brings = {rota: total(r.can for r in robots) for rota, robots in robots_of.items()}
    openings = [islice(rota.since(0.0), TURNS_LOOKED_AT) for rota in robots_of]
    moments = sorted({opens for shifts in openings for opens, _ in shifts})
    everybody = total(brings.values())
    together: dict[float, list[list[Rota]]] = {}
    for number, task in enumerate(mission.tasks):
        if not covers(everybody, task.needs):
            continue  # which has been told
        takes = _least_time(task)
        if takes not in together:
            together[takes] = _at_work_together(list(robots_of), moments, takes)
        if not any(covers(total(brings[r] for r in some), task.needs) for some in together[takes]):
            key = "duration" if task.duration or not task.unload else "unload"
            yield Problem(
                ("tasks", number, key),
                f"task '{task.name}' takes {takes:g}, but robots that can do it have no shift that "
                "long in common; lengthen their shifts, or shorten the task",
            )


def _least_time(task: Task) -> float:
    """Return how long a task takes its team by what is believed, but for carrying its load."""
    return task.duration + task.unload


def _at_work_together(
    rotas: Sequence[Rota], moments: Sequence[float], takes: float
) -> list[list[Rota]]:
    """Return the rotas that have all of a span in one shift, for spans from some moments on."""
    found: list[list[Rota]] = []
    for moment in moments:
        some = [rota for rota in rotas if rota.fits(moment, takes) <= moment * (1 + SAME)]
        if some not in found:
            found.append(some)
    return found
