"""Plans: that they give open tasks to robots that can do them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

from teamformer.record.record import SharedPlanMade
from teamformer.world.reference.state import PlainWorld

Scouts = Sequence[tuple[int, int]]
"""Robots, and the task that each looks at first."""


def faults_of_plan(
    world: PlainWorld, order: Sequence[int], plan: SharedPlanMade, scouts: Scouts | None
) -> Iterator[str]:
    """Say what is wrong with a plan that is made now; `order` has the open tasks."""
    names = [task.name for task in world.mission.tasks]
    rows = dict(zip(order, plan.coalitions, strict=False))
    if len(plan.coalitions) != len(order):
        yield f"has {len(plan.coalitions)} coalitions for {len(order)} open tasks"
    for task, coalition in rows.items():
        if any(world.slot_of[robot] is None for robot in coalition) or not _is_in_order(coalition):
            what = "a robot twice, not in order or one that is lost"
            yield f"has {what} in the coalition of {names[task]}"
        if coalition and not _can_do(world, coalition, task):
            yield f"has a coalition for task {names[task]} that cannot do it"
    yield from _faults_of_order(world, order, rows, names)
    if scouts is not None:
        yield from _faults_of_scouts(world, scouts, names)


def _faults_of_order(
    world: PlainWorld, order: Sequence[int], rows: dict[int, tuple[int, ...]], names: Sequence[str]
) -> Iterator[str]:
    """Say whether what is served does not come first, by who serves it, or what waits last.

    In between tasks are behind those that they come after.
    """
    served = {task: team.robots for team in world.teams.values() for task in team.serving}
    for task, robots in served.items():
        if rows.get(task, robots) != robots:
            yield f"has others do task {names[task]} than those who serve it"
    waiting = sorted({task for task, robots in rows.items() if not robots} - served.keys())
    begin, end = len(served), len(order) - len(waiting)
    if list(order[:begin]) != sorted(served) or list(order[end:]) != waiting:
        yield "does not begin with what is served and end with what has to wait"
    later = set(order[:end])
    for task in order[:end]:
        later.discard(task)
        if later & _all_before(world, task):
            yield f"has task {names[task]} before one that it comes after"


def _all_before(world: PlainWorld, task: int) -> set[int]:
    """Return the tasks that come before one, and those before these; none by way of one that is
    called off or missed.
    """
    found: set[int] = set()
    rest = [task]
    while rest:
        before = set(world.before.get(rest.pop(), ())) - world.cancelled.keys() - found
        before -= world.missed.keys()
        found |= before
        rest += before
    return found


def _faults_of_scouts(world: PlainWorld, scouts: Scouts, names: Sequence[str]) -> Iterator[str]:
    """Say who is none that is left, or looks at what is known or not open."""
    robots = [robot for robot, _ in scouts]
    if any(world.slot_of[robot] is None for robot in robots) or not _is_in_order(robots):
        yield "has a scout twice, not in order or one that is lost"
    for _, task in scouts:
        is_unseen = task in world.hidden or task in world.maybe
        if task not in world.open or not is_unseen:
            yield f"has somebody look at task {names[task]}, of which all is known"


def _can_do(world: PlainWorld, robots: Sequence[int], task: int) -> bool:
    region = world.task_regions[task]
    there = (robot for robot in robots if world.regions[robot] in (None, region))
    return world.covers(world.sum_of(there), task)


def _is_in_order(numbers: Sequence[int]) -> bool:
    return all(one < other for one, other in pairwise(numbers))
