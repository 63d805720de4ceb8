"""Splits, joins and losses: who may form with whom, and who must leave."""

from __future__ import annotations

from teamformer.referee.fleet import Fleet, Team
from teamformer.referee.verdict import Notes
from teamformer.sim.replay import Step


def split_teams(fleet: Fleet, step: Step, notes: Notes) -> None:
    """Part each team that the step says has split."""
    for stay, leave in step.splits:
        slot = fleet.find({*stay, *leave})
        if slot is None or not stay or not leave or len({*stay, *leave}) != len(stay) + len(leave):
            notes.note(f"a split into {_list(fleet, stay)} and {_list(fleet, leave)} parts no team")
            continue
        team = fleet.teams[slot]
        if team.services:
            notes.note(f"{fleet.name(team)} splits while it serves a task")
        if team.has_formed:
            notes.note(f"{fleet.name(team)} forms twice in one step")
        del fleet.teams[slot]
        for robots in (stay, leave):
            fleet.put(Team(set(robots), team.at, has_formed=True))


def join_teams(fleet: Fleet, joins: tuple[tuple[int, int], ...], notes: Notes) -> None:
    """Make one team of each pair that the step says has joined."""
    for joiner, partner in joins:
        if joiner == partner or joiner not in fleet.teams or partner not in fleet.teams:
            names = [fleet.scenario.robots[slot].name for slot in (joiner, partner)]
            notes.note(f"a join of {names[0]} with {names[1]} is not one of two teams")
            continue
        one, other = fleet.teams.pop(joiner), fleet.teams.pop(partner)
        for team in (one, other):
            if team.services:
                notes.note(f"{fleet.name(team)} joins while it serves a task")
            if team.has_formed:
                notes.note(f"{fleet.name(team)} forms twice in one step")
        if one.at != other.at:
            notes.note(
                f"{fleet.name(one)} at {list(one.at)} joins {fleet.name(other)} at "
                f"{list(other.at)}; they are not in the same place"
            )
        fleet.put(Team(one.robots | other.robots, other.at, has_formed=True))


def lose_robots(fleet: Fleet, step: Step, number: int, notes: Notes) -> None:
    """Take out the robots that are lost in this step, and say where the record differs."""
    due = {r for r, robot in enumerate(fleet.scenario.robots) if robot.lost == number}
    for robot in sorted(due ^ set(step.lost)):
        name, when = fleet.scenario.robots[robot].name, fleet.scenario.robots[robot].lost
        if robot in due:
            notes.note(f"robot {name} is lost in this step and the record keeps it")
        else:
            notes.note(f"the record loses robot {name} here, the scenario {when or 'never'}")
    for slot, team in list(fleet.teams.items()):
        if team.robots & (due | set(step.lost)):
            del fleet.teams[slot]
            team.robots -= due | set(step.lost)
            if team.robots:
                fleet.put(team)


def _list(fleet: Fleet, robots: tuple[int, ...]) -> str:
    return f"[{', '.join(fleet.scenario.robots[robot].name for robot in robots)}]"
