"""Another robot for one of a coalition, where it stands."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.judging import COMES_BY, connect
from teamformer.planning.operators.coalition_choice import gather
from teamformer.planning.operators.moved import remember
from teamformer.planning.operators.riders import covers_with
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.base.array_types import Array
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph
    from teamformer.planning.graph.judging import ArcChange
    from teamformer.planning.graph.ledger import Ledger
    from teamformer.planning.operators.room import Room


@kernel
def replace_member(
    problem: ArcProblem,
    graph: Graph,
    trial: ArcChange,
    ledger: Ledger,
    room: Room,
    random: Array,
    task: int,
    leg: int,
    limit: int,
) -> bool:
    """Put another robot into a seat of a task; say if no chain through it seems too long."""
    choice, seats, node = room.choice, graph.seats, graph.nodes[task]
    out = trial.number[COMES_BY]
    if out == NOBODY:
        out = node.first + draw_below(random, node.taken)
    cut = node.key - 1
    gather(problem, graph, choice, random, task, cut, out, True)
    best, at, least = NOBODY, 0, NEVER
    for which in range(len(problem.counts)):
        if not covers_with(problem, graph, task, task, out, which):
            continue
        for place in range(choice.found[which]):
            candidate = choice.candidates[which, place]
            if _is_in(graph, task, candidate.seat):
                continue
            value = candidate.comes + candidate.leaves
            if value < least:
                best, at, least = which, place, value
            break
    if best == NOBODY or least > limit:
        return False
    remember(graph, room.moved, task)
    node.key = cut
    tail = choice.candidates[best, at].seat
    head = seats[tail].next
    connect(graph, trial, seats[out].prev, seats[out].next)
    seats[out].kind = seats[tail].kind
    connect(graph, trial, tail, out)
    connect(graph, trial, out, head)
    return True


@kernel
def _is_in(graph: Graph, task: int, tail: int) -> bool:
    """Say whether an arc leads to a task."""
    return graph.seats[graph.seats[tail].next].node == task
