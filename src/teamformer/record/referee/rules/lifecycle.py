"""The start, the orders and the ending of a record."""

from __future__ import annotations

from teamformer.mission.parts.capabilities import covers, total
from teamformer.record.record import Record
from teamformer.record.referee.rules.completion import Tasks
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam, gets_there
from teamformer.record.referee.rules.verdict import Notes

LIMIT_REACHED = "the step limit was reached before"


def start_fleet(replay: Record, notes: Notes) -> Fleet:
    """Return the fleet as the scenario has it, and say where the record's start differs."""
    scenario = replay.mission
    fleet = Fleet(scenario, {}, replay.is_coordinated)
    expected = set()
    for robots in scenario.starting_teams:
        at = scenario.robots[robots[0]].at
        fleet.put(RecordedTeam(set(robots), at))
        expected.add((robots[0], robots, *at))
    if set(replay.start) != expected or len(replay.start) != len(expected):
        notes.note("the starting teams are not those of the scenario")
    return fleet


def judge_orders(replay: Record, tasks: Tasks, notes: Notes) -> None:
    """Check that each shared order holds exactly the tasks that are known and undone then."""
    for steps, order in replay.orders:
        wanted = tasks.to_share_out(steps)
        if set(order) != wanted or len(order) != len(wanted):
            notes.note(f"the order made after {steps} steps is not one of the open tasks")


def judge_ending(replay: Record, fleet: Fleet, tasks: Tasks, over: str, notes: Notes) -> None:
    """Check what the record says of itself against what happened in it.

    `over` says why no more step could be made; it is empty if one could.
    """
    end, scenario = replay.end, replay.scenario
    is_completed = tasks.are_over
    makespan = tasks.last if is_completed else None
    facts = {
        "makespan": (end.makespan, makespan),
        "steps": (end.steps, len(replay.steps)),
        "tasks_done": (end.tasks_done, len(tasks.done)),
        "joins": (end.joins, sum(len(step.joins) for step in replay.steps)),
        "splits": (end.splits, sum(len(step.splits) for step in replay.steps)),
    }
    for name, (said, found) in facts.items():
        if said != found:
            notes.note(f"the record says {name} {said}; it is {found}")
    blocked = tuple(blocked_tasks(fleet, tasks, len(replay.steps)))
    is_true = {
        "completed": is_completed and makespan == len(replay.steps),
        "step limit": over == LIMIT_REACHED and len(replay.steps) == scenario.step_limit,
        "infeasible": not is_completed and bool(blocked),
        "interrupted": not over,
    }
    if not is_true[end.status]:
        notes.note(f"the record ends as '{end.status}', which is not so")
    if end.blocked_tasks != (blocked if end.status == "infeasible" else ()):
        notes.note(
            f"the record says that {_names(end.blocked_tasks)} are blocked; {_names(blocked)} are"
        )
    if replay.lower_bound is not None and makespan is not None and replay.lower_bound > makespan:
        notes.note(f"the lower bound {replay.lower_bound} is above the makespan {makespan}")
    if end.illegal_decisions < 0:
        notes.note(f"the record says illegal_decisions {end.illegal_decisions}")


def blocked_tasks(fleet: Fleet, tasks: Tasks, steps_made: int) -> list[str]:
    """Name the undone tasks that the robots left and due back around them can never cover.

    A task that is to be called off is none of them.
    """
    scenario = fleet.scenario
    left = [robot for team in fleet.teams.values() for robot in team.robots]
    left += [robot for robot in fleet.lost if scenario.robots[robot].is_due(steps_made)]
    robots = [scenario.robots[robot] for robot in left]
    return [
        task.name
        for number, task in enumerate(scenario.tasks)
        if number not in tasks.done
        and task.cancelled is None
        and not covers(
            total(r.can for r in robots if gets_there(scenario.world, r, task.at)), task.needs
        )
    ]


def why_over(fleet: Fleet, tasks: Tasks, steps_made: int, has_lost: bool) -> str:
    """Say why no more step can be made; empty if one can."""
    if tasks.are_over:
        return "everything was done before"
    if has_lost and blocked_tasks(fleet, tasks, steps_made):
        return "some tasks could never be done since a robot was lost"
    return LIMIT_REACHED if steps_made >= fleet.scenario.step_limit else ""


def _names(names: tuple[str, ...]) -> str:
    return ", ".join(names) or "none"
