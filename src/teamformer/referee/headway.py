"""Headway: who has somewhere to go gets on, as far as its speed takes it, and never back."""

from __future__ import annotations

import math
from collections.abc import Mapping

from teamformer.grid import Grid, Place
from teamformer.model import Scenario
from teamformer.plane import Plane
from teamformer.referee.motion import MICROMETRES, ROUNDING
from teamformer.referee.teams import Fleet, RecordedTeam
from teamformer.referee.verdict import Notes


class Ways:
    """How long the shortest ways to tasks are, worked out only as far as teams are away.

    `goals` says where tasks are that teams walk to, as they believe.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._world = scenario.world
        self._floods: dict[Place, _Flood] = {}
        self.goals = {number: task.at for number, task in enumerate(scenario.tasks)}

    def between(self, place: Place, goal: Place) -> float:
        """Return cells, or metres on a plane."""
        if isinstance(self._world, Plane):
            return math.dist(place, goal)
        if not self._world.rows:
            return abs(place[0] - goal[0]) + abs(place[1] - goal[1])
        if goal not in self._floods:
            self._floods[goal] = _Flood(self._world, goal)
        return self._floods[goal].length_to(place)


class _Flood:
    """The cells around a goal, ring by ring."""

    def __init__(self, grid: Grid, goal: Place) -> None:
        self._grid = grid
        self._lengths: dict[Place, int] = {goal: 0}
        self._ring: list[Place] = [goal]

    def length_to(self, place: Place) -> float:
        while place not in self._lengths and self._ring:
            length = self._lengths[self._ring[0]] + 1
            beside = {near for cell in self._ring for near in self._grid.neighbours(cell)}
            self._ring = [cell for cell in beside if cell not in self._lengths]
            self._lengths.update(dict.fromkeys(self._ring, length))
        return self._lengths.get(place, math.inf)


def check_headway(fleet: Fleet, ways: Ways, goals: Mapping[int, Place], notes: Notes) -> None:
    """Check, once assignments are known, that teams have walked towards them as far as they can.

    `goals` says where the tasks were believed to be while they walked.
    Left out are worlds with a join radius, where a team may walk to a partner instead, which a
    record does not say; and unions made on the way, which may have come from either of two places.
    """
    world = fleet.scenario.world
    here = world.arrival_radius if isinstance(world, Plane) else 0.0
    if fleet.scenario.join_radius > here:
        return
    for _, team in sorted(fleet.teams.items()):
        if team.task is None or team.walked_from is None or team.met_at is not None:
            team.least_credit = 0.0
            continue
        before, after = (ways.between(at, goals[team.task]) for at in (team.walked_from, team.at))
        due = _due(team, before, after, is_plane=isinstance(world, Plane))
        if before - after < due - MICROMETRES:
            name, task = fleet.name(team), fleet.scenario.tasks[team.task].name
            unit = "m" if isinstance(world, Plane) else "cell" if due == 1 else "cells"
            way = f"from {list(team.walked_from)} to {list(team.at)}"
            did = f"waits at {list(team.at)}" if team.walked_from == team.at else f"goes {way}"
            notes.note(f"{name} {did}; it must get {due:g} {unit} nearer to task {task}")


def _due(team: RecordedTeam, before: float, after: float, is_plane: bool) -> float:
    """Return how much nearer a team must get, and write down what it has surely saved then.

    `before` and `after` are how long its way was and is.
    """
    if is_plane:
        return min(team.speed, before)
    team.least_credit += team.speed
    cells = int(team.least_credit + ROUNDING)
    spent = max(cells, before - after)
    team.least_credit = max(0.0, team.least_credit - spent) if after else 0.0
    return min(cells, before)
