"""When orders and plans are due, and why: whenever something happens, never else."""

from __future__ import annotations

from collections.abc import Collection

from teamformer.mission.coordination import NEWS
from teamformer.world.reference.following import PlainPlan
from teamformer.world.reference.state import PlainWorld


def is_order_due(world: PlainWorld) -> bool:
    """Say whether there are new tasks to share out after a step, or before the first."""
    arrived = world.happened.known if world.is_coordinated else world.happened.opened
    return world.steps == 0 or bool(arrived)


def why_plan(world: PlainWorld, plan: PlainPlan | None, heeds: Collection[str]) -> tuple[str, ...]:
    """Return why a plan is due after a step, or before the first; nothing if none is.

    `plan` is the one that holds until then, and `heeds` says which news lead to a plan.
    """
    happened = world.happened
    is_true = {
        "start": world.steps == 0,
        "task appeared": world.steps > 0 and (bool(happened.known) or _leaves_out(world, plan)),
        "robot lost": bool(happened.lost) or _works_no_more(world),
        "service broken off": happened.any_broken_off,
        "robot back": bool(happened.back),
        "needs known": bool(happened.shown),
        "service overdue": happened.any_overdue,
        "task found": happened.is_elsewhere or _is_looked_at(plan, happened.found),
        "task cancelled": bool(happened.cancelled),
        "task done": bool(happened.done),
    }
    return tuple(why for why in NEWS if is_true[why] and (why == "start" or why in heeds))


def _works_no_more(world: PlainWorld) -> bool:
    """Say whether the last shift of a robot that is there is over: it counts as lost."""
    over = [robot for robot, rota in enumerate(world.rotas) if rota.over == world.steps]
    return any(world.slot_of[robot] is not None for robot in over)


def _leaves_out(world: PlainWorld, plan: PlainPlan | None) -> bool:
    """Say whether a task that comes after others may begin now, and nobody is to do it."""
    opened = [task for task in world.happened.opened if world.before.get(task)]
    return plan is not None and any(not plan.has(task) for task in opened)


def _is_looked_at(plan: PlainPlan | None, found: Collection[int]) -> bool:
    """Say whether somebody was to look at a task that was found."""
    return plan is not None and not set(plan.looks.values()).isdisjoint(found)
