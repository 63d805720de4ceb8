"""Charging in a graph of arcs: when robots are where they go, and what they have left then.

Each seat holds what its robot has left when it leaves. A way has its detour in it: by the same rule
by which robots charge. Whoever comes to a charger finds room: queues are left to who judges plans.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import may_have_extras
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
def reach(problem: ArcProblem, graph: Graph, kind: int, tail: int, task: int) -> tuple[int, int]:
    """Return when a robot of a kind that leaves a seat is at a task, and what it has left then."""
    pace = problem.kinds[kind].pace
    way = problem.ways_to[pace, task, graph.seats[tail].node]
    wanted = problem.batteries.spends[kind, task] + problem.batteries.nearest[pace, task]
    return _reach_goal(problem, graph, kind, tail, task, way, wanted)


@kernel
def charged_home(problem: ArcProblem, graph: Graph, robot: int) -> int:
    """Return when a robot is home, if it charges before where it has to."""
    home = len(graph.seats) - len(graph.back) + robot
    tail, kind = graph.seats[home].prev, graph.seats[home].kind
    way, goal = problem.home[kind, graph.seats[tail].node], len(problem.near)
    return _reach_goal(problem, graph, kind, tail, goal, way, 0)[0]


@kernel
def _reach_goal(
    problem: ArcProblem, graph: Graph, kind: int, tail: int, goal: int, way: int, wanted: int
) -> tuple[int, int]:
    """Return when a robot that leaves a seat is at a goal so far away, and what it has left.

    It charges first if it does not have what is wanted there, be it at several chargers.
    """
    batteries, place, left = problem.batteries, graph.seats[tail].node, graph.left[tail]
    free, pace = graph.nodes[place].end, problem.kinds[kind].pace
    if left - way >= wanted:
        return free + way, left - way
    lasts, fills = batteries.lasts[kind], batteries.fills[kind]
    at, least = NOBODY, NEVER
    for other in range(len(batteries.room)):
        to, onward = batteries.to[pace, place, other], batteries.onward[kind, other, goal]
        if to <= left and onward < NEVER and to + onward < least:
            at, least = other, to + onward
    if at == NOBODY:
        return free + way + RESCUE, lasts - way
    to = batteries.to[pace, place, at]
    comes = free + to + in_ticks(fills * (lasts - left + to))
    for _ in range(len(batteries.room)):
        if lasts - batteries.fro[kind, at, goal] >= wanted:
            break
        following, least = at, NEVER
        for other in range(len(batteries.room)):
            hop, onward = batteries.between[pace, at, other], batteries.onward[kind, other, goal]
            if other != at and hop <= lasts and onward < NEVER and hop + onward < least:
                following, least = other, hop + onward
        hop = batteries.between[pace, at, following]
        comes += hop + in_ticks(fills * hop)
        at = following
    way = batteries.fro[kind, at, goal]
    return comes + way, lasts - way


@kernel
def in_ticks(value: float) -> int:
    """Return a time in whole ticks."""
    return int(value + 0.5)


@kernel
def there_charged(problem: ArcProblem, graph: Graph, first_seat: int, taken: int) -> int:
    """Return when the last of those is there who come to some seats of a task."""
    there, task = 0, graph.seats[first_seat].node
    for seat in range(first_seat, first_seat + taken):
        kind, tail = graph.seats[seat].kind, graph.seats[seat].prev
        there = max(there, reach(problem, graph, kind, tail, task)[0])
    return there


@kernel
def comes_to(problem: ArcProblem, graph: Graph, kind: int, tail: int, task: int) -> int:
    """Return when a robot of a kind that leaves a seat is at a task, in continuous time."""
    if is_charged(problem):
        return reach(problem, graph, kind, tail, task)[0]
    place = graph.seats[tail].node
    return graph.nodes[place].end + problem.ways_to[problem.kinds[kind].pace, task, place]


@kernel
def left_after(problem: ArcProblem, graph: Graph, seat: int, start: int) -> int:
    """Return what who takes a seat of a task has left when it ends; less than 0 if too little."""
    kind, task = graph.seats[seat].kind, graph.seats[seat].node
    comes, left = reach(problem, graph, kind, graph.seats[seat].prev, task)
    waiting = in_ticks(problem.batteries.waiting[kind] * (start - comes))
    return left - waiting - problem.batteries.spends[kind, task]
