"""Giving a few tasks in a row to the coalition of another one, beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.changes import connect, remember
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.operators.draws import draw_near, keeps_order
from teamformer.planning.operators.riders import covers_with
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.changes import ArcChange
    from teamformer.planning.graph.graph import Graph
    from teamformer.planning.operators.state import SearchState

LONGEST = 6
"""How many tasks a stretch has at most."""


@kernel
def move_stretch(problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int) -> bool:
    """Give tasks that a robot does in a row to the coalition of a near task, before it or after.

    Those that this coalition cannot do stay where they are. Say if that makes no circle.
    """
    graph, trial, random = search.graph, search.trial, search.random
    moved, seats, nodes, count = search.stretch, graph.seats, graph.nodes, 0
    beside = draw_near(problem, random, task)
    if is_left_out(problem, graph, beside):
        return False
    seat = nodes[task].first + draw_below(random, nodes[task].taken)
    for _ in range(1 + draw_below(random, LONGEST) * draw_below(random, 2)):
        node = seats[seat].node
        if node == len(nodes) - 1:
            break
        if node == beside:
            return False
        seat = seats[seat].next
        if covers_with(problem, graph, node, beside, NOBODY, NOBODY):
            remember(graph, trial, node)
            moved[count] = node
            count += 1
    if count == 0:
        return False
    for place in range(count):
        node = moved[place]
        for seat in range(nodes[node].first, nodes[node].first + nodes[node].taken):
            connect(graph, trial, seats[seat].prev, seats[seat].next)
    is_after, is_turned = draw_below(random, 2) == 0, draw_below(random, 2) == 0
    edge = beside
    for index in range(count):
        place = count - 1 - index if is_turned else index
        node = moved[place]
        key = nodes[beside].key + (1 + index if is_after else -1 - index)
        if not _put_beside(graph, trial, node, edge, key, is_after):
            return False
        edge = node
    for place in range(count):
        node = moved[place]
        if nodes[node].has_links and not keeps_order(problem, graph, node, nodes[node].key):
            return False
    return True


@kernel
def _put_beside(
    graph: Graph, trial: ArcChange, task: int, edge: int, key: int, is_after: bool
) -> bool:
    """Put a task into all arcs that leave another, or lead there; say if that makes no circle."""
    seats, nodes = graph.seats, graph.nodes
    node, at = nodes[task], nodes[edge]
    node.taken, node.key = at.taken, key
    for index in range(at.taken):
        seat, known = node.first + index, at.first + index
        seats[seat].kind = seats[known].kind
        tail = known if is_after else seats[known].prev
        head = seats[known].next if is_after else known
        if not nodes[seats[tail].node].key < key < nodes[seats[head].node].key:
            return False
        connect(graph, trial, tail, seat)
        connect(graph, trial, seat, head)
    return True
