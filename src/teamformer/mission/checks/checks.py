"""What makes a mission impossible to run, each with its place in the file."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.checks.absence_checks import find_absence_problems
from teamformer.mission.checks.batteries import find_battery_problems
from teamformer.mission.checks.loads import find_load_problems
from teamformer.mission.checks.rules import find_rule_problems, is_whole, problems_of_steps
from teamformer.mission.checks.shift_checks import find_shift_problems
from teamformer.mission.checks.surprise_checks import find_surprise_problems
from teamformer.mission.checks.zone_checks import find_zone_problems
from teamformer.mission.keys.kinds import LARGEST_NUMBER
from teamformer.mission.keys.robot_keys import FASTEST, SLOWEST
from teamformer.mission.parts.capabilities import (
    ONE,
    PLACES,
    Counts,
    covers,
    describe,
    is_exact,
    missing,
    total,
    units_of,
    written,
)
from teamformer.mission.parts.grid import LARGEST_MAP, Grid, Place
from teamformer.mission.parts.places import (
    believed_place,
    busiest_part,
    find_region_problems,
    possible_places,
)
from teamformer.mission.parts.plane import Plane
from teamformer.mission.parts.reach import totals_by_region, totals_there, way_for
from teamformer.mission.parts.roads import Roads

if TYPE_CHECKING:
    from teamformer.mission.model import Mission, Robot, Task, World

LARGEST_COUNT = 16_000_000
"""Of one capability, in units, all robots together: 32-bit floats of networks hold it exactly."""

LONG = 60
"""Letters that a message shows of a capability, where it has to name several."""


def find_problems(mission: Mission) -> Iterator[Problem]:
    """Return everything that makes a mission impossible to run, in file order."""
    spatial = list(_problems_of_world(mission.world))
    spatial = spatial or list(_problems_of_places(mission))  # a broken map has no places
    yield from spatial
    yield from _problems_of_names(mission)
    yield from _problems_of_rules(mission)
    yield from (robots := list(_problems_of_robots(mission)))
    yield from _problems_of_totals(mission)
    yield from _problems_of_teams(mission)
    yield from _problems_of_tasks(mission, places_are_good=not spatial)
    if mission.arrivals is not None and mission.robots and not spatial:
        yield from _problems_of_what_appears(mission)
    are_ways_good = not spatial and not robots and _have_roads(mission)
    yield from find_battery_problems(mission, are_ways_good=are_ways_good)
    yield from find_rule_problems(mission)
    yield from find_surprise_problems(mission)
    yield from find_shift_problems(mission, are_ways_good=are_ways_good)
    yield from find_zone_problems(mission)


def _have_roads(mission: Mission) -> bool:
    """Say whether there are roads for all robots, where robots go by roads."""
    world = mission.world
    return not isinstance(world, Roads) or all(r.moves in world.times for r in mission.robots)


def _problems_of_world(world: World) -> Iterator[Problem]:
    if isinstance(world, Plane | Roads):
        yield from (Problem(("world",), message) for message in world.problems())
        return
    yield from (Problem(("world",), m) for m in (world.frame.problems() if world.frame else ()))
    sides, cells = (world.width, world.height), world.width * world.height
    if not all(is_whole(side) and side >= 1 for side in sides):
        size = f"{world.width} x {world.height}"
        yield Problem(("world",), f"the grid is {size}; make it 1 x 1 or more")
    elif cells > LARGEST_MAP:
        yield Problem(("world",), f"the grid has {cells:,} cells; {LARGEST_MAP:,} are possible")
    if world.rows and {len(row) for row in world.rows} != {world.width}:
        yield Problem(("world",), f"the rows of the map are not all {world.width} cells long")
    if world.rows and len(world.rows) != world.height:
        yield Problem(("world",), f"the map has {len(world.rows)} rows, not {world.height}")


def _problems_of_names(mission: Mission) -> Iterator[Problem]:
    if not mission.robots:
        yield Problem(("robots",), "there is no robot; add one")
    if not mission.tasks:
        yield Problem(("tasks",), "there is no task; add one")
    lists = {
        "capabilities": mission.capabilities,
        "robots": tuple(robot.name for robot in mission.robots),
        "tasks": tuple(task.name for task in mission.tasks),
    }
    for key, names in lists.items():
        seen: set[str] = set()
        for number, name in enumerate(names):
            if name in seen:
                yield Problem((key, number), f"the name '{name}' is used twice; rename one")
            seen.add(name)


def _problems_of_rules(mission: Mission) -> Iterator[Problem]:
    for key in ("sensing_radius", "join_radius", "finding_radius"):
        radius = getattr(mission, key)
        if not radius >= 0:  # NaN too; infinity is allowed, it means everybody
            yield Problem((key,), f"{key} is {radius}; it must be 0 or more")
    if mission.join_radius > mission.sensing_radius >= 0:
        yield Problem(
            ("join_radius",),
            f"join_radius {mission.join_radius:g} is larger than sensing_radius "
            f"{mission.sensing_radius:g}; a team joins only what it senses, so raise the latter",
        )
    if mission.forming_steps not in (0, 1):
        yield Problem(("forming_steps",), f"forming_steps is {mission.forming_steps}; use 0 or 1")
    limit, where = mission.step_limit, ("step_limit",)
    yield from problems_of_steps(limit, 0, where, "step_limit is", "use 1 or more")


def _problems_of_places(mission: Mission) -> Iterator[Problem]:
    world = mission.world
    groups: dict[str, tuple[Robot | Task, ...]] = {
        "robots": mission.robots,
        "tasks": mission.tasks,
    }
    for key, things in groups.items():
        for number, thing in enumerate(things):
            where, what = (key, number, "at"), f"{key[:-1]} '{thing.name}'"
            within = getattr(thing, "within", 0.0)
            fault = _fault_of_place(world, thing.at, bool(within))
            if fault:
                yield Problem(where, f"{what} is at {fault}")
            elif within:
                yield from find_region_problems(
                    world, what, thing.at, within, (key, number, "within")
                )
    for number, task in enumerate(mission.tasks):
        if task.to is None:
            continue
        if fault := _fault_of_place(world, task.to):
            message = f"the load of task '{task.name}' is brought to {fault}"
            yield Problem(("tasks", number, "to"), message)
    for number, charger in enumerate(mission.chargers):
        if fault := _fault_of_place(world, charger.at):
            yield Problem(("chargers", number, "at"), f"charger {number + 1} is at {fault}")
    sought = {task.at for task in mission.tasks if task.within}  # at, or near there
    for zone in mission.zones:
        for entry, place in enumerate(zone.places):
            if fault := _fault_of_place(world, place, place in sought):
                message = f"zone '{zone.name}' has a place at {fault}"
                yield Problem(("zones", zone.name, "places", entry), message)


def _fault_of_place(world: World, place: Place, may_be_blocked: bool = False) -> str:
    """Return a place with what is wrong with it and what to do; empty if nothing is."""
    if isinstance(world, Roads):
        return "" if world.is_inside(place) else f"{place}, which is no place; name one"
    x, y = place
    if not isinstance(world, Plane) and not (is_whole(x) and is_whole(y)):
        return f"[{x}, {y}], which is no cell; use whole numbers"
    if not world.is_inside(place):
        last_x, last_y = world.corner
        inside = f"x goes from 0 to {last_x} and y from 0 to {last_y}"
        return f"[{x}, {y}], outside the map; {inside}"
    if not may_be_blocked and not world.is_free(place):
        return f"[{x}, {y}], inside an obstacle; {_way_out(world, place)}"
    return ""


def _way_out(world: World, place: Place) -> str:
    """Return what to do about a place inside an obstacle."""
    free = world.nearest_free(place) if isinstance(world, Grid) else None
    return "move it" if free is None else f"the nearest free cell is [{free[0]}, {free[1]}]"


def _problems_of_robots(mission: Mission) -> Iterator[Problem]:
    for number, robot in enumerate(mission.robots):
        where = ("robots", number)
        yield from _problems_of_counts(
            robot.can, mission.capabilities, (*where, "can"), f"robot '{robot.name}' can"
        )
        if not SLOWEST <= robot.speed <= FASTEST:
            yield Problem(
                (*where, "speed"),
                f"robot '{robot.name}' has speed {robot.speed:g}; use {SLOWEST} to {FASTEST}",
            )
        yield from find_absence_problems(robot, where, mission.time)


def _problems_of_totals(mission: Mission) -> Iterator[Problem]:
    counts = [robot.can for robot in mission.robots]
    if not all(is_exact(count) for can in counts for count in can.values()):
        return  # which has been told
    units = units_of(counts)
    for name, count in total(counts).items():
        most = LARGEST_COUNT * units[name] // ONE
        if count <= most:
            continue
        have = f"all robots together have {written(count)} x '{name}'"
        if units[name] == ONE:
            yield Problem(("robots",), f"{have}; {most} are possible")
        else:
            finely = f"{most} are possible in steps of {written(units[name] / ONE)}"
            yield Problem(("robots",), f"{have}; {finely}, so use rounder figures")


def _problems_of_counts(
    counts: Counts, known: tuple[str, ...], where: tuple[str | int, ...], what: str
) -> Iterator[Problem]:
    if not counts:
        yield Problem(where, f"{what} nothing; name at least one capability")
    for name, count in counts.items():
        if name not in known:
            near = difflib.get_close_matches(name.casefold(), [cap.casefold() for cap in known], 1)
            meant = [cap for cap in known if near and cap.casefold() == near[0]]
            remedy = f"add it there, or write '{meant[0]}'" if meant else "add it there"
            yield Problem(where, f"{what} '{name}', which is not under capabilities; {remedy}")
        if not 0 < count < math.inf:  # NaN too
            yield Problem((*where, name), f"{what} '{name}' {count} times; use more than 0")
        elif not is_exact(count):
            advice = f"round it to {PLACES} places"
            yield Problem((*where, name), f"{what} '{name}' {count} times; {advice}")


def _problems_of_teams(mission: Mission) -> Iterator[Problem]:
    seen: set[int] = set()
    for number, team in enumerate(mission.teams):
        where = ("teams", number)
        if not team:
            yield Problem(where, "this starting team has no robot; remove it")
        for robot in team:
            if not 0 <= robot < len(mission.robots):
                yield Problem(where, f"there is no robot number {robot}")
                continue
            if robot in seen:
                name = mission.robots[robot].name
                yield Problem(where, f"robot '{name}' is in two starting teams; keep one")
            seen.add(robot)
        places = {mission.robots[r].at for r in team if 0 <= r < len(mission.robots)}
        if len(places) > 1:
            yield Problem(where, "the robots of a starting team must start in the same place")


def _problems_of_tasks(mission: Mission, places_are_good: bool) -> Iterator[Problem]:
    everybody = total(robot.can for robot in mission.robots)
    near = totals_there(mission.world, mission.robots if places_are_good else ())
    for number, task in enumerate(mission.tasks):
        where, what = ("tasks", number), f"task '{task.name}'"
        yield from _problems_of_counts(
            task.needs, mission.capabilities, (*where, "needs"), f"{what} needs"
        )
        if mission.time == "continuous":
            yield from _problems_of_moments(task, where)
        for key in ("duration", "unload", "appears") if mission.time == "steps" else ():
            steps = getattr(task, key)
            said = f"{what} has {key}"
            yield from problems_of_steps(steps, 0, (*where, key), said, "use 0 or more")
        if task.cancelled is not None and mission.time == "steps":
            said = f"{what} is cancelled in step"
            at = (*where, "cancelled")
            yield from problems_of_steps(task.cancelled, 1, at, said, "use 1 or more")
        if places_are_good:
            yield from find_load_problems(mission, number)
        known = {name: n for name, n in task.needs.items() if name in mission.capabilities}
        if not covers(everybody, known):
            yield Problem((*where, "needs"), _impossible(what, everybody, known))
        elif places_are_good:
            worst = {name: n for name, n in task.worst_needs.items() if name in everybody}
            need = known if not covers(everybody, worst) else worst
            have = _least_at(near, mission.world, task, need)
            if not covers(have, need):
                yield Problem(
                    (*where, "at"),
                    f"{what} cannot be reached by robots that bring "
                    f"{describe(missing(have, need))}; "
                    f"move it, {way_for(mission.world, 'such robots')}",
                )


def _least_at(near: Callable[[Place], Counts], world: World, task: Task, need: Counts) -> Counts:
    """Return what robots bring to where a task is, or to a place that it may be at and they lack.

    All cells that it may be at lie in one part of a map; from roads not all ways lead everywhere.
    """
    places: tuple[Place, ...] = (believed_place(world, task),)
    if task.within and isinstance(world, Roads):
        places = possible_places(world, task.at, task.within)
    brought = [near(place) for place in places]
    return next((have for have in brought if not covers(have, need)), brought[0])


def _problems_of_moments(task: Task, where: tuple[str | int, ...]) -> Iterator[Problem]:
    """Return what is wrong with when a task appears and is called off in continuous time."""
    if not 0 <= task.appears <= LARGEST_NUMBER:  # NaN too
        message = f"task '{task.name}' appears at {task.appears:g}; use 0 to 1e9"
        yield Problem((*where, "appears"), message)
    if not 0 <= task.unload <= LARGEST_NUMBER:
        message = f"task '{task.name}' has unload {task.unload:g}; use 0 to 1e9"
        yield Problem((*where, "unload"), message)
    if task.cancelled is not None and not 0 < task.cancelled <= LARGEST_NUMBER:
        message = f"task '{task.name}' is cancelled at {task.cancelled:g}; use more than 0, to 1e9"
        yield Problem((*where, "cancelled"), message)


def _problems_of_what_appears(mission: Mission) -> Iterator[Problem]:
    have = totals_by_region(mission.world, mission.robots)[busiest_part(mission)]
    if not any(count >= 1 for count in have.values()):
        yield Problem(
            ("arrivals",),
            "tasks that appear need one of a capability, but where most robots start all together "
            f"bring {describe(have)}; add such a robot or drop arrivals",
        )


def _impossible(what: str, have: Counts, need: Counts) -> str:
    short = missing(have, need)
    wanted = {name: need[name] for name in short}
    nobody = [name for name in short if not have.get(name)]
    if nobody:
        names, them = _quoted(nobody), "it" if len(nobody) == 1 else "them"
        return (
            f"{what} needs {names} but no robot has {them}; "
            "add such a robot or drop the requirement"
        )
    return (
        f"{what} needs {_brief(wanted)} but all robots together have "
        f"{_brief({name: have[name] for name in short})}; "
        "add such a robot or lower the requirement"
    )


def _brief(counts: Counts) -> str:
    """Write counts for people, with names cut short that would fill the line."""
    return ", ".join(
        f"{written(count)} x {name if len(name) <= LONG else f'{name[:LONG]}...'}"
        for name, count in counts.items()
    )


def _quoted(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)
