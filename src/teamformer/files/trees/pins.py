"""Pins: which robots take part in a task in any case, and which alone may, said in capabilities.

A robot that takes part in any case is a need for that robot, which it alone brings. A task that is
only for some robots needs what it needs of these: of `lift`, say, the `lift of a, b`. So everything
that knows capabilities keeps pins, and they are shown as what they are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from teamformer.files.yaml.reader import Where
from teamformer.files.yaml.tree_reader import Reader
from teamformer.mission.keys.kinds import LONGEST_TEXT
from teamformer.mission.model import Robot, Task, World
from teamformer.mission.parts.capabilities import covers, describe, missing, total
from teamformer.mission.parts.places import possible_places
from teamformer.mission.parts.reach import can_reach, way_for


@dataclass(frozen=True)
class Pins:
    """Robots by number: `only` these may take part if any are named, `having` do in any case."""

    only: tuple[int, ...] = ()
    having: tuple[int, ...] = ()


@dataclass(frozen=True)
class Pinned:
    """A mission's capabilities, robots and tasks, the pins said in them."""

    capabilities: tuple[str, ...]
    robots: tuple[Robot, ...]
    tasks: tuple[Task, ...]


def apply_pins(
    reader: Reader,
    world: World,
    mission: Pinned,
    pins: Sequence[Pins],
) -> Pinned:
    """Return a mission with its pins said in capabilities; refuse pins that nobody can meet."""
    added: dict[str, dict[int, float]] = {}  # what robots bring of each new capability
    tasks = list(mission.tasks)
    for number, (task, pin) in enumerate(zip(mission.tasks, pins, strict=True)):
        _refuse_impossible(reader, world, mission, task, pin, ("tasks", number))
        needs, may_need = dict(task.needs), dict(task.may_need)
        if pin.only:
            named = {
                cap: _name_of(cap, pin.only, mission, number)
                for cap in mission.capabilities  # in their order, whatever that of the needs is
                if cap in needs or cap in may_need
            }
            for cap, name in named.items():
                brings = {robot: mission.robots[robot].can.get(cap, 0) for robot in pin.only}
                added[name] = {robot: count for robot, count in brings.items() if count}
            needs = {named.get(cap, cap): count for cap, count in needs.items()}
            may_need = {named.get(cap, cap): chance for cap, chance in may_need.items()}
        for robot in pin.having:
            name = _name_of_one(robot, mission)
            added[name], needs[name] = {robot: 1}, 1
        tasks[number] = replace(task, needs=needs, may_need=may_need)
    return Pinned(
        capabilities=(*mission.capabilities, *added),
        robots=tuple(
            replace(robot, can={**robot.can, **_brought(added, number)})
            for number, robot in enumerate(mission.robots)
        ),
        tasks=tuple(tasks),
    )


def _brought(added: Mapping[str, Mapping[int, float]], robot: int) -> dict[str, float]:
    return {name: brings[robot] for name, brings in added.items() if robot in brings}


def _name_of(cap: str, only: Sequence[int], mission: Pinned, task: int) -> str:
    """Return what a capability is called that only some robots bring."""
    name = f"{cap} of {', '.join(mission.robots[robot].name for robot in only)}"
    if len(name) > LONGEST_TEXT:
        name = f"{cap[: LONGEST_TEXT - 50]} of those for task {task + 1}"
    return _unused(name, mission.capabilities)


def _name_of_one(robot: int, mission: Pinned) -> str:
    """Return what a capability is called that one robot alone brings: itself."""
    name = f"robot {mission.robots[robot].name}"
    if len(name) > LONGEST_TEXT:
        name = f"robot {robot + 1}, {mission.robots[robot].name[: LONGEST_TEXT - 50]}"
    return _unused(name, mission.capabilities)


def _unused(name: str, taken: Sequence[str]) -> str:
    while name in taken:
        name = f"{name}'"
    return name


def _refuse_impossible(
    reader: Reader, world: World, mission: Pinned, task: Task, pin: Pins, where: Where
) -> None:
    """Refuse pins of a task that nobody can meet, each where it stands."""
    robots = mission.robots
    what, only = f"task '{task.name}'", pin.only or tuple(range(len(robots)))
    for robot in pin.having:
        if robot not in only:
            name = robots[robot].name
            message = f"{what} is with '{name}', but only for others; add it to only, or drop it"
            reader.refuse((*where, "with"), message)
    places = possible_places(world, task.at, task.within) if world.is_inside(task.at) else ()
    if not places or not all(world.is_free(robot.at) for robot in robots):
        return  # which is told of the places
    for robot in pin.having:
        if not can_reach(world, robots[robot], places[0]):
            message = f"{what} is with '{robots[robot].name}', which no way leads there"
            remedy = f"move one of them, {way_for(world, 'it')}"
            reader.refuse((*where, "with"), f"{message}; {remedy}")
    coming = [robots[robot] for robot in pin.only if can_reach(world, robots[robot], places[0])]
    have = total(robot.can for robot in coming)
    wanted = {cap: n for cap, n in task.worst_needs.items() if cap in mission.capabilities}
    if pin.only and not covers(have, wanted):
        short = describe(missing(have, wanted))
        message = f"{what} is only for robots that together lack {short}"
        stay = [robots[robot].name for robot in pin.only if robots[robot] not in coming]
        message += f", as no way leads '{stay[0]}' there" if stay else ""
        reader.refuse((*where, "only"), f"{message}; name more robots, or drop only")
