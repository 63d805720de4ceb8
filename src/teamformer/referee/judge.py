"""Judging a record, step by step, by the rules of docs/environment.md.

After something illegal the referee goes on from what the record says, so that one fault is told
once.
"""

from __future__ import annotations

from teamformer.referee.doing import Tasks
from teamformer.referee.ending import judge_ending, judge_orders, start_fleet
from teamformer.referee.fleet import Fleet
from teamformer.referee.forming import join_teams, lose_robots, split_teams
from teamformer.referee.moving import move_team
from teamformer.referee.verdict import Notes, Verdict
from teamformer.sim.replay import Replay, Step


def judge(replay: Replay) -> Verdict:
    """Return everything in a record that breaks the rules."""
    notes = Notes()
    fleet, tasks = start_fleet(replay, notes), Tasks(replay.scenario)
    for number, step in enumerate(replay.steps, start=1):
        notes.step = number
        if len(tasks.done) == len(replay.scenario.tasks):
            notes.note("everything was done before, and the record goes on")
            break
        _judge_step(fleet, tasks, step, number, notes)
    notes.step = 0
    judge_orders(replay, tasks.done, notes)
    judge_ending(replay, fleet, tasks, notes)
    findings = tuple(sorted(notes.findings, key=lambda finding: finding.step))
    return Verdict(findings, len(replay.steps), len(tasks.done))


def _judge_step(fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> None:
    for team in fleet.teams.values():
        team.has_formed = False
    split_teams(fleet, step, notes)
    met = [pair for pair in step.joins if _are_together(fleet, pair)]
    walked = tuple(pair for pair in step.joins if pair not in met)
    join_teams(fleet, tuple(met), notes)
    if fleet.scenario.forming_steps > 0:
        join_teams(fleet, walked, notes)
        walked = ()
    _move(fleet, step, walked, notes)
    lose_robots(fleet, step, number, notes)
    recorded: dict[int, int] = {}
    for task, slot in step.done:
        if task in recorded:
            notes.note(f"task {fleet.scenario.tasks[task].name} is done twice")
        recorded[task] = slot
    tasks.complete(fleet, recorded, number, notes)
    _assign(fleet, tasks, step, number, notes)


def _are_together(fleet: Fleet, pair: tuple[int, int]) -> bool:
    one, other = (fleet.teams.get(slot) for slot in pair)
    return one is not None and other is not None and one.at == other.at


def _move(fleet: Fleet, step: Step, walked: tuple[tuple[int, int], ...], notes: Notes) -> None:
    """Move all teams to where the record has them; those that meet on the way join then."""
    places = {entry.slot: (entry.x, entry.y) for entry in step.teams}
    walking = [pair for pair in walked if set(pair) <= fleet.teams.keys()]
    apart = fleet.teams.keys() - {slot for pair in walking for slot in pair}
    for slot in sorted(apart):
        team = fleet.teams[slot]
        move_team(fleet, team, places.get(_slot_after(team.robots, step), team.at), notes)
    for pair in walking:
        teams = [fleet.teams[slot] for slot in pair]
        slot = _slot_after(teams[0].robots | teams[1].robots, step)
        place = places.get(slot, fleet.teams[min(pair)].at)
        for team in teams:
            move_team(fleet, team, place, notes)
    join_teams(fleet, walked, notes)


def _slot_after(robots: set[int], step: Step) -> int:
    """Return the slot of a team of these robots after the step's losses; -1 if none is left."""
    return min(robots - set(step.lost), default=-1)


def _assign(fleet: Fleet, tasks: Tasks, step: Step, number: int, notes: Notes) -> None:
    """Take over the assignments that the record gives, and check them."""
    for entry in step.teams:
        if entry.slot not in fleet.teams:
            name = fleet.scenario.robots[entry.slot].name
            notes.note(f"the record moves a team of robot {name} as its lowest; there is none")
        else:
            fleet.teams[entry.slot].task = entry.task
    for team in fleet.teams.values():
        if team.task is not None and not tasks.is_open(team.task, number):
            task = fleet.scenario.tasks[team.task].name
            notes.note(f"{fleet.name(team)} heads for task {task}, which is not open")
            team.task = None
