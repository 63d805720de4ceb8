"""What a shared plan wants each team to do next: part, wait and join, or go on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import astuple
from typing import TypeVar

from teamformer.mission.parts.shifts import Shift
from teamformer.world.reference.formation import may_join, who_stays
from teamformer.world.reference.state import PlainTeam, PlainWorld, Robots, Units
from teamformer.world.reference.ways import apart_squared

Kind = tuple[Units, float, bool, int, tuple[Shift, ...], float, tuple[float, ...]]

Part = TypeVar("Part")


class PlainPlan:
    """A shared plan at work: each robot's tasks, in order, and the task that it looks at first.

    `order` has the open tasks and `coalitions` who does each; `scouts` has pairs of a robot and the
    task that it looks at.
    """

    def __init__(
        self,
        order: Sequence[int],
        coalitions: Sequence[Sequence[int]],
        scouts: Iterable[tuple[int, int]] = (),
    ) -> None:
        self.routes: dict[int, list[int]] = {}
        for task, robots in zip(order, coalitions, strict=False):
            for robot in robots:
                self.routes.setdefault(robot, []).append(task)
        self.looks = dict(scouts)

    def has(self, task: int) -> bool:
        """Say whether anybody is to do a task."""
        return any(task in route for route in self.routes.values())


def follow_plan(
    world: PlainWorld, plan: PlainPlan, is_new: bool
) -> tuple[dict[int, Units], list[tuple[int, int]]]:
    """Write what each robot does next; return what teams want, and who exchanged parts.

    What teams want are the counts, by slot, of those that do not just maintain. A robot's next task
    is the one that it looks at, while there is something to see, else the first open one that it
    has; it stays so until it is over, or the plan is new. A team whose robots have different next
    tasks parts; teams that wait at a task for one another join, pair by pair in slot order.
    """
    _find_next_tasks(world, plan, is_new)
    there = (robot for robot, slot in enumerate(world.slot_of) if slot is not None)
    world.awaited = {task for robot in there for task in plan.routes.get(robot, ())}
    wants: dict[int, Units] = {}
    took: list[tuple[int, int]] = []
    waiting: dict[int, int] = {}
    for slot, team in world.in_slot_order():
        if team.serving:
            continue
        if len({world.next[robot] for robot in team.robots}) > 1:
            wants[slot] = _part(world, plan, team, took)
            continue
        task = world.next[team.robots[0]]
        is_there = task is not None and world.is_same(team.at, world.at[task])
        if task is None or not (is_there and may_join(world, team)):
            continue
        other = waiting.setdefault(task, slot)
        if other != slot and _is_in_reach(world, team, world.teams[other]):
            del waiting[task]
            wants[other] = world.sum_of((*team.robots, *world.teams[other].robots))
    return wants, sorted(took)


def _is_in_reach(world: PlainWorld, team: PlainTeam, other: PlainTeam) -> bool:
    return apart_squared(team.at, other.at) <= world.join_radius**2


def _find_next_tasks(world: PlainWorld, plan: PlainPlan, is_new: bool) -> None:
    """Find each robot's next task where its last one is over, or the plan is new."""
    for robot, task in enumerate(world.next):
        if not is_new and (task is None or task in world.open):
            continue
        looks = plan.looks.get(robot)
        is_unseen = looks in world.open and (looks in world.hidden or looks in world.maybe)
        tasks = [looks] if is_unseen else plan.routes.get(robot, [])
        is_there = world.slot_of[robot] is not None
        found = (k for k in tasks if k in world.open)
        world.next[robot] = next(found, None) if is_there else None


def _part(
    world: PlainWorld, plan: PlainPlan, team: PlainTeam, took: list[tuple[int, int]]
) -> Units:
    """Return the counts to keep so that the robots of one way stay, or all others.

    Ways are looked at in the plan's order. Members stay in robot order while they fit, so it may be
    like ones that stay: they exchange their parts of the plan. If no way can be parted from the
    others like that, the lowest robot goes its own way.
    """
    next_of = {robot: world.next[robot] for robot in team.robots}
    ways = {task for task in next_of.values() if task is not None}
    for way in sorted(ways, key=world.rank):
        for leaves in (False, True):
            meant = tuple(robot for robot in team.robots if (next_of[robot] == way) != leaves)
            counts = world.sum_of(meant)
            stay = who_stays(world, team.robots, counts)
            if _kinds(world, stay) == _kinds(world, meant):
                _exchange(world, plan, stay, meant, took)
                return counts
    return world.brings[team.robots[0]]


def _kinds(world: PlainWorld, robots: Robots) -> list[Kind]:
    return sorted(_kind_of(world, robot) for robot in robots)


def _kind_of(world: PlainWorld, robot: int) -> Kind:
    """Return in what robots are alike: what they bring, how they move, where they get, and when."""
    it = world.mission.robots[robot]
    region = world.world.region(it.at)
    battery = () if it.battery is None else astuple(it.battery)
    return world.brings[robot], it.speed, it.flies, region, it.shifts, it.every, battery


def _exchange(
    world: PlainWorld,
    plan: PlainPlan,
    stay: Robots,
    meant: Robots,
    took: list[tuple[int, int]],
) -> None:
    """Let robots that stay take the parts of like ones that are meant to, and the other way round.

    Each does so at most once, as one that is meant to stay then stays.
    """
    leaving = [robot for robot in meant if robot not in stay]
    for robot in stay:
        if robot not in meant:
            kind = _kind_of(world, robot)
            other = next(mate for mate in leaving if _kind_of(world, mate) == kind)
            leaving.remove(other)
            world.next[robot], world.next[other] = world.next[other], world.next[robot]
            _swap(plan.routes, robot, other)
            _swap(plan.looks, robot, other)
            took.append((min(robot, other), max(robot, other)))


def _swap(parts: dict[int, Part], one: int, other: int) -> None:
    """Give each of two robots what the other has, be it nothing."""
    found = {other: parts.pop(one, None), one: parts.pop(other, None)}
    parts.update({robot: part for robot, part in found.items() if part is not None})
