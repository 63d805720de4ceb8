"""Tasks that nobody will do: too late, optional and wanted by no plan, or their robots are lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from teamformer.mission.checks.optional import is_in_time
from teamformer.mission.parts.capabilities import covers
from teamformer.mission.parts.reach import totals_there
from teamformer.world.continuous.reasons import why_left_out
from teamformer.world.continuous.world import PhysicalWorld


def misses(world: PhysicalWorld, task: int, team: Sequence[int]) -> bool:
    """Let a task be missed whose whole team stands there too late; say whether it is.

    It could not end by the time at which the mission is over, as long as it is believed to take.
    """
    wanted = world.mission.tasks[task]
    forms = len({world.bodies[robot].came_from for robot in team}) > 1
    begins = world.now + world.mission.forming * forms
    end = begins + (wanted.duration + world.carried(task, team) + wanted.unload)
    is_late = not is_in_time(end, world.mission.until)
    if is_late:
        world.miss(task, "too late")
    return is_late


def gives_up(world: PhysicalWorld) -> bool:
    """Let all that is left be missed if it is optional, and nobody new will come for it.

    Say whether it was.
    """
    tasks = world.truth.tasks
    left = [task for task in range(len(tasks)) if task not in world.over]
    is_optional = all(tasks[task].optional for task in left)
    if not left or not is_optional or hopes(world, left):
        return False
    for task in left:
        world.miss(task, why_left_out(world.truth, world.ways, task))
    return True


def hopes(world: PhysicalWorld, left: Sequence[int]) -> bool:
    """Say whether a robot will be back, or a task that is left will appear."""
    is_due = any(
        body.is_lost and world.truth.robots[robot].is_due(world.now)
        for robot, body in enumerate(world.bodies)
    )
    return is_due or any(task not in world.appeared for task in left)


def has_failed(world: PhysicalWorld) -> bool:
    """Say whether a task that must be done is missed."""
    return any(not world.truth.tasks[task].optional for task in world.missed)


def blocked_tasks(world: PhysicalWorld) -> tuple[int, ...]:
    """Return the tasks that must be done and cannot, by robots that are left or will be back."""
    truth = world.truth
    left = [
        replace(robot, at=world.next_place(number).place)
        for number, robot in enumerate(truth.robots)
        if not world.bodies[number].is_lost
        or (robot.is_due(world.now) and not world.is_dry(number))
    ]
    have = totals_there(truth.world, left)
    return tuple(
        number
        for number, task in enumerate(truth.tasks)
        if number not in world.over and number not in world.works
        if not covers(have(world.place_of(number)), task.needs)
        if task.cancelled is None and not task.optional
    )
