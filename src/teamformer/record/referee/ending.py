"""The start and the ending of a record."""

from __future__ import annotations

from teamformer.record.record import Record
from teamformer.record.referee.verdict import Notes
from teamformer.world.reference.completion import blocked_tasks
from teamformer.world.reference.state import PlainWorld


def judge_start(record: Record, world: PlainWorld, notes: Notes) -> None:
    """Check that teams start as the mission has them."""
    starts = tuple((slot, team.robots, *team.at) for slot, team in world.in_slot_order())
    if record.start != starts:
        notes.note("the starting teams are not those of the mission, in order")


def judge_ending(record: Record, world: PlainWorld, status: str, notes: Notes) -> None:
    """Check what a record says of itself against the world after its last step."""
    end = record.end
    makespan = world.steps if status == "completed" else None
    blocked = tuple(blocked_tasks(world)) if status == "infeasible" else ()
    facts = {
        "makespan": (end.makespan, makespan),
        "steps": (end.steps, world.steps),
        "tasks_done": (end.tasks_done, len(world.done)),
        "missed": (_names(end.missed), _names(_missed_names(world))),
        "joins": (end.joins, world.joins),
        "splits": (end.splits, world.splits),
        "illegal_decisions": (end.illegal_decisions, world.illegal),
        "status": (end.status, "interrupted" if status == "running" else status),
        "blocked_tasks": (_names(end.blocked_tasks), _names(blocked)),
    }
    for name, (said, found) in facts.items():
        if said != found:
            notes.note(f"the record says {name} {said}; it is {found}")
    if record.lower_bound is not None and makespan is not None and record.lower_bound > makespan:
        notes.note(f"the lower bound {record.lower_bound} is above the makespan {makespan}")


def _missed_names(world: PlainWorld) -> tuple[str, ...]:
    return tuple(world.mission.tasks[task].name for task in sorted(world.missed))


def _names(names: tuple[str, ...]) -> str:
    return ", ".join(names) or "none"
