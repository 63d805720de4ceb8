"""The start, the orders and the ending of a record."""

from __future__ import annotations

from teamformer.mission.parts.capabilities import covers, total
from teamformer.record.record import Record
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam, gets_there
from teamformer.record.referee.rules.verdict import Notes

LIMIT_REACHED = "the step limit was reached before"


def start_fleet(record: Record, notes: Notes) -> Fleet:
    """Return the fleet as the mission has it, and say where the record's start differs."""
    mission = record.true_mission
    fleet = Fleet(mission, {}, record.is_coordinated)
    expected = set()
    for robots in mission.starting_teams:
        at = mission.robots[robots[0]].at
        fleet.put(RecordedTeam(set(robots), at))
        expected.add((robots[0], robots, *at))
    if set(record.start) != expected or len(record.start) != len(expected):
        notes.note("the starting teams are not those of the mission")
    return fleet


def judge_orders(record: Record, tasks: Tasks, notes: Notes) -> None:
    """Check that each shared order holds exactly the tasks that are known and undone then."""
    for steps, order in record.orders:
        wanted = tasks.to_share_out(steps)
        if set(order) != wanted or len(order) != len(wanted):
            notes.note(f"the order made after {steps} steps is not one of the open tasks")


def judge_ending(record: Record, fleet: Fleet, tasks: Tasks, over: str, notes: Notes) -> None:
    """Check what the record says of itself against what happened in it.

    `over` says why no more step could be made; it is empty if one could.
    """
    end, mission = record.end, record.mission
    is_completed = tasks.are_over
    makespan = tasks.last if is_completed else None
    facts = {
        "makespan": (end.makespan, makespan),
        "steps": (end.steps, len(record.steps)),
        "tasks_done": (end.tasks_done, len(tasks.done)),
        "joins": (end.joins, sum(len(step.joins) for step in record.steps)),
        "splits": (end.splits, sum(len(step.splits) for step in record.steps)),
    }
    for name, (said, found) in facts.items():
        if said != found:
            notes.note(f"the record says {name} {said}; it is {found}")
    blocked = tuple(blocked_tasks(fleet, tasks, len(record.steps)))
    is_true = {
        "completed": is_completed and makespan == len(record.steps),
        "step limit": over == LIMIT_REACHED and len(record.steps) == mission.step_limit,
        "infeasible": not is_completed and bool(blocked),
        "interrupted": not over,
    }
    if not is_true[end.status]:
        notes.note(f"the record ends as '{end.status}', which is not so")
    if end.blocked_tasks != (blocked if end.status == "infeasible" else ()):
        notes.note(
            f"the record says that {_names(end.blocked_tasks)} are blocked; {_names(blocked)} are"
        )
    if record.lower_bound is not None and makespan is not None and record.lower_bound > makespan:
        notes.note(f"the lower bound {record.lower_bound} is above the makespan {makespan}")
    if end.illegal_decisions < 0:
        notes.note(f"the record says illegal_decisions {end.illegal_decisions}")


def blocked_tasks(fleet: Fleet, tasks: Tasks, steps_made: int) -> list[str]:
    """Name the undone tasks that the robots left and due back around them can never cover.

    A task that is to be called off is none of them.
    """
    mission = fleet.mission
    left = [robot for team in fleet.teams.values() for robot in team.robots]
    left += [robot for robot in fleet.lost if mission.robots[robot].is_due(steps_made)]
    robots = [mission.robots[robot] for robot in left]
    return [
        task.name
        for number, task in enumerate(mission.tasks)
        if number not in tasks.done
        and task.cancelled is None
        and not covers(
            total(r.can for r in robots if gets_there(mission.world, r, task.at)), task.needs
        )
    ]


def why_over(fleet: Fleet, tasks: Tasks, steps_made: int, has_lost: bool) -> str:
    """Say why no more step can be made; empty if one can."""
    if tasks.are_over:
        return "everything was done before"
    if has_lost and blocked_tasks(fleet, tasks, steps_made):
        return "some tasks could never be done since a robot was lost"
    return LIMIT_REACHED if steps_made >= fleet.mission.step_limit else ""


def _names(names: tuple[str, ...]) -> str:
    return ", ".join(names) or "none"
