"""Ways of robots with batteries, in ticks: they charge on them if they must, and find room there.

By the rule by which robots charge (`world/rules/charging/stops.py`). Queues are left to who judges
plans.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.problem.constants import NEVER
from teamformer.planning.problem.rotas import walked
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.planning.problem.batteries import Batteries
    from teamformer.planning.problem.rotas import Rotas

RESCUE = 4 * 10**9
"""What it takes an empty robot to go on, in ticks: so plans in which robots run dry compare."""


@kernel
def go_charged(
    batteries: Batteries,
    rotas: Rotas,
    kind: int,
    pace: int,
    place: int,
    free: int,
    left: int,
    goal: int,
    way: int,
    wanted: int,
) -> tuple[int, int, int]:
    """Return when a robot that leaves a place is at a goal so far away, and what it has left.

    Last is by how much it goes round. It charges first if it does not have what is wanted there, be
    it at several chargers. The goal behind all tasks is its home.
    """
    if left - way >= wanted:
        return walked(rotas, kind, free, way), left - way, 0
    lasts, fills = batteries.lasts[kind], batteries.fills[kind]
    at, least = NOBODY, NEVER
    for other in range(len(batteries.room)):
        to, onward = batteries.to[pace, place, other], batteries.onward[kind, other, goal]
        if to <= left and onward < NEVER and to + onward < least:
            at, least = other, to + onward
    if at == NOBODY:
        return free + way + RESCUE, lasts - way, 0
    gone = to = batteries.to[pace, place, at]
    comes = walked(rotas, kind, free, to) + in_ticks(fills * (lasts - left + to))
    for _ in range(len(batteries.room)):
        if lasts - batteries.fro[kind, at, goal] >= wanted:
            break
        following, least = at, NEVER
        for other in range(len(batteries.room)):
            hop, onward = batteries.between[pace, at, other], batteries.onward[kind, other, goal]
            if other != at and hop <= lasts and onward < NEVER and hop + onward < least:
                following, least = other, hop + onward
        hop = batteries.between[pace, at, following]
        comes = walked(rotas, kind, comes, hop) + in_ticks(fills * hop)
        gone += hop
        at = following
    last = batteries.fro[kind, at, goal]
    return walked(rotas, kind, comes, last), lasts - last, gone + last - way


@kernel
def in_ticks(value: float) -> int:
    """Return a time in whole ticks."""
    return int(value + 0.5)
