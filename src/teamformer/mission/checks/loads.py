"""Loads: tasks that are brought from one place to another."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from teamformer.base.errors import Problem
from teamformer.mission.parts.capabilities import covers, total
from teamformer.mission.parts.places import believed_place
from teamformer.mission.parts.reach import can_reach
from teamformer.mission.parts.roads import Roads

if TYPE_CHECKING:
    from teamformer.mission.model import Mission


def find_load_problems(mission: Mission, number: int) -> Iterator[Problem]:
    """Return why the load of a task cannot be brought to where it is to go."""
    task, world = mission.tasks[number], mission.world
    if task.to is None:
        if task.unload:
            message = f"task '{task.name}' has unload {task.unload:g} but nothing to carry"
            yield Problem(("tasks", number, "unload"), f"{message}; add to: [x, y] or drop it")
        return
    place = believed_place(world, task)
    if isinstance(world, Roads):
        yield from _problems_on_roads(mission, number)
    elif world.region(place) != world.region(task.to):
        (x, y), (to_x, to_y) = place, task.to
        message = f"nobody can bring the load of task '{task.name}' from [{x}, {y}]"
        is_flown_to = any(robot.flies for robot in mission.robots)
        fault = "no way leads there"
        if is_flown_to:
            fault += " on the ground, and robots do not fly loads over obstacles yet"
        remedy = "move one of the two or open the map"
        if is_flown_to and mission.time == "steps":
            remedy += ", and drop moves: air"
        yield Problem(("tasks", number, "to"), f"{message} to [{to_x}, {to_y}]: {fault}; {remedy}")


def _problems_on_roads(mission: Mission, number: int) -> Iterator[Problem]:
    """Return why robots that get to a load have no way on with it."""
    task, world = mission.tasks[number], mission.world
    assert isinstance(world, Roads), "the caller has looked"
    assert task.to is not None, "it is a load"
    there = [robot for robot in mission.robots if can_reach(world, robot, task.at)]
    able = total(r.can for r in there if world.leads(r.moves, task.at, task.to))
    if covers(total(robot.can for robot in there), task.needs) and not covers(able, task.needs):
        names = f"from '{world.name_of(task.at)}' to '{world.name_of(task.to)}'"
        message = f"robots that can take up the load of task '{task.name}' have no way {names}"
        yield Problem(("tasks", number, "to"), f"{message}; give such a way a time under roads")


def find_flown_loads(mission: Mission) -> Iterator[Problem]:
    """Return the loads of a mission in steps in which robots fly over obstacles.

    A team that flies and loses robots might set a load down where nobody on the ground gets to.
    """
    flying = [robot.name for robot in mission.robots if robot.flies]
    if not mission.world.rows or not flying:
        return
    for number, task in enumerate(mission.tasks):
        if task.to is not None:
            message = f"task '{task.name}' has a load and robot '{flying[0]}' flies"
            fault = "on a map with obstacles a mission cannot have both yet"
            remedy = f"drop moves: air of '{flying[0]}', or drop to and unload"
            yield Problem(("tasks", number, "to"), f"{message}: {fault}; {remedy}")


def rules_without_loads(mission: Mission, who: str) -> Iterator[Problem]:
    """Return why `who`, such as a fleet of processes, cannot do a mission: it has loads."""
    for number, task in enumerate(mission.tasks):
        if task.to is not None:
            message = f"task '{task.name}' has a load, which {who} cannot carry yet"
            remedy = "drop to and unload, or use `teamformer run`, `compare` or `live`"
            yield Problem(("tasks", number, "to"), f"{message}; {remedy}")
