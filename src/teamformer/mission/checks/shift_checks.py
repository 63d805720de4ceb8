"""What is wrong with the shifts of robots."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations, islice, pairwise
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.parts.capabilities import Counts, covers, total
from teamformer.mission.parts.charging import lengths
from teamformer.mission.parts.grid import Grid
from teamformer.mission.parts.roads import AIR
from teamformer.mission.parts.shifts import SAME, Rota

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Robot, Task

TURNS_LOOKED_AT = 100
"""How often the shifts of each rota come again that are compared, unless all do so together."""


MOST_LOOKED_AT = 1000
"""So many sets of capabilities that tasks at random need are looked at."""


def find_shift_problems(mission: Mission, are_ways_good: bool) -> Iterator[Problem]:
    """Return which shifts are no time or overlap, and what fits into none that robots share."""
    faults = [p for n, robot in enumerate(mission.robots) for p in _problems_of_rota(robot, n)]
    if mission.time == "steps":
        faults += [p for n, robot in enumerate(mission.robots) for p in _fractions(robot, n)]
    yield from faults
    if not faults and any(robot.shifts for robot in mission.robots):
        yield from _linked_tasks(mission)
        yield from _problems_of_tasks(mission, are_ways_good)


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


def _problems_of_tasks(mission: Mission, are_ways_good: bool) -> Iterator[Problem]:
    """Return which tasks fit into no shift that able robots have in common.

    Optional ones are missed. Where ways are good those there and those of loads count, too.
    """
    rotas = list(dict.fromkeys(robot.rota for robot in mission.robots))
    first = 1.0 if mission.time == "steps" else 0.0  # nothing begins before the first step is made
    left = _what_is_left(rotas, first)
    may_be_too_late = any(math.isfinite(rota.over) for rota in rotas)
    everybody = total(robot.can for robot in mission.robots)

    def fits(needs: Counts, takes: Sequence[float]) -> bool:
        """Say whether a task fits that takes each robot so long, infinitely if it cannot do it."""
        brings = _brought(mission.robots, takes)
        at_work = (
            [can for (rota, spent), can in brings if room[rota] >= spent]
            for room in (dict(zip(rotas, row, strict=True)) for row in left)
        )
        return any(covers(total(some), needs) for some in at_work)

    for number, task in enumerate(mission.tasks):
        if task.optional or not covers(everybody, task.needs):
            continue  # which has been told
        takes = [task.longest + task.unload] * len(mission.robots)
        may_need = [cap for cap, chance in task.may_need.items() if chance > 0]
        most = total([task.needs, dict.fromkeys(may_need, 1)])
        needs = most if covers(everybody, most) else task.needs
        if not fits(needs, takes):
            key = "duration" if task.longest or not task.unload else "unload"
            yield Problem(
                ("tasks", number, key),
                f"task '{task.name}' {_takes(task)} {takes[0]:g}, but robots that can do it have "
                "no shift that long in common; lengthen their shifts, or shorten the task",
            )
        elif are_ways_good and not task.within and (task.to or may_be_too_late):
            with_ways = _takes_with_ways(mission, task)
            if with_ways != takes and not fits(needs, with_ways):
                least = _least_time(mission.robots, with_ways, needs)
                yield from _problem_of_ways(task, number, least)
    arrivals = mission.arrivals
    if arrivals and not all(
        fits(dict.fromkeys(caps, 1), [arrivals.duration] * len(mission.robots))
        for caps in _appearing(everybody, arrivals.most_needs)
    ):
        yield Problem(
            ("arrivals", "duration"),
            f"tasks that appear take {arrivals.duration:g}, but robots that can do them have no "
            "shift that long in common; lengthen their shifts, shorten the tasks, or lower needs",
        )


def _takes(task: Task) -> str:
    return "takes" if task.lasts is None else "may take"


def _brought(
    robots: Sequence[Robot], takes: Sequence[float]
) -> list[tuple[tuple[Rota, float], Counts]]:
    """Return what robots bring together that have the same shifts and take equally long."""
    alike: dict[tuple[Rota, float], list[Counts]] = {}
    for robot, spent in zip(robots, takes, strict=True):
        alike.setdefault((robot.rota, spent), []).append(robot.can)
    return [(key, total(cans)) for key, cans in alike.items()]


def _takes_with_ways(mission: Mission, task: Task) -> list[float]:
    """Return how long a task takes each robot at least, with the way of its load.

    It takes for ever if the robot is not there with enough of a shift left before its shifts are
    over. Walls count for nothing: around them it is no shorter.
    """
    world, goals = mission.world, [task.at, *([task.to] if task.to else [])]
    far = {
        (robot.moves, robot.at): lengths(world, robot.moves, [robot.at, task.at], goals)
        if not isinstance(world, Grid)
        else lengths(world, AIR, [robot.at, task.at], goals)
        for robot in mission.robots
    }
    takes = []
    for robot in mission.robots:
        (there, *_), (_, *carried) = far[robot.moves, robot.at]
        spent = task.longest + task.unload + sum(carried) / robot.speed
        comes = robot.rota.walked(0.0, there / robot.speed)
        is_late = spent <= robot.rota.longest and math.isinf(robot.rota.fits(comes, spent))
        takes.append(math.inf if is_late or math.isinf(comes) else spent)
    return takes


def _least_time(robots: Sequence[Robot], takes: Sequence[float], needs: Counts) -> float:
    """Return what a task takes robots at least that can do it together, by what it takes each."""
    for most in sorted(set(takes)):
        quick = (robot.can for robot, spent in zip(robots, takes, strict=True) if spent <= most)
        if covers(total(quick), needs):
            return most
    return math.inf


def _problem_of_ways(task: Task, number: int, takes: float) -> Iterator[Problem]:
    """Return that a task fits into no shift because of the ways there, or that of its load."""
    if task.to is None or math.isinf(takes):
        message = f"robots that can do task '{task.name}' do not get there within their shifts"
        remedy = "lengthen these, have them come again (every), or move it"
        yield Problem(("tasks", number, "at"), f"{message}; {remedy}")
        return
    message = (
        f"task '{task.name}' {_takes(task)} {takes:g} or more with the way of its load, but robots"
    )
    message = f"{message} that can do it have no shift that long in common"
    yield Problem(("tasks", number, "to"), f"{message}; lengthen their shifts, or shorten the way")


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
