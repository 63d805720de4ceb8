"""Judging a record, step by step, by the rules of docs/environment.md.

After something illegal the referee goes on from what the record says, so that one fault is told
once.
"""

from __future__ import annotations

from teamformer.referee.allocation import PlannedTasks, check_assignments, judge_plans
from teamformer.referee.completion import Tasks
from teamformer.referee.delays import Delays
from teamformer.referee.finding import Search
from teamformer.referee.formation import (
    check_reach,
    due_losses,
    join_teams,
    lose_robots,
    return_robots,
    split_teams,
)
from teamformer.referee.headway import Ways, check_headway
from teamformer.referee.lifecycle import judge_ending, judge_orders, start_fleet, why_over
from teamformer.referee.motion import move_team
from teamformer.referee.teams import Fleet
from teamformer.referee.truth import Knowledge, judge_truth
from teamformer.referee.verdict import Notes, Verdict
from teamformer.sim.replay.record import Replay, Step


def judge(replay: Replay) -> Verdict:
    """Return everything in a record that breaks the rules."""
    notes = Notes()
    judge_truth(replay, notes)
    fleet, tasks = start_fleet(replay, notes), Tasks(replay.mission)
    knowledge, ways = Knowledge(replay.scenario, replay.foresight), Ways(replay.mission)
    search = Search(replay.scenario, ways, replay.foresight)
    lists = PlannedTasks(replay)
    delays, over = Delays(replay.mission), ""
    for number, step in enumerate(replay.steps, start=1):
        notes.step = number
        if over:
            notes.note(f"{over}, and the record goes on")
            break
        due = due_losses(fleet, number)
        goals, still = dict(ways.goals), delays.draw()
        _judge_step(fleet, tasks, knowledge, search, lists, step, number, due, still, notes)
        check_headway(fleet, ways, goals, notes)
        over = why_over(fleet, tasks, number, bool(due))
    notes.step = 0
    judge_orders(replay, tasks, notes)
    judge_plans(replay, tasks, knowledge, search, notes)
    judge_ending(replay, fleet, tasks, notes)
    findings = tuple(sorted(notes.findings, key=lambda finding: finding.step))
    return Verdict(findings, len(replay.steps), len(tasks.done), tasks.lateness())


def _judge_step(
    fleet: Fleet,
    tasks: Tasks,
    knowledge: Knowledge,
    search: Search,
    lists: PlannedTasks,
    step: Step,
    number: int,
    due: set[int],
    still: set[int],
    notes: Notes,
) -> None:
    slots = set(fleet.teams)
    for team in fleet.teams.values():
        team.has_formed, team.met_at, team.walked_from = False, None, None
    split_teams(fleet, step, notes)
    met = [pair for pair in step.joins if _are_together(fleet, pair)]
    walked = tuple(pair for pair in step.joins if pair not in met)
    join_teams(fleet, tuple(met), notes)
    if fleet.scenario.forming_steps > 0:
        join_teams(fleet, walked, notes)
        walked = ()
    check_reach(fleet, walked, notes)
    lists.give_tasks(fleet, tasks, number - 1)
    unions = lists.tasks_of_unions(fleet, walked)
    for team in fleet.teams.values():
        team.is_delayed = bool(team.robots & still)
    _move(fleet, step, walked, due, notes)
    lists.give_unions(fleet, unions)
    lose_robots(fleet, step, due, notes)
    any_back = return_robots(fleet, step, number, notes)
    _check_entries(fleet, step, slots, notes)
    if due or any_back:
        knowledge.expect({robot for team in fleet.teams.values() for robot in team.robots}, number)
    any_found = search.go_on(fleet, tasks, lists.looked_at(), step, number, notes)
    any_shown = knowledge.show(fleet, tasks, step, number, notes)
    _check_pursued(fleet, tasks, step, number, notes)
    recorded: dict[int, int] = {}
    for task, slot in step.done:
        if task in recorded:
            notes.note(f"task {fleet.scenario.tasks[task].name} is done twice")
        recorded[task] = slot
    tasks.complete(fleet, recorded, number, notes)
    _assign(fleet, tasks, step, number, notes)
    is_news = bool(due) or any_back or any_found or any_shown
    check_assignments(fleet, tasks, lists, step.named, number, is_news, notes)


def _are_together(fleet: Fleet, pair: tuple[int, int]) -> bool:
    one, other = (fleet.teams.get(slot) for slot in pair)
    return one is not None and other is not None and fleet.is_at(one, other.at)


def _move(
    fleet: Fleet, step: Step, walked: tuple[tuple[int, int], ...], due: set[int], notes: Notes
) -> None:
    """Move all teams to where the record has them; those that meet on the way join then."""
    places = {entry.slot: (entry.x, entry.y) for entry in step.teams}
    walking = [pair for pair in walked if set(pair) <= fleet.teams.keys()]
    apart = fleet.teams.keys() - {slot for pair in walking for slot in pair}
    for slot in sorted(apart):
        team = fleet.teams[slot]
        after = _slot_after(team.robots, due) if due else slot
        team.is_way_told = after >= 0
        if team.is_way_told:
            # no entry: all is as it was in its slot, be it that of the one that it has joined
            stays = team.at if after == slot or team.met_at is None else team.met_at
            move_team(fleet, team, places.get(after, stays), notes)
    for pair in walking:
        teams = [fleet.teams[slot] for slot in pair]
        slot = _slot_after(teams[0].robots | teams[1].robots, due)
        same = slot if slot in pair else min(pair)  # no entry: that one has not moved
        place = places.get(slot, fleet.teams[same].at)
        for team in teams:
            move_team(fleet, team, place, notes, meets=True)
    join_teams(fleet, walked, notes)


def _slot_after(robots: set[int], due: set[int]) -> int:
    """Return the slot of a team of these robots after the step's losses; -1 if none is left."""
    return min(robots - due, default=-1)


def _check_entries(fleet: Fleet, step: Step, slots: set[int], notes: Notes) -> None:
    """Check that the record names every new team, no team twice and none that is not there."""
    seen: set[int] = set()
    for entry in step.teams:
        name = fleet.scenario.robots[entry.slot].name
        if entry.slot in seen:
            notes.note(f"the record has the team of robot {name} in two places")
        seen.add(entry.slot)
        if entry.slot not in fleet.teams:
            notes.note(f"the record moves a team of robot {name} as its lowest; there is none")
            fleet.accept(entry.slot)
            if entry.slot in fleet.teams:
                fleet.teams[entry.slot].at = (entry.x, entry.y)
    for slot in sorted(fleet.teams.keys() - slots - seen):
        team = fleet.name(fleet.teams[slot])
        notes.note(f"{team} is new, and the record does not say where it is")


def _check_pursued(fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> None:
    """Check that what teams are said to have pursued was open, and each of a team that is there."""
    for slot, task in step.pursued:
        name = fleet.scenario.tasks[task].name
        if slot not in fleet.teams:
            notes.note(f"the record has a team pursue task {name} that is not there")
        elif not tasks.is_open(task, number - 1):
            notes.note(f"{fleet.name(fleet.teams[slot])} pursues task {name}, which is not open")
    if len(dict(step.pursued)) < len(step.pursued):
        notes.note("the record has a team pursue two tasks")


def _assign(fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> None:
    """Take over the assignments that the record gives, and check them."""
    for entry in step.teams:
        if entry.slot in fleet.teams:
            fleet.teams[entry.slot].task = entry.task
    for team in fleet.teams.values():
        if team.task is not None and not tasks.is_open(team.task, number - 1):
            task = fleet.scenario.tasks[team.task].name
            notes.note(f"{fleet.name(team)} heads for task {task}, which is not open")
            team.task = None
