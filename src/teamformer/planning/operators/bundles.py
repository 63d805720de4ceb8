"""Sending a whole group by a task: all robots that go from one task to another do it on the way."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import is_permit
from teamformer.planning.graph.graph import LAST
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.operators.coalition_choice import (
    FELLOWS_FROM,
    FELLOWS_TO,
    PICKS,
    Choice,
    is_lacking,
    pick_seat,
    want,
)
from teamformer.planning.operators.draws import draw_near
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph
    from teamformer.planning.operators.state import SearchState


@kernel
def draw_group(problem: ArcProblem, search: SearchState, task: int) -> int:
    """Draw a group that goes to or from a near task; return a moment at which it is on its way.

    That is NOBODY if there is none that could do the task in between.
    """
    graph, choice, random = search.graph, search.choice, search.random
    nodes, seats = graph.nodes, graph.seats
    near = draw_near(problem, random, task)
    if is_left_out(problem, graph, near):
        return NOBODY
    seat = nodes[near].first + draw_below(random, nodes[near].taken)
    tail = seat if draw_below(random, 2) == 0 else seats[seat].prev
    begin, end = seats[tail].node, seats[seats[tail].next].node
    if task in (begin, end):
        return NOBODY
    choice.number[FELLOWS_FROM], choice.number[FELLOWS_TO] = begin, end
    least, most = nodes[begin].key + 1, nodes[end].key - 1
    if most < least:
        return NOBODY
    there = nodes[begin].end + problem.ways[0, begin, task]
    if nodes[end].key == LAST:
        return max(least, 2 * there)
    return max(least, min(most, 2 * there))


@kernel
def pick_group(problem: ArcProblem, graph: Graph, choice: Choice, task: int) -> bool:
    """Pick all robots of the group that was drawn; say if they cover the task."""
    nodes, seats = graph.nodes, graph.seats
    begin, end = choice.number[FELLOWS_FROM], choice.number[FELLOWS_TO]
    want(problem, choice, nodes[task].need)
    first, taken = nodes[begin].first, nodes[begin].taken
    for tail in range(first, first + taken):
        head = seats[tail].next
        if seats[head].node != end:
            continue
        kind = seats[tail].kind
        useful = problem.useful[nodes[task].need, problem.kinds[kind].type]
        if is_permit(problem, kind) and useful == 0:
            continue
        if choice.number[PICKS] == problem.most[0]:
            return False
        pick_seat(problem, graph, choice, task, tail, head)
    return not is_lacking(choice)
