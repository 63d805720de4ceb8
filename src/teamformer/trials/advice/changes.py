"""Missions with one thing changed: a robot more, less, faster, abler, for longer; a task less."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from teamformer.base.errors import MissionError
from teamformer.mission.model import Mission, Robot, Task
from teamformer.mission.orders import with_robots
from teamformer.mission.parts.shifts import Shift
from teamformer.record.critical_path.stretches import Stretch
from teamformer.world.rules.constants import NOBODY

KINDS = ("more", "fewer", "faster", "kept", "longer", "taught", "left out")
MORE, FEWER, FASTER, KEPT, LONGER, TAUGHT, LEFT_OUT = KINDS

LONGER_BY = 0.25
"""By which share of it the last shift of robots ends later."""


@dataclass(frozen=True)
class Change:
    """A change of a mission, in words, and the mission with it; None if it is then impossible.

    `robots` and `task` are what it is about, by number; there may be no task.
    """

    kind: str  # one of KINDS
    what: str
    mission: Mission | None
    robots: tuple[int, ...] = ()
    task: int = NOBODY

    def share_of(self, path: Sequence[Stretch]) -> float:
        """Return for how long a critical path is about its robots or its task."""
        parts = (s for s in path if s.robot in self.robots or s.task == self.task != NOBODY)
        return sum(stretch.end - stretch.begin for stretch in parts)


def changes_of(mission: Mission) -> Iterator[Change]:
    """Yield every change that is measured, in a fixed order.

    One more robot of each kind, where the first of it starts; one fewer, the last of it; each robot
    and each kind at double speed; each robot that is lost kept; each kind with shifts working on
    in its last one, and without breaks; each capability taught to each kind that lacks it; each
    task left out. Robots are of one kind if they bring the same, are equally fast, and are lost,
    back and at work alike.
    """
    kinds = _kinds(mission)
    for robots in kinds:
        first = mission.robots[robots[0]]
        yield _change(MORE, f"one more robot like {first.name}", _adding(mission, first), robots)
    for robots in kinds:
        name = mission.robots[robots[0]].name
        what = f"one fewer robot like {name}" if len(robots) > 1 else f"without robot {name}"
        yield _change(FEWER, what, _without_robot(mission, robots[-1]), robots)
    for number in _different(mission):
        what = f"{mission.robots[number].name} at double speed"
        yield _change(FASTER, what, _faster(mission, [number]), [number])
    for robots in kinds:
        if len(robots) > 1:
            what = f"all robots like {mission.robots[robots[0]].name} at double speed"
            yield _change(FASTER, what, _faster(mission, robots), robots)
    for number, robot in enumerate(mission.robots):
        if robot.absences:
            kept = _changing(mission, [number], lambda robot: replace(robot, absences=()))
            yield _change(KEPT, f"{robot.name} is not lost", kept, [number])
    for robots in kinds:
        if mission.robots[robots[0]].shifts:
            yield from _longer_shifts(mission, robots)
    for robots in kinds:
        for cap in mission.capabilities:
            if not mission.robots[robots[0]].can.get(cap):
                name = mission.robots[robots[0]].name
                who = f"robots like {name}" if len(robots) > 1 else name
                what = f"{who} can also {cap}"
                yield _change(TAUGHT, what, _taught(mission, robots, cap), robots)
    for number, task in enumerate(mission.tasks):
        if len(mission.tasks) > 1:
            left_out = _change(LEFT_OUT, f"without task {task.name}", _without_task(mission, task))
            yield replace(left_out, task=number)


def _change(
    kind: str, what: str, make: Callable[[], Mission], robots: Sequence[int] = ()
) -> Change:
    """Return a change; one that makes the mission impossible has none."""
    try:
        mission = make()
    except MissionError:
        return Change(kind, what, None, tuple(robots))
    return Change(kind, what, mission, tuple(robots))


def _kinds(mission: Mission) -> list[list[int]]:
    """Return the robots of each kind, in order."""
    kinds: dict[object, list[int]] = {}
    for number, robot in enumerate(mission.robots):
        can = tuple(sorted(robot.can.items()))
        key = (robot.speed, can, robot.absences, robot.breaks, robot.rota)
        kinds.setdefault(key, []).append(number)
    return list(kinds.values())


def _different(mission: Mission) -> list[int]:
    """Return the robots that differ, by what they are and where they start: the first of equals."""
    first: dict[object, int] = {}
    for number, robot in enumerate(mission.robots):
        can = tuple(sorted(robot.can.items()))
        key = (robot.speed, can, robot.at, robot.absences, robot.rota)
        first.setdefault(key, number)
    return list(first.values())


def _adding(mission: Mission, like: Robot) -> Callable[[], Mission]:
    names = {robot.name for robot in mission.robots}
    number = next(n for n in range(2, len(names) + 3) if f"{like.name}-{n}" not in names)
    new = replace(like, name=f"{like.name}-{number}", absences=())
    return lambda: replace(mission, robots=(*mission.robots, new), step_limit=0)


def _without_robot(mission: Mission, gone: int) -> Callable[[], Mission]:
    def make() -> Mission:
        left = [number for number in range(len(mission.robots)) if number != gone]
        return with_robots(mission, left)

    return make


def _faster(mission: Mission, robots: list[int]) -> Callable[[], Mission]:
    return _changing(mission, robots, lambda robot: replace(robot, speed=2 * robot.speed))


def _longer_shifts(mission: Mission, robots: list[int]) -> Iterator[Change]:
    """Yield the robots of a kind with a last shift that is longer, and with no breaks."""
    first = mission.robots[robots[0]]
    who = f"robots like {first.name} work" if len(robots) > 1 else f"{first.name} works"
    (begins, ends), latest = first.shifts[-1], first.shifts[0][0] + first.every
    longer = LONGER_BY * (ends - begins)
    until = ends + (math.ceil(longer) if mission.time == "steps" else longer)
    until = min(until, latest) if first.every else until
    if until > ends:
        shifts = (*first.shifts[:-1], (begins, until))
        what = f"{who} {until - ends:g} longer in the last shift"
        yield _change(LONGER, what, _working(mission, robots, shifts), robots)
    if len(first.shifts) > 1:
        whole = ((first.shifts[0][0], ends),)
        yield _change(LONGER, f"{who} without breaks", _working(mission, robots, whole), robots)


def _working(
    mission: Mission, robots: list[int], shifts: tuple[Shift, ...]
) -> Callable[[], Mission]:
    return _changing(mission, robots, lambda robot: replace(robot, shifts=shifts))


def _taught(mission: Mission, robots: list[int], cap: str) -> Callable[[], Mission]:
    """Teach robots a capability: as much of it as the robot that brings least of it."""
    least = min((robot.can[cap] for robot in mission.robots if robot.can.get(cap)), default=1)
    return _changing(mission, robots, lambda robot: replace(robot, can={**robot.can, cap: least}))


def _changing(
    mission: Mission, chosen: list[int], change: Callable[[Robot], Robot]
) -> Callable[[], Mission]:
    """Change some of the robots."""

    def make() -> Mission:
        robots = enumerate(mission.robots)
        changed = (change(robot) if number in chosen else robot for number, robot in robots)
        return replace(mission, robots=tuple(changed), step_limit=0)

    return make


def _without_task(mission: Mission, gone: Task) -> Callable[[], Mission]:
    """Leave a task out; what was after it is after what that was after."""

    def make() -> Mission:
        left = []
        for task in mission.tasks:
            if task.name == gone.name:
                continue
            after = [name for name in task.after if name != gone.name]
            if len(after) < len(task.after):
                after += [name for name in gone.after if name not in after]
            starts = {name: gap for name, gap in task.starts.items() if name != gone.name}
            left.append(replace(task, after=tuple(after), starts=starts))
        return replace(mission, tasks=tuple(left), step_limit=0)

    return make
