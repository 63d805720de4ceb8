"""Motion: nobody walks farther than its speed allows, or through a wall."""

from __future__ import annotations

from teamformer.model import Grid, Place
from teamformer.referee.fleet import Fleet, Team
from teamformer.referee.verdict import Notes

ROUNDING = 1e-9


def move_team(fleet: Fleet, team: Team, to: Place, notes: Notes) -> None:
    """Judge where the record has a team after its motion, and put it there."""
    waits = bool(team.services) or (team.has_formed and fleet.scenario.forming_steps > 0)
    speed = fleet.speed(team)
    team.credit = 0.0 if waits else min(team.credit + speed, speed + 1)
    if to == team.at:
        return
    name, way = fleet.name(team), f"from {list(team.at)} to {list(to)}"
    allowed = int(team.credit + ROUNDING)
    cells = _cells_between(fleet.scenario.world, team.at, to, allowed)
    if not fleet.scenario.world.is_free(to):
        notes.note(f"{name} is at {list(to)}, where no robot can be")
    elif team.services:
        notes.note(f"{name} moves {way} while it serves a task")
    elif waits:
        notes.note(f"{name} moves {way} in the step in which it formed")
    elif cells is None:
        notes.note(f"{name} jumped {way}; it can cross {allowed} cells now")
    else:
        team.credit -= cells
    team.at = to


def _cells_between(world: Grid, start: Place, goal: Place, most: int) -> int | None:
    """Return how many cells a walk crosses, None if it crosses more than allowed."""
    if abs(start[0] - goal[0]) + abs(start[1] - goal[1]) > most:
        return None
    reached = {start}
    for cells in range(1, most + 1):
        reached |= {beside for place in reached for beside in world.neighbours(place)}
        if goal in reached:
            return cells
    return None
