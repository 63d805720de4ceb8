"""What each team pursued in a step: as far as rules and record say, and whether these agree.

A record says after each step what a team heads for. If news took that back, `pursued` says what it
was, but where it headed for the same before. Where decisions may name tasks that no list has, what
a team pursued is known only so far, and its way has to agree with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from teamformer.record.record import Step
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam
from teamformer.record.referee.rules.verdict import Notes

Assignments = Mapping[int, int | None]
"""What the team of each slot headed for before a step."""


def expect_pursuits(fleet: Fleet, named: Sequence[int]) -> None:
    """Write down what teams are sure to pursue, once all have formed and before they walk."""
    for slot, team in fleet.teams.items():
        team.was_serving, team.is_named = bool(team.services), slot in named
        team.had_task = not team.has_formed and team.task is not None
        team.is_pursuit_sure = team.was_serving or (fleet.is_coordinated and not team.is_named)
        planned = team.due if fleet.is_coordinated else None
        team.pursues = team.task if team.was_serving else planned


def check_named(fleet: Fleet, named: Sequence[int], notes: Notes) -> None:
    """Check, once all have formed and before losses, that those named are teams that may be."""
    if named and not fleet.is_coordinated:
        notes.note("the record names tasks, which it does only where there are plans")
    for slot in named:
        if slot not in fleet.teams:
            robot = fleet.mission.robots[slot].name
            notes.note(f"the record names the task of a team of robot {robot} that is not there")


def check_pursuits(
    fleet: Fleet, tasks: Tasks, step: Step, before: Assignments, number: int, notes: Notes
) -> None:
    """Check once all is assigned that the record says what teams pursued where it has to."""
    names = [task.name for task in fleet.mission.tasks]
    said = dict(step.pursued)
    for slot, goal in step.pursued:
        if slot not in fleet.teams:
            notes.note(f"the record has a team pursue task {names[goal]} that is not there")
        elif not tasks.is_open(goal, number - 1) and tasks.over_in(goal) != number:
            name = fleet.name(fleet.teams[slot])
            notes.note(f"{name} pursues task {names[goal]}, which is not open")
    if len(said) < len(step.pursued):
        notes.note("the record has a team pursue two tasks")
    for slot, team in sorted(fleet.teams.items()):
        task, kept = said.get(slot), before.get(slot)
        if task is not None and (team.task is not None or task == kept):
            notes.note(f"the record says twice that {fleet.name(team)} pursues {names[task]}")
        elif team.task is None and team.is_pursuit_sure:
            _check_sure_one(fleet, team, task, kept, notes)
        elif team.task is None and task is None and kept is None and _has_surely_some(team):
            notes.note(f"the record does not say what {fleet.name(team)} pursued")


def _check_sure_one(
    fleet: Fleet, team: RecordedTeam, said: int | None, kept: int | None, notes: Notes
) -> None:
    untold = None if team.pursues == kept else team.pursues
    if said != untold:
        names = ["nothing", *(f"task {task.name}" for task in fleet.mission.tasks)]
        does, should = (names[0 if task is None else task + 1] for task in (said, untold))
        notes.note(f"the record has {fleet.name(team)} pursue {does} in the end; it is {should}")


def _has_surely_some(team: RecordedTeam) -> bool:
    """Say whether a team pursued some task, be it not known which."""
    return not team.has_formed and (team.had_task or team.is_named)


def possible_pursuits(
    fleet: Fleet, step: Step, before: Assignments
) -> dict[int, tuple[int | None, ...]]:
    """Return by slot what each team can have pursued, none being one of them."""
    said = dict(step.pursued)
    return {
        slot: _possible(team, said.get(slot), before.get(slot))
        for slot, team in fleet.teams.items()
    }


def _possible(team: RecordedTeam, said: int | None, kept: int | None) -> tuple[int | None, ...]:
    if team.task is not None:
        return (team.task,)
    if said is not None:
        return (said,)
    if team.is_pursuit_sure:
        return (team.pursues,)
    if kept is None or _has_surely_some(team):
        return (kept,)
    return (kept, None)
