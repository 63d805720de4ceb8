"""What is wrong with batteries and chargers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.checks.links import (
    all_apart,
    can_be_apart,
    groups_of,
    problems_of_names,
)
from teamformer.mission.keys.charging_keys import MOST_ROOM, MOST_SPENT
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.parts.capabilities import covers, describe, missing, total
from teamformer.mission.parts.charging import Charger, Charging, has_batteries
from teamformer.mission.parts.reach import can_reach

if TYPE_CHECKING:
    from teamformer.mission.model import Mission

REMEDY = "put a charger nearer, or give batteries that last longer"


def find_battery_problems(mission: Mission, are_ways_good: bool) -> Iterator[Problem]:
    """Return what is wrong with batteries and chargers, but for where these are."""
    problems = [*_problems_of_batteries(mission), *_problems_of_rooms(mission.chargers)]
    yield from problems
    if not has_batteries(mission.robots):
        return
    if not mission.chargers:
        number, name = _first_with_battery(mission)
        message = f"robot '{name}' has a battery, but there is no charger; add chargers, or drop it"
        yield Problem(("robots", number, "battery"), message)
    elif are_ways_good and not problems:
        yield from _problems_of_reach(mission)


def _first_with_battery(mission: Mission) -> tuple[int, str]:
    return next((n, robot.name) for n, robot in enumerate(mission.robots) if robot.battery)


def _problems_of_batteries(mission: Mission) -> Iterator[Problem]:
    for number, robot in enumerate(mission.robots):
        battery = robot.battery
        if battery is None:
            continue
        where, what = ("robots", number, "battery"), f"the battery of robot '{robot.name}'"
        if not 0 < battery.lasts <= LARGEST_NUMBER:  # NaN too
            message = f"{what} lasts {battery.lasts:g}; use more than 0, to 1e9"
            yield Problem((*where, "lasts"), message)
        if not 0 <= battery.fills <= LARGEST_NUMBER:
            yield Problem((*where, "fills"), f"{what} fills in {battery.fills:g}; use 0 to 1e9")
        if not 0 <= battery.starts <= 1:
            message = f"{what} starts with {battery.starts:g} of what it holds; use 0 to 1"
            yield Problem((*where, "starts"), message)
        for key in ("serving", "waiting"):
            spent = getattr(battery, key)
            if not 0 <= spent <= MOST_SPENT:
                message = f"{what} spends {spent:g} on {key}; use 0 to {MOST_SPENT}"
                yield Problem((*where, key), message)


def _problems_of_rooms(chargers: tuple[Charger, ...]) -> Iterator[Problem]:
    for number, charger in enumerate(chargers):
        if not (charger.room == int(charger.room) and 1 <= charger.room <= MOST_ROOM):
            message = f"charger {number + 1} has room for {charger.room} robots; use 1 to "
            yield Problem(("chargers", number, "room"), f"{message}{MOST_ROOM}")


def _problems_of_reach(mission: Mission) -> Iterator[Problem]:
    """Return which robots get to no charger, or not home, and which tasks nobody can do.

    Optional tasks that nobody can do are missed.
    """
    charging = mission.charging
    assert charging is not None, "somebody has a battery"
    for number, robot in enumerate(mission.robots):
        where = ("robots", number, "battery")
        if robot.battery is None:
            continue
        if not charging.in_reach(number):
            message = f"robot '{robot.name}' gets to no charger with what its battery starts with"
            yield Problem(where, f"{message}; put one nearer, or let it start with more")
        elif mission.ends is not None and not charging.gets_home(number):
            message = f"robot '{robot.name}' does not get from a charger to where the mission ends"
            yield Problem(where, f"{message}; {REMEDY}")
    if mission.time == "steps":
        yield from _problems_of_steps(mission)
        return
    too_far = [*_problems_of_tasks(mission, charging)]
    yield from too_far or _problems_of_links(mission, charging)


def _problems_of_tasks(mission: Mission, charging: Charging) -> Iterator[Problem]:
    """Return which tasks that must be done nobody is able for who brings what they need."""
    everybody = total(robot.can for robot in mission.robots)
    for number, task in enumerate(mission.tasks):
        needs = {cap: n for cap, n in task.needs.items() if cap in mission.capabilities}
        able = charging.able(range(len(mission.robots)), number)
        have = total(mission.robots[robot].can for robot in able)
        if not task.optional and covers(everybody, needs) and not covers(have, needs):
            short = describe(missing(have, needs))
            message = f"task '{task.name}' is too far from chargers for full batteries of robots"
            yield Problem(("tasks", number, "at"), f"{message} that bring {short}; {REMEDY}")


def _problems_of_links(mission: Mission, charging: Charging) -> Iterator[Problem]:
    """Return which linked tasks too few robots are able for, as different ones do them."""
    tasks, cans = mission.tasks, [robot.can for robot in mission.robots]
    if any(problems_of_names(mission)):
        return
    for group in groups_of(tasks):
        for apart in all_apart(tasks, group) if len(group) > 1 else ():
            if tasks[apart[0]].optional:
                continue
            needs = [tasks[number].needs for number in apart]
            able = partial(_is_able, charging, apart)
            if can_be_apart(needs, cans) and not can_be_apart(needs, cans, able):
                listed = ", ".join(f"'{tasks[number].name}'" for number in apart)
                where = ("tasks", max(n for n in apart if tasks[n].starts), "starts")
                message = f"{listed} are done by different robots, and too few get to a charger"
                yield Problem(where, f"{message} from there; {REMEDY}, or drop a link")


def _is_able(charging: Charging, tasks: Sequence[int], robot: int, number: int) -> bool:
    return charging.is_able(robot, tasks[number])


def _problems_of_steps(mission: Mission) -> Iterator[Problem]:
    """Return which robots may not go along everywhere: in steps teams walk as one."""
    charging = mission.charging
    assert charging is not None, "somebody has a battery"
    for number, robot in enumerate(mission.robots):
        if robot.battery is None:
            continue
        if robot.flies and mission.world.rows:
            message = f"robot '{robot.name}' flies over obstacles with a battery"
            remedy = "in steps only who walks may have one; drop the battery, or moves"
            yield Problem(("robots", number, "battery"), f"{message}; {remedy}")
            continue
        for entry, task in enumerate(mission.tasks):
            if can_reach(mission.world, robot, task.at) and not charging.is_able(number, entry):
                message = f"task '{task.name}' is too far from chargers for a full battery"
                which = (
                    f"{message} of robot '{robot.name}'; in steps teams walk as one, so {REMEDY}"
                )
                yield Problem(("tasks", entry, "at"), which)
                break
