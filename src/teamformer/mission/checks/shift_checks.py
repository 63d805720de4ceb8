"""What is wrong with the shifts of robots."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations, islice, pairwise
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.parts.capabilities import Counts, covers, total
from teamformer.mission.parts.shifts import SAME, Rota

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Robot

TURNS_LOOKED_AT = 100
"""How often the shifts of each rota come again that are compared, unless all do so together."""


MOST_LOOKED_AT = 1000
"""So many sets of capabilities that tasks at random need are looked at."""


def find_shift_problems(mission: Mission) -> Iterator[Problem]:
    """Return which shifts are no time or overlap, and what fits into none that robots share."""
    faults = [p for n, robot in enumerate(mission.robots) for p in _problems_of_rota(robot, n)]
    if mission.time == "steps":
        faults += [p for n, robot in enumerate(mission.robots) for p in _fractions(robot, n)]
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


def _fractions(robot: Robot, number: int) -> Iterator[Problem]:
    """Return which moments of a rota are no number of steps."""
    for entry, shift in enumerate(robot.shifts):
        if not all(float(moment).is_integer() for moment in shift):
            message = f"robot '{robot.name}' has a shift from {shift[0]:g} to {shift[1]:g}"
            yield Problem(
                ("robots", number, "shifts", entry), f"{message}; in steps use whole numbers"
            )
    if robot.every and not float(robot.every).is_integer():
        message = f"the shifts of robot '{robot.name}' come again every {robot.every:g}"
        yield Problem(("robots", number, "every"), f"{message}; in steps use a whole number")


def _problems_of_tasks(mission: Mission) -> Iterator[Problem]:
    """Return which tasks fit into no shift that able robots have in common."""
    robots_of: dict[Rota, list[Robot]] = {}
    for robot in mission.robots:
        robots_of.setdefault(robot.rota, []).append(robot)
    brings = {rota: total(r.can for r in robots) for rota, robots in robots_of.items()}
    first = 1.0 if mission.time == "steps" else 0.0  # nothing begins before the first step is made
    left = _what_is_left(list(robots_of), first)
    everybody = total(brings.values())

    def fits(needs: Counts, takes: float) -> bool:
        at_work = (
            [brings[rota] for rota, room in zip(brings, row, strict=True) if room >= takes]
            for row in left
        )
        return any(covers(total(some), needs) for some in at_work)

    for number, task in enumerate(mission.tasks):
        if not covers(everybody, task.needs):
            continue  # which has been told
        takes = task.duration + task.unload  # its load may be carried no way at all
        may_need = [cap for cap, chance in task.may_need.items() if chance > 0]
        most = total([task.needs, dict.fromkeys(may_need, 1)])
        if not fits(most if covers(everybody, most) else task.needs, takes):
            key = "duration" if task.duration or not task.unload else "unload"
            yield Problem(
                ("tasks", number, key),
                f"task '{task.name}' takes {takes:g}, but robots that can do it have no shift that "
                "long in common; lengthen their shifts, or shorten the task",
            )
    arrivals = mission.arrivals
    if arrivals and not all(
        fits(dict.fromkeys(caps, 1), arrivals.duration)
        for caps in _appearing(everybody, arrivals.most_needs)
    ):
        yield Problem(
            ("arrivals", "duration"),
            f"tasks that appear take {arrivals.duration:g}, but robots that can do them have no "
            "shift that long in common; lengthen their shifts, shorten the tasks, or lower needs",
        )


def _appearing(have: Counts, most: int) -> Iterator[tuple[str, ...]]:
    """Return what tasks that appear need at most, at random; `most` is 0 if they may need all."""
    caps = [cap for cap, count in have.items() if count >= 1]
    return islice(combinations(caps, min(most or len(caps), len(caps))), MOST_LOOKED_AT)


def _what_is_left(rotas: Sequence[Rota], first: float) -> set[tuple[float, ...]]:
    """Return how long each rota goes on working at moments at which a shift of some begins.

    Of shifts that begin before the first moment it is that one. Rows that are alike are one, as
    those of shifts that come again together are.
    """
    have_turns = {rota.every for rota in rotas if rota}
    turns = TURNS_LOOKED_AT if len(have_turns) > 1 else 2
    openings = [islice(rota.since(0.0), turns * max(1, len(rota.shifts))) for rota in rotas]
    moments = {max(first, opens) for shifts in openings for opens, _ in shifts}
    return {tuple(_left(rota, moment) for rota in rotas) for moment in moments}


def _left(rota: Rota, moment: float) -> float:
    """Return how long a shift still lasts at a moment, with what rounding takes; -1 without one."""
    if not rota:
        return math.inf
    closes = max(
        (ends for begins, ends in islice(rota.since(moment), 2) if begins <= moment), default=None
    )
    return -1.0 if closes is None else closes - moment + SAME * max(1.0, moment)
