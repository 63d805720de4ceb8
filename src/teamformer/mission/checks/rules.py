"""Rules that a mission may have besides the step rules: time, ends, precedence, time windows."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.checks.costs import COST_PARTS, ONLY_IN_CONTINUOUS_TIME, find_cost_problems
from teamformer.mission.checks.links import find_link_problems, find_links
from teamformer.mission.checks.loads import find_flown_loads
from teamformer.mission.checks.optional import find_optional_problems, has_optional
from teamformer.mission.checks.windows import find_endless_play
from teamformer.mission.checks.zone_checks import zones_not_served
from teamformer.mission.keys.key import (
    BEFOREHAND,
    CONTINUOUS,
    FLEETS,
    ROBOTARIUM,
    STEPS,
)
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.keys.mission_keys import HOME, TIMES
from teamformer.mission.keys.unknown import find_unknown, told_once
from teamformer.mission.parts.reach import can_reach, way_for
from teamformer.mission.parts.roads import AIR, GROUND, Roads

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Task

NEW_TASKS = ("resolve", "nearest")
LIKELY = 0.25
LEAST_CHANCE = {"needed": 0.0, "absent": math.inf, "scouting": LIKELY}
"""By foresight, from which probability on needs that nobody knows are expected."""
FORESIGHTS = tuple(LEAST_CHANCE)

MOMENTS = frozenset({"between", "appears", "cancelled", "lost", "back", "until", "shifts"})
"""Keys of a file whose values are moments of a mission."""


def counted_from(where: tuple[str | int, ...]) -> str:
    """Return what to say of the largest number that may stand somewhere: moments have a start."""
    return "" if MOMENTS.isdisjoint(where) else ", counted from the mission's start"


def is_time(value: float) -> bool:
    """Say whether a number can be a time."""
    return 0 <= value <= LARGEST_NUMBER


def problems_of_steps(
    steps: float,
    least: float,
    where: tuple[str | int, ...],
    what: str,
    advice: str,
    most: int = LARGEST_NUMBER,
) -> Iterator[Problem]:
    """Return what is wrong with a number of steps; `advice` is for one below the least."""
    if not steps >= least:  # NaN too
        yield Problem(where, f"{what} {steps}; {advice}")
    elif not is_whole(steps) or steps > most:
        start = counted_from(where) if steps > most else ""
        yield Problem(where, f"{what} {steps}; use a whole number up to {most:,}{start}")


def is_whole(number: float) -> bool:
    """Say whether a number is finite and has no fraction."""
    return number - number == 0 and number == int(number)


def find_rule_problems(mission: Mission) -> Iterator[Problem]:
    """Return what is wrong with a mission's time, end, precedence and time windows."""
    if mission.time not in TIMES:
        choices = " or ".join(TIMES)
        yield Problem(("time",), f"time '{mission.time}' is unknown; use {choices}")
    if not is_time(mission.forming):
        yield Problem(("forming",), f"forming is {mission.forming:g}; use 0 to 1e9")
    yield from _problems_of_end(mission)
    yield from _problems_of_roads(mission)
    yield from _problems_of_times(mission)
    yield from _problems_of_precedence(mission)
    yield from find_cost_problems(mission)
    yield from find_link_problems(mission)
    yield from _problems_of_until(mission)
    yield from find_optional_problems(mission)


def rules_not_played(mission: Mission) -> Iterator[Problem]:
    """Return why the step simulator cannot play a mission; nothing if it can."""
    if mission.time == "continuous":
        what = "missions in continuous time are not played in steps"
        yield Problem(("time",), f"{what}; use `teamformer run`, `compare` or `plan`")
        return
    remedy = "write time: continuous"
    yield from find_flown_loads(mission)
    for where, what in find_unknown(mission, STEPS):
        yield Problem(where, f"{what}; {remedy}")
    if ONLY_IN_CONTINUOUS_TIME in (mission.cost or ()):
        known = ", ".join(part for part in COST_PARTS if part != ONLY_IN_CONTINUOUS_TIME)
        message = f"in steps a cost may weigh {known}; drop travel, or {remedy}"
        yield Problem(("cost", ONLY_IN_CONTINUOUS_TIME), message)
    for problem in find_links(mission):
        yield Problem(problem.where, f"{problem.message}; {remedy}")
    for problem in find_endless_play(mission):
        yield Problem(problem.where, f"{problem.message}, or {remedy}")


def _problems_of_until(mission: Mission) -> Iterator[Problem]:
    until = mission.until
    if until is None:
        return
    if not 0 < until <= LARGEST_NUMBER:  # NaN too
        message = f"the mission is over at {until:g}; use a time after 0"
        yield Problem(("until",), f"{message}, up to 1e9{counted_from(('until',))}")
    elif mission.time == "steps" and until != int(until):
        yield Problem(("until",), f"the mission is over at {until:g}; in steps use a whole number")


def rules_not_run(mission: Mission) -> Iterator[Problem]:
    """Return why a mission cannot be run, be it in steps or in continuous time."""
    if mission.time == "steps":
        yield from rules_not_played(mission)


def rules_not_advised(mission: Mission) -> Iterator[Problem]:
    """Return why nobody can say what would help a mission most."""
    yield from rules_not_run(mission)
    if has_optional(mission) and mission.cost is None:
        message = (
            "advise asks what lets a mission be over sooner, and with tasks that may be missed"
        )
        remedy = "add a cost with missed, such as {makespan: 1, missed: 20}"
        yield Problem(("until",), f"{message} that says nothing; {remedy}")


def rules_not_known_beforehand(mission: Mission) -> Iterator[Problem]:
    """Return what a plan cannot count with that is made before the mission begins."""
    remedy = "drop cancelled, or use `teamformer run` with its default method"
    rest = f"which a plan made in advance cannot know; {remedy}"
    yield from told_once(mission, find_unknown(mission, BEFOREHAND), lambda _: rest)


def rules_not_planned(mission: Mission) -> Iterator[Problem]:
    """Return why a mission cannot be planned before it begins.

    In steps that are rules that these do not know; in continuous time what a plan cannot foresee.
    """
    if mission.time == "continuous":
        yield from rules_not_run(mission)
        rest = "which a plan made in advance does not count with; drop {}, or use `teamformer run`"
        yield from told_once(mission, find_unknown(mission, CONTINUOUS), rest.format)
        return
    yield from rules_not_played(mission)
    yield from rules_not_known_beforehand(mission)


VERBS = {
    "run": rules_not_run,
    "compare": rules_not_run,
    "plan": rules_not_planned,
    "live": rules_not_run,
}
"""What refuses a mission, by verb."""


def _verbs_for(mission: Mission) -> str:
    """Return in words which verbs take a mission as it is."""
    verbs = [f"`{verb}`" for verb, refuse in VERBS.items() if not any(refuse(mission))]
    return " or ".join(filter(None, (", ".join(verbs[:-1]), *verbs[-1:])))


def rules_of_rehearsals(mission: Mission) -> Iterator[Problem]:
    """Return why a fleet of processes cannot rehearse a mission; nothing if it can."""
    yield from rules_not_run(mission)
    if mission.time == "continuous":
        yield from find_flown_loads(mission)
    yield from zones_not_served(mission)
    remedy = _remedy(mission, FLEETS)
    yield from told_once(mission, find_unknown(mission, FLEETS), remedy)
    both = [
        (("tasks", number, "within"), f"task '{task.name}' has a load within a region")
        for number, task in enumerate(mission.tasks)
        if task.within and task.to is not None
    ]
    yield from told_once(mission, both, remedy)


def rules_of_fleets(mission: Mission) -> Iterator[Problem]:
    """Return why robots that are processes of their own cannot do a mission; nothing if they can.

    Their tasks come from operators, so none appears at random.
    """
    yield from rules_of_rehearsals(mission)
    yield from told_once(
        mission, find_unknown(mission, FLEETS, is_surprise=True), _remedy(mission, FLEETS)
    )


def rules_of_robotarium(mission: Mission) -> Iterator[Problem]:
    """Return why robots in the Robotarium's arena cannot do a mission, whatever its size."""
    yield from rules_not_played(mission)
    remedy = _remedy(mission, ROBOTARIUM)
    yield from told_once(mission, find_unknown(mission, ROBOTARIUM, is_surprise=True), remedy)
    yield from told_once(mission, find_unknown(mission, ROBOTARIUM), remedy)
    flying = [
        (("robots", number, "moves"), f"robot '{robot.name}' flies over obstacles")
        for number, robot in enumerate(mission.robots)
        if robot.flies and mission.world.rows
    ]
    yield from told_once(mission, flying, remedy)


def _remedy(mission: Mission, who: str) -> Callable[[str], str]:
    """Return what is told after what a mission has that `who` does not know, by key."""
    verbs = _verbs_for(mission)

    def rest(key: str) -> str:
        what = "write one number" if key == "duration" else f"drop {key}"
        return (
            f"which {who} {'does' if who == ROBOTARIUM else 'do'} not know; {what}, or use {verbs}"
        )

    return rest


def _problems_of_end(mission: Mission) -> Iterator[Problem]:
    ends, world = mission.ends, mission.world
    if ends is None or ends == HOME:
        return
    if isinstance(ends, str):
        yield Problem(("ends",), f"ends '{ends}' is unknown; use home or a place as [x, y]")
    elif not world.is_inside(ends) or not world.is_free(ends):
        where = "inside an obstacle" if world.is_inside(ends) else "outside the map"
        yield Problem(("ends",), f"the mission ends at [{ends[0]}, {ends[1]}], {where}; move it")
    elif world.rows or (isinstance(world, Roads) and not any(world.problems())):
        for number, robot in enumerate(mission.robots):
            is_there = world.is_inside(robot.at) and world.is_free(robot.at)
            if is_there and not can_reach(world, robot, ends):
                message = f"robot '{robot.name}' has no way to where the mission ends"
                message = f"{message}; move it, {way_for(world, 'it')}"
                yield Problem(("robots", number, "at"), message)


def _problems_of_roads(mission: Mission) -> Iterator[Problem]:
    world = mission.world
    if isinstance(world, Roads) and mission.time == "steps":
        message = "roads are for continuous time: in steps robots walk on a map"
        remedy = "write time: continuous"
        yield Problem(("world", "roads"), f"{message}; {remedy}, or use a grid or a plane")
    for number, robot in enumerate(mission.robots):
        where, what = ("robots", number, "moves"), f"robot '{robot.name}' moves by {robot.moves}"
        if not isinstance(world, Roads):
            if robot.moves not in (GROUND, AIR):
                message = (
                    f"{what}, which is for worlds of roads; write ground or air, or name roads"
                )
                yield Problem(where, message)
        elif world.times and robot.moves not in world.times:
            known = ", ".join(world.times)
            message = f"{what}, but there are only roads by {known}"
            yield Problem(where, f"{message}; name a file under roads, or change moves")


def _problems_of_times(mission: Mission) -> Iterator[Problem]:
    for number, task in enumerate(mission.tasks):
        where, what = ("tasks", number), f"task '{task.name}'"
        if mission.time == "continuous" and not is_time(task.duration):
            message = f"{what} has duration {task.duration:g}; use 0 to 1e9"
            yield Problem((*where, "duration"), message)
        if task.between is None:
            continue
        begin, end = task.between
        if not (is_time(begin) and is_time(end) and begin < end):
            message = f"{what} is to be done between {begin:g} and {end:g}; use [begin, end]"
            rule = "0 or more and in this order"
            if max(begin, end) > LARGEST_NUMBER:
                rule = f"up to 1e9{counted_from(('between',))}"
            yield Problem((*where, "between"), f"{message}, {rule}")
        elif mission.time == "continuous" and is_too_short(task):
            message = f"{what} takes {task.duration:g} but has only {end - begin:g} between"
            yield Problem(
                (*where, "between"), f"{message} {begin:g} and {end:g}; give it more time"
            )


def is_too_short(task: Task) -> bool:
    """Say whether a task takes longer than its window lasts, so that it is late whatever is done.

    In steps that may turn out when the task is done, so it is no fault of a mission there.
    """
    return task.between is not None and task.between[0] + task.duration > task.between[1]


def _problems_of_precedence(mission: Mission) -> Iterator[Problem]:
    names = {task.name for task in mission.tasks}
    is_good = True
    for number, task in enumerate(mission.tasks):
        where = ("tasks", number, "after")
        for entry, name in enumerate(task.after):
            if name not in names:
                is_good = False
                message = f"task '{task.name}' is after '{name}', which is no task; name one"
                yield Problem((*where, entry), message)
            elif name in task.after[:entry]:
                yield Problem((*where, entry), f"'{name}' stands twice in this list; keep one")
    if is_good:
        circle = _circle(mission)
        if circle:
            last = next(n for n, task in enumerate(mission.tasks) if task.name == circle[-1])
            way = ", which is after ".join(f"'{name}'" for name in (*circle[::-1], circle[-1]))
            yield Problem(("tasks", last, "after"), f"{way}; break this circle, drop one of these")


def _circle(mission: Mission) -> list[str]:
    """Return the names of tasks of which each is before the next and the last before the first."""
    before = {task.name: task.after for task in mission.tasks}
    is_done: set[str] = set()
    for name in before:
        path: list[str] = []
        at, branches = {name: 0}, [iter(before[name])]
        path.append(name)
        while branches and name not in is_done:
            other = next(branches[-1], None)
            if other is None:
                is_done.add(path[-1])
                del at[path.pop()]
                branches.pop()
            elif other in at:
                return path[at[other] :][::-1]
            elif other not in is_done:
                at[other] = len(path)
                path.append(other)
                branches.append(iter(before[other]))
    return []
