"""Charging in a graph of arcs: where robots charge on their ways, and what they have left then.

Each seat holds what its robot has left when it leaves. A way has its detour in it: by the same rule
by which robots charge. Whoever comes to a charger finds room: queues are left to who judges plans.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import may_have_extras
from teamformer.planning.graph.pauses import walked_by
from teamformer.planning.problem.constants import NEVER
from teamformer.world.rules.constants import NOBODY

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph

RESCUE = 4 * 10**9
"""What it takes an empty robot to go on, in ticks: so plans in which robots run dry compare."""


@kernel
def is_charged(problem: ArcProblem) -> bool:
    """Say whether anybody has a battery."""
    return may_have_extras(problem) and len(problem.batteries.lasts) > 0


@kernel
def go_charged(
    problem: ArcProblem, graph: Graph, kind: int, tail: int, goal: int, way: int, wanted: int
) -> tuple[int, int, int]:
    """Return when a robot that leaves a seat is at a goal so far away, and what it has left.

    Last is by how much it goes round. It charges first if it does not have what is wanted there, be
    it at several chargers.
    """
    batteries, place, left = problem.batteries, graph.seats[tail].node, graph.left[tail]
    free, pace = graph.nodes[place].end, problem.kinds[kind].pace
    if left - way >= wanted:
        return walked_by(problem, kind, free, way), left - way, 0
    lasts, fills = batteries.lasts[kind], batteries.fills[kind]
    at, least = NOBODY, NEVER
    for other in range(len(batteries.room)):
        to, onward = batteries.to[pace, place, other], batteries.onward[kind, other, goal]
        if to <= left and onward < NEVER and to + onward < least:
            at, least = other, to + onward
    if at == NOBODY:
        return free + way + RESCUE, lasts - way, 0
    walked = to = batteries.to[pace, place, at]
    comes = walked_by(problem, kind, free, to) + in_ticks(fills * (lasts - left + to))
    for _ in range(len(batteries.room)):
        if lasts - batteries.fro[kind, at, goal] >= wanted:
            break
        following, least = at, NEVER
        for other in range(len(batteries.room)):
            hop, onward = batteries.between[pace, at, other], batteries.onward[kind, other, goal]
            if other != at and hop <= lasts and onward < NEVER and hop + onward < least:
                following, least = other, hop + onward
        hop = batteries.between[pace, at, following]
        comes = walked_by(problem, kind, comes, hop) + in_ticks(fills * hop)
        walked += hop
        at = following
    last = batteries.fro[kind, at, goal]
    return walked_by(problem, kind, comes, last), lasts - last, walked + last - way


@kernel
def in_ticks(value: float) -> int:
    """Return a time in whole ticks."""
    return int(value + 0.5)
