"""Headway: who has somewhere to go goes there, by the one way of the rules, and nobody else walks.

Where teams may walk to partners, which a record does not say unless they go by plans, they may go
to any team within the join radius instead. Of unions made on the way only how far the two walked
is judged.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from teamformer.mission.model import Mission
from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import DECIMALS, Plane
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam
from teamformer.record.referee.rules.verdict import Notes
from teamformer.record.referee.rules.walking import ROUNDING

ROUNDED = 1.5e-6  # metres
"""Places on a plane are whole micrometres; which one may hang on how a computer rounds."""


class Move(NamedTuple):
    """Where the team of a robot was when teams decided, before it walked, and after."""

    robot: int
    decided_at: Place
    starts: tuple[Place, ...]  # one of two, of a union
    end: Place | None  # None where the record does not tell
    has_joined: bool  # so that it may have stood elsewhere within the arrival radius meanwhile


class ShortestWays:
    """The shortest ways to places, worked out only as far as teams are away.

    `goals` says where tasks are that teams walk to, as they believe.
    """

    def __init__(self, mission: Mission) -> None:
        self._world = mission.world
        self._floods: dict[Place, _Flood] = {}
        self.goals = {number: task.at for number, task in enumerate(mission.tasks)}

    def between(self, place: Place, goal: Place, flies: bool = False) -> float:
        """Return cells, or metres on a plane; infinity where no way is."""
        if isinstance(self._world, Plane):
            return math.dist(place, goal)
        assert isinstance(self._world, Grid)
        if flies or not self._world.rows:
            return abs(place[0] - goal[0]) + abs(place[1] - goal[1])
        if not self._world.is_free(goal):  # over an obstacle, where a team flies
            return math.inf
        if goal not in self._floods:
            self._floods[goal] = _Flood(self._world, goal)
        return self._floods[goal].length_to(place)

    def along(self, place: Place, goal: Place, length: float, flies: bool = False) -> Place:
        """Return where one is after so much of the way to a goal: cells, or metres on a plane."""
        if isinstance(self._world, Plane):
            return _straight_on(place, goal, length)
        for _ in range(int(length)):
            place = self._next_cell(place, goal, flies)
        return place

    def _next_cell(self, place: Place, goal: Place, flies: bool) -> Place:
        """Return the next cell: first along the axis with more left to go, then the larger one."""
        assert isinstance(self._world, Grid)
        (x, y), to_go = place, self.between(place, goal, flies)
        is_along_x = abs(goal[0] - x) >= abs(goal[1] - y)
        around = [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]
        beside = around if flies else self._world.neighbours(place)
        nearer = (c for c in beside if self.between(c, goal, flies) < to_go)
        return max(nearer, default=place, key=lambda cell: ((cell[1] == y) == is_along_x, cell))


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


def _straight_on(place: Place, goal: Place, length: float) -> Place:
    to_go = math.dist(place, goal)
    if to_go <= length + ROUNDING:
        return goal
    (x, y), (goal_x, goal_y) = place, goal
    part = length / to_go
    return round(x + (goal_x - x) * part, DECIMALS), round(y + (goal_y - y) * part, DECIMALS)


def check_headway(
    fleet: Fleet,
    ways: ShortestWays,
    goals: Mapping[int, Place],
    pursuits: Mapping[int, Sequence[int | None]],
    moves: Sequence[Move],
    notes: Notes,
) -> None:
    """Check that teams have walked to what they pursued as far as they can, or stayed.

    `goals` says where the tasks were believed to be while they walked, `pursuits` what the team of
    each slot can have pursued, and `moves` how all teams went.
    """
    for slot, team in sorted(fleet.teams.items()):
        if team.walked_from is None:
            team.least_credit = min(team.least_credit, team.credit) if team.is_delayed else 0.0
            continue
        walk = _Walk(fleet, ways, team)
        fits = [task for task in pursuits[slot] if walk.leads_to(_goal(goals, task))]
        partners = list(_partners_in_reach(fleet, team, moves)) if team.may_seek else []
        if not fits and not any(walk.leads_to(place, slack) for place, slack in partners):
            notes.note(walk.what_is_wrong(pursuits[slot], goals))
            team.least_credit = 0.0
            continue
        if partners:
            team.least_credit = 0.0
        elif fits == [None]:
            team.credit = team.least_credit = 0.0
        else:
            team.least_credit = min(walk.saved_towards(_goal(goals, task)) for task in fits)


def _goal(goals: Mapping[int, Place], task: int | None) -> Place | None:
    return None if task is None else goals[task]


class _Walk:
    """How a team has walked in a step."""

    def __init__(self, fleet: Fleet, ways: ShortestWays, team: RecordedTeam) -> None:
        assert team.walked_from is not None
        self._fleet, self._ways, self._team = fleet, ways, team
        self._starts = {team.walked_from, team.walked_from if team.met_at is None else team.met_at}
        self._is_plane = isinstance(fleet.mission.world, Plane)

    def leads_to(self, goal: Place | None, slack: float = 0.0) -> bool:
        """Say whether it is the walk of one who goes to a place, or stays if there is none.

        With `slack` the place is known only to so many metres.
        """
        return any(self._is_walk(start, self._team.at, goal, slack) for start in self._starts)

    def _is_walk(self, start: Place, to: Place, goal: Place | None, slack: float) -> bool:
        flies = self._team.flew
        to_go = math.inf if goal is None else self._ways.between(start, goal, flies)
        if goal is None or to_go == math.inf:
            return to == start
        if self._is_plane:
            return (
                math.dist(self._ways.along(start, goal, self._team.walked_at), to)
                <= ROUNDED + slack
            )
        walked = to_go - self._ways.between(to, goal, flies)
        is_far_enough = walked >= min(self._least_cells(), to_go)
        return is_far_enough and self._ways.along(start, goal, walked, flies) == to

    def _least_cells(self) -> int:
        return int(self._team.least_credit + self._team.walked_at + ROUNDING)

    def saved_towards(self, goal: Place | None) -> float:
        """Return what the team has surely saved of its speed, if it goes to a place."""
        assert self._team.walked_from is not None
        if goal is None or self._is_plane:
            return 0.0
        before, after = (
            self._ways.between(at, goal, self._team.flew)
            for at in (self._team.walked_from, self._team.at)
        )
        if not 0 < after < math.inf:
            return 0.0
        spent = max(self._least_cells(), before - after)
        return max(0.0, self._team.least_credit + self._team.walked_at - spent)

    def what_is_wrong(self, pursued: Sequence[int | None], goals: Mapping[int, Place]) -> str:
        """Say how the team went, and what it had to do instead."""
        team, start, to = self._team, self._team.walked_from, self._team.at
        assert start is not None
        name, went = self._fleet.name(team), f"goes from {list(start)} to {list(to)}"
        did = f"waits at {list(to)}" if start == to else went
        task = next((task for task in pursued if task is not None), None)
        if task is None:
            return f"{name} {did}; it pursues no task, so that it must stay"
        wanted, to_go = (
            self._fleet.mission.tasks[task].name,
            self._ways.between(start, goals[task], team.flew),
        )
        due = min(team.walked_at if self._is_plane else self._least_cells(), to_go)
        if to_go - self._ways.between(to, goals[task], team.flew) < due - ROUNDED:
            unit = "m" if self._is_plane else "cell" if due == 1 else "cells"
            return f"{name} {did}; it must get {due:g} {unit} nearer to task {wanted}"
        return f"{name} {did}; that is not on its way to task {wanted}"


def _partners_in_reach(
    fleet: Fleet, team: RecordedTeam, moves: Sequence[Move]
) -> Iterator[tuple[Place, float]]:
    """Return where teams are and were that a team may have walked to, and how surely, in metres."""
    world = fleet.mission.world
    here = world.arrival_radius if isinstance(world, Plane) else 0.0
    if fleet.mission.join_radius <= here:
        return
    assert team.walked_from is not None
    for other in moves:
        away = math.dist(team.walked_from, other.decided_at)
        if other.robot not in team.robots and away <= fleet.mission.join_radius + ROUNDING:
            slack = here if other.has_joined else 0.0
            for place in (*other.starts, team.at if other.end is None else other.end):
                yield place, slack
