"""Swapping the heads of two arcs: two robots of a kind exchange all that they do from there on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ArcProblem
from teamformer.planning.graph.changes import COMES_BY, LEAVES_BY, connect
from teamformer.planning.graph.graph import Graph, leave
from teamformer.planning.operators.coalition_choice import THIS_ONE
from teamformer.planning.operators.draws import draw_near
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState


@kernel
def swap_heads(problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int) -> bool:
    """Lead an arc from a task to one near it, or from there; say if no chain is too long then."""
    graph, trial, random = search.graph, search.trial, search.random
    seats, nodes, most = graph.seats, graph.nodes, problem.most[0]
    other = draw_near(problem, random, task)
    if nodes[other].key == nodes[task].key:
        return False
    mine = trial.number[LEAVES_BY if nodes[task].key < nodes[other].key else COMES_BY]
    if mine == NOBODY or draw_below(random, 100) >= THIS_ONE:
        mine = task * most + draw_below(random, nodes[task].taken)
    theirs = _draw_alike(graph, random, other, most, seats[mine].kind)
    if theirs == NOBODY:
        return False
    tail, head = (mine, theirs) if nodes[task].key < nodes[other].key else (theirs, mine)
    end, begin = seats[tail].next, seats[head].prev
    if end == head or nodes[seats[begin].node].key >= nodes[seats[end].node].key:
        return False
    if _chain(problem, graph, tail, head) > limit or _chain(problem, graph, begin, end) > limit:
        return False
    connect(graph, trial, tail, head)
    connect(graph, trial, begin, end)
    return True


@kernel
def _chain(problem: ArcProblem, graph: Graph, tail: int, head: int) -> int:
    """Return the longest chain along an arc that is not there yet."""
    place, kind = graph.seats[tail].node, graph.seats[tail].kind
    return graph.nodes[place].end + leave(problem, graph, kind, place, head)


@kernel
def _draw_alike(graph: Graph, random: Array, task: int, most: int, kind: int) -> int:
    """Draw a seat of a task that has a kind; NOBODY if there is none."""
    drawn, count = NOBODY, 0
    for seat in range(task * most, task * most + graph.nodes[task].taken):
        if graph.seats[seat].kind == kind:
            count += 1
            if count == 1 or draw_below(random, count) == 0:
                drawn = seat
    return drawn
