"""Where teams of real robots count as being, so that the environment's rules can be applied.

The environment knows one place for each team, and asks whether two are the same. A team counts as
at its task when all of its robots that the task needs are in their slots around it; teams of which
two robots are within contact count as in the same place; all others are where their robots with
slots are on average.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from teamformer.base.array_types import Array
from teamformer.robotarium.control.goals import Goals
from teamformer.robotarium.control.teams import RobotTeam, distance
from teamformer.robotarium.robots.arena import MIDDLE

IN_SLOT = 0.05  # metres: so near to its slot a robot is in it
CONTACT = 0.40  # metres between the nearest robots of two teams that can join

AT_TASK, BESIDE_TASK = 0.6, 1.1
"""How far from a task teams count as being, in arrival radii, if they are at it or only with a
team that is: both are in the same place then, and only one is at the task."""


def team_places(
    teams: Sequence[RobotTeam], robots: Array, goals: Goals, tasks: Array, radius: float
) -> Array:
    """Return where each team counts as being, as (robots, 2) by slot, in a mission's coordinates.

    `robots` (robots, 2) are in the arena's coordinates; `tasks` (tasks, 2) are in the mission's,
    and `radius` is its arrival radius in metres.
    """
    is_there = {team.slot: is_at_task(team, robots, goals) for team in teams}
    places = np.zeros_like(robots)
    for leader, followers in _gather(teams, robots, is_there):
        if not is_there[leader.slot]:
            place = _centre(leader, robots, goals) + MIDDLE
            place = _clear_of(tasks, place, BESIDE_TASK * radius)
            for team in (leader, *followers):
                places[team.slot] = place
            continue
        for team in (leader, *followers):
            share = AT_TASK if is_there[team.slot] else BESIDE_TASK
            places[team.slot] = tasks[leader.task] + (share * radius, 0.0)
    return places


def is_at_task(team: RobotTeam, robots: Array, goals: Goals) -> bool:
    """Say whether all robots of a team that have slots are in them, and there are any."""
    members = [robot for robot in team.robots if goals.has_slot[robot]]
    away = np.linalg.norm(robots[members] - goals.places[members], axis=1)
    return bool(members) and bool((away <= IN_SLOT).all())


def _centre(team: RobotTeam, robots: Array, goals: Goals) -> Array:
    """Return the middle of a team's robots with slots, or of all if none has one."""
    members = [robot for robot in team.robots if goals.has_slot[robot]] or list(team.robots)
    middle: Array = robots[members].mean(axis=0)
    return middle


def _gather(
    teams: Sequence[RobotTeam], robots: Array, is_there: dict[int, bool]
) -> list[tuple[RobotTeam, list[RobotTeam]]]:
    """Put teams with one that they are in contact with: those at tasks lead, then by slot."""
    gathered: list[tuple[RobotTeam, list[RobotTeam]]] = []
    waiting = sorted(teams, key=lambda team: (not is_there[team.slot], team.slot))
    while waiting:
        leader, *others = waiting
        followers = [
            team
            for team in others
            if team.task == leader.task and distance(leader, team, robots) <= CONTACT
        ]
        gathered.append((leader, followers))
        waiting = [team for team in others if team not in followers]
    return gathered


def _clear_of(tasks: Array, place: Array, radius: float) -> Array:
    """Return a place, moved out of the radius of a task (tasks, 2) that it lies in."""
    away = place - tasks  # (tasks, 2)
    distances = np.linalg.norm(away, axis=1)
    nearest = int(distances.argmin())
    if distances[nearest] >= radius:
        return place
    towards = away[nearest] / distances[nearest] if distances[nearest] > 1e-6 else np.array([1, 0])
    moved: Array = tasks[nearest] + radius * towards
    return moved
