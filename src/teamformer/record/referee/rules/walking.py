"""Motion: nobody gets farther than its speed allows, or walks through a wall; some fly."""

from __future__ import annotations

import math

from teamformer.mission.parts.grid import Grid, Place
from teamformer.mission.parts.plane import Plane
from teamformer.record.referee.rules.teams import Fleet, RecordedTeam
from teamformer.record.referee.rules.verdict import Notes

Fault = tuple[str, str] | None
"""How a team moved that must not, and what it can do."""

ROUNDING = 1e-9
MICROMETRES = 2e-6  # metres; places on a plane are rounded to one of them

MOST_SAVED = 1 - 2 * ROUNDING
"""Whoever has credit for a whole cell crosses it, or has nowhere to go and loses the credit."""


def move_team(
    fleet: Fleet, team: RecordedTeam, to: Place, notes: Notes, meets: bool = False
) -> None:
    """Judge where the record has a team after its motion, and put it there.

    `meets` says whether it has joined another at the end of its way.
    """
    is_busy = bool(team.services) and team.carries is None
    waits = is_busy or (team.has_formed and fleet.mission.forming_steps > 0)
    world = fleet.mission.world
    if isinstance(world, Grid):
        fault = _walk_cells(world, team, to, waits)
    else:
        assert isinstance(world, Plane)
        fault = _walk_metres(world, team, to, waits or team.is_delayed, meets)
    team.walked_from = None if waits or fault or team.is_delayed else team.at
    team.walked_at, team.flew = team.speed, team.flies
    if to == team.at:
        return
    name, way = fleet.name(team), f"from {list(team.at)} to {list(to)}"
    if not world.is_free(to) and not (team.flies and world.is_inside(to)):
        notes.note(f"{name} is at {list(to)}, where no robot can be")
    elif fault and is_busy:
        notes.note(f"{name} moves {way} while it serves a task")
    elif fault and waits:
        notes.note(f"{name} moves {way} in the step in which it formed")
    elif fault and team.is_delayed:
        notes.note(f"{name} moves {way} in a step in which one of its robots stands still")
    elif fault:
        how, can = fault
        notes.note(f"{name} {how} {way}; it can {can} now")
    team.at = to


def _walk_cells(grid: Grid, team: RecordedTeam, to: Place, waits: bool) -> Fault:
    """Let a team spend its speed on a way through cells; say what is wrong with it."""
    if waits:
        team.credit = 0.0
    elif not team.is_delayed:
        team.credit = min(team.credit, MOST_SAVED) + team.speed
    allowed = 0 if team.is_delayed else int(team.credit + ROUNDING)
    if team.flies:
        cells = _apart(team.at, to) if _apart(team.at, to) <= allowed else None
    else:
        cells = _cells_between(grid, team.at, to, allowed)
    if cells is None:
        how = "jumped" if _apart(team.at, to) > allowed else "went through a wall"
        return how, f"cross {allowed} {'cell' if allowed == 1 else 'cells'}"
    team.credit -= cells
    return None


def _walk_metres(plane: Plane, team: RecordedTeam, to: Place, waits: bool, meets: bool) -> Fault:
    """Say what is wrong with a straight way; a union walks from where either of the two stood."""
    allowed = 0.0 if waits else team.speed
    starts = [team.at] if team.met_at is None else [team.at, team.met_at]
    if waits and not meets:
        return None if to in starts else ("moved", "stay")
    gathering = plane.arrival_radius if meets else 0.0
    if min(math.dist(start, to) for start in starts) <= allowed + gathering + MICROMETRES:
        return None
    return "jumped", f"walk {allowed:g} m"


def _cells_between(world: Grid, start: Place, goal: Place, most: int) -> int | None:
    """Return how many cells a walk crosses, None if it crosses more than allowed."""
    if _apart(start, goal) > most:
        return None
    if not world.rows or _apart(start, goal) <= 1:
        return _apart(start, goal)
    reached, frontier = {start}, {start}
    for cells in range(1, most + 1):
        beside = {place for cell in frontier for place in world.neighbours(cell)} - reached
        frontier = {place for place in beside if cells + _apart(place, goal) <= most}
        if goal in frontier:
            return cells
        if not frontier:
            return None
        reached |= frontier
    return None


def _apart(one: Place, other: Place) -> int:
    return int(abs(one[0] - other[0]) + abs(one[1] - other[1]))
