"""Motion: nobody walks farther than its speed allows, or through a wall."""

from __future__ import annotations

from teamformer.model import Grid, Place
from teamformer.referee.fleet import Fleet, Team
from teamformer.referee.verdict import Notes

ROUNDING = 1e-9

MOST_SAVED = 1 - 2 * ROUNDING
"""Whoever has credit for a whole cell crosses it, or has nowhere to go and loses the credit."""


def move_team(fleet: Fleet, team: Team, to: Place, notes: Notes) -> None:
    """Judge where the record has a team after its motion, and put it there."""
    waits = bool(team.services) or (team.has_formed and fleet.scenario.forming_steps > 0)
    team.credit = 0.0 if waits else min(team.credit, MOST_SAVED) + team.speed
    if to == team.at:
        return
    world, allowed = fleet.scenario.world, int(team.credit + ROUNDING)
    name, way = fleet.name(team), f"from {list(team.at)} to {list(to)}"
    cells = _cells_between(world, team.at, to, allowed)
    if not world.is_free(to):
        notes.note(f"{name} is at {list(to)}, where no robot can be")
    elif team.services:
        notes.note(f"{name} moves {way} while it serves a task")
    elif waits:
        notes.note(f"{name} moves {way} in the step in which it formed")
    elif cells is None:
        how = "jumped" if _apart(team.at, to) > allowed else "went through a wall"
        can = f"it can cross {allowed} {'cell' if allowed == 1 else 'cells'} now"
        notes.note(f"{name} {how} {way}; {can}")
    else:
        team.credit -= cells
    team.at = to


def _cells_between(world: Grid, start: Place, goal: Place, most: int) -> int | None:
    """Return how many cells a walk crosses, None if it crosses more than allowed."""
    if _apart(start, goal) > most:
        return None
    if not world.rows or _apart(start, goal) == 1:
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
    return abs(one[0] - other[0]) + abs(one[1] - other[1])
