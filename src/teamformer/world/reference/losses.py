"""Phase 6: tasks that are called off, robots that are lost, and robots that are back."""

from __future__ import annotations

from teamformer.world.reference.charging import is_dry
from teamformer.world.reference.state import PlainWorld


def call_off(world: PlainWorld) -> None:
    """Call off the undone tasks that are cancelled in this step: who serves one is free."""
    for task, wanted in enumerate(world.mission.tasks):
        if wanted.cancelled != world.steps + 1 or world.over_in(task) is not None:
            continue
        world.cancelled[task] = world.steps + 1
        world.happened.cancelled.append(task)
        world.drop(task)


def lose_robots(world: PlainWorld) -> None:
    """Take lost and dry robots out of their teams; the others keep all, be it at a new slot.

    Where nobody is left, what the team served is served no more, and its load lies there.
    """
    for robot, slot in enumerate(world.slot_of):
        absences = world.truth.robots[robot].absences
        if slot is not None and is_dry(world, robot):
            world.dry.add(robot)
        is_lost = any(away.lost == world.steps + 1 for away in absences)
        if slot is None or not (is_lost or robot in world.dry):
            continue
        old = world.teams.pop(slot)
        world.slot_of[robot], world.lost_at[robot] = None, old.at
        world.happened.lost.append(robot)
        if rest := [mate for mate in old.robots if mate != robot]:
            team = world.found_team(rest, old.at)
            team.task, team.is_detour, team.credit = old.task, old.is_detour, old.credit
            team.serving, team.pursued = old.serving, old.pursued
            team.charger, team.charges_for = old.charger, old.charges_for
        else:
            world.served -= old.serving.keys()
            world.let_go |= dict.fromkeys(world.carried & old.serving.keys(), old.at)


def return_robots(world: PlainWorld) -> None:
    """Let robots that are back be teams of their own, each where it was lost."""
    for robot, place in sorted(world.lost_at.items()):
        absences = world.truth.robots[robot].absences
        is_back = any(away.back == world.steps + 1 for away in absences)
        if is_back and robot not in world.dry:
            del world.lost_at[robot]
            world.found_team((robot,), place)
            world.happened.back.append(robot)
