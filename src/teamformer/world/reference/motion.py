"""Phase 5: teams walk towards what they head for, then joiners towards their partners."""

from __future__ import annotations

import math

from teamformer.mission.parts.grid import Place
from teamformer.mission.parts.plane import Plane
from teamformer.world.reference.charging import spend_walking
from teamformer.world.reference.formation import Joins, unite
from teamformer.world.reference.state import PlainTeam, PlainWorld
from teamformer.world.reference.ways import ROUNDING, UNREACHABLE, after_metres, apart


def move_teams(world: PlainWorld, walks: Joins) -> None:
    """Let teams walk; `walks` says who walks to whom.

    A team stands still that forms in this step, serves a task (unless it carries a load), or has a
    robot that is delayed or outside its shifts.
    """
    waits = world.mission.forming_steps > 0
    still = draw_delays(world)
    still |= {r for r, _ in enumerate(world.rotas) if not world.is_at_work([r])}
    delayed = {world.slot_of[robot] for robot in still}
    for slot, team in world.in_slot_order():
        team.has_walked = False
        is_busy = team.serving and not world.carried & team.serving.keys()
        if slot in walks or is_busy or (team.has_formed and waits) or slot in delayed:
            continue
        if team.task is None:
            team.credit = 0.0
        elif team.charger is not None:
            _walk(world, team, world.mission.chargers[team.charger].at)
        else:
            _walk(world, team, world.at[team.task])
    for slot, partner in sorted(walks.items()):
        joiner = world.teams.get(slot)
        if joiner is None or joiner.has_formed or slot in delayed:
            continue  # it was joined on the way
        now = world.slot_of[partner]
        assert now is not None
        other = world.teams[now]
        _walk(world, joiner, other.at)
        if not waits and not other.has_formed and world.is_same(joiner.at, other.at):
            unite(world, slot, now)


def _walk(world: PlainWorld, team: PlainTeam, goal: Place) -> None:
    """Let a team walk for a step, or onto its goal if that is nearer.

    On a grid it spends what it has saved on whole cells, and saves the rest, unless it arrives or
    there is no way.
    """
    if isinstance(world.world, Plane):
        before, team.at = team.at, after_metres(team.at, goal, team.pace)
        spend_walking(world, team, apart(before, team.at))
        return
    to_go = world.ways.length(team.at, goal, team.flies)
    if to_go in (0, UNREACHABLE):
        team.credit = 0.0
        return
    team.credit += team.pace
    cells = math.floor(team.credit + ROUNDING)
    team.credit = 0.0 if cells >= to_go else team.credit - cells
    team.at = world.ways.after_cells(team.at, goal, min(cells, to_go), team.flies)
    spend_walking(world, team, min(cells, to_go))


def draw_delays(world: PlainWorld) -> set[int]:
    """Return the robots that stand still in this step, by a xorshift generator of 64 bits each."""
    still = set()
    for robot, state in world.luck.items():
        state ^= state << 13 & 2**64 - 1
        state ^= state >> 7
        state ^= state << 17 & 2**64 - 1
        world.luck[robot] = state
        delays = world.truth.robots[robot].delays
        assert delays is not None
        if (state >> 11) / 2**53 < delays.chance:
            still.add(robot)
    return still
