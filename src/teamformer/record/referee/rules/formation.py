"""Splits, joins and losses: who may form with whom, and who must leave."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from teamformer.mission.parts.capabilities import covers, total
from teamformer.record.record import Step
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam
from teamformer.record.referee.rules.verdict import Notes
from teamformer.record.referee.rules.walking import move_team

ROUNDING = 1e-9


def split_teams(fleet: Fleet, step: Step, notes: Notes) -> None:
    """Part each team that the step says has split."""
    for stay, leave in step.splits:
        slot = fleet.find({*stay, *leave})
        if slot is None or not stay or not leave or len({*stay, *leave}) != len(stay) + len(leave):
            one, other = list_robots(fleet, stay), list_robots(fleet, leave)
            notes.note(f"a split into {one} and {other} parts no team")
            continue
        team = fleet.teams[slot]
        if team.services:
            notes.note(f"{fleet.name(team)} splits while it serves a task")
        if team.has_formed:
            notes.note(f"{fleet.name(team)} forms twice in one step")
        del fleet.teams[slot]
        if first_that_fit(fleet, (*stay, *leave), stay) != tuple(sorted(stay)):
            notes.note(
                f"{list_robots(fleet, stay)} are not the first of {fleet.name(team)} that fit"
            )
        for robots in (stay, leave):
            fleet.put(RecordedTeam(set(robots), team.at, team.task, has_formed=True))


def first_that_fit(fleet: Fleet, robots: Iterable[int], wanted: Iterable[int]) -> tuple[int, ...]:
    """Return the robots that, taken in order, fit into what the `wanted` ones bring together."""
    can = [robot.can for robot in fleet.mission.robots]
    room, stay = total(can[robot] for robot in wanted), list[int]()
    for robot in sorted(robots):
        if covers(room, total(can[other] for other in (*stay, robot))):
            stay.append(robot)
    return tuple(stay)


def join_teams(fleet: Fleet, joins: tuple[tuple[int, int], ...], notes: Notes) -> None:
    """Make one team of each pair that the step says has joined."""
    for joiner, partner in joins:
        if joiner == partner or joiner not in fleet.teams or partner not in fleet.teams:
            names = [fleet.mission.robots[slot].name for slot in (joiner, partner)]
            notes.note(f"a join of {names[0]} with {names[1]} is not one of two teams")
            continue
        one, other = fleet.teams.pop(joiner), fleet.teams.pop(partner)
        for team in (one, other):
            if team.services:
                notes.note(f"{fleet.name(team)} joins while it serves a task")
            if team.has_formed:
                notes.note(f"{fleet.name(team)} forms twice in one step")
        if not fleet.is_at(one, other.at):
            notes.note(
                f"{fleet.name(one)} at {list(one.at)} joins {fleet.name(other)} at "
                f"{list(other.at)}; they are not in the same place"
            )
        lower, higher = sorted((one, other), key=lambda team: min(team.robots))
        robots = one.robots | other.robots
        at, met_at = (one.at, other.at) if joiner < partner else (other.at, one.at)
        fleet.put(
            RecordedTeam(
                robots, at, lower.task, has_formed=True, met_at=met_at, met_task=higher.task,
                is_named=one.is_named or other.is_named, pursues=lower.pursues,
                is_pursuit_sure=one.is_pursuit_sure and other.is_pursuit_sure,
            )
        )  # fmt: skip


def check_reach(fleet: Fleet, pairs: tuple[tuple[int, int], ...], notes: Notes) -> None:
    """Note which teams are too far apart to want the join for which they walk."""
    for pair in pairs:
        teams = [fleet.teams[slot] for slot in pair if slot in fleet.teams]
        places = [team.at for team in teams]
        if len(teams) == 2 and math.dist(*places) > fleet.reach + ROUNDING:
            one, other = (fleet.name(team) for team in teams)
            notes.note(f"{one} joins {other} from beyond the join radius")


def due_losses(fleet: Fleet, number: int) -> set[int]:
    """Return the robots that a step loses."""
    robots = enumerate(fleet.mission.robots)
    return {r for r, robot in robots if any(away.lost == number for away in robot.absences)}


def lose_robots(fleet: Fleet, step: Step, due: set[int], notes: Notes) -> None:
    """Take out the robots that are lost in this step, and say where the record differs."""
    for robot in sorted(due ^ set(step.lost)):
        name = fleet.mission.robots[robot].name
        when = _steps(away.lost for away in fleet.mission.robots[robot].absences)
        if robot in due:
            notes.note(f"robot {name} is lost in this step and the record keeps it")
        else:
            notes.note(f"the record loses robot {name} here, the mission {when}")
    if len(set(step.lost)) < len(step.lost):
        notes.note("the record loses a robot twice")
    named = {entry.slot for entry in step.teams}
    for slot, team in list(fleet.teams.items()) if due else ():
        if team.robots & due:
            del fleet.teams[slot]
            before = replace(team, robots=set(team.robots))
            fleet.lost |= dict.fromkeys(team.robots & due, before)
            team.robots -= due
            if team.robots:
                has_met = team.met_at is not None
                if has_met and min(team.robots) not in {slot, *named}:  # no entry: as it was there
                    team.task = team.met_task
                fleet.put(team)


def return_robots(fleet: Fleet, step: Step, number: int, notes: Notes) -> bool:
    """Put in the robots that are back in this step, alone and where each was lost; say if any is.

    Says where the record differs. Where nobody of a team was left, the record did not say how it
    went on in that step, and now shows it.
    """
    robots = fleet.mission.robots
    backs = [[away.back for away in robot.absences] for robot in robots]
    due = {robot for robot in fleet.lost if number in backs[robot]}
    for robot in sorted(due ^ set(step.back)):
        name, when = robots[robot].name, _steps(backs[robot])
        if robot in due:
            notes.note(f"robot {name} is back in this step, and the record does not say so")
        else:
            notes.note(f"the record has robot {name} back here, the mission {when}")
    if len(set(step.back)) < len(step.back):
        notes.note("the record has a robot back twice")
    places = {entry.slot: (entry.x, entry.y) for entry in step.teams}
    for robot in sorted(due):
        team = fleet.lost.pop(robot)
        place = places.get(robot, team.at)
        if team.is_way_told:
            if place != team.at:
                where = list(team.at)
                notes.note(f"robot {robots[robot].name} is not back at {where}, where it was lost")
        else:
            move_team(fleet, team, place, notes)
            team.is_way_told = True  # to the others that were lost with it
        fleet.put(RecordedTeam({robot}, team.at))
    return bool(due)


def _steps(numbers: Iterable[int | None]) -> str:
    """Return the steps of a mission as words."""
    return ", ".join(str(number) for number in numbers if number is not None) or "never"


def list_robots(fleet: Fleet, robots: tuple[int, ...]) -> str:
    """Return robots by name, in brackets."""
    return f"[{', '.join(fleet.mission.robots[robot].name for robot in robots)}]"
