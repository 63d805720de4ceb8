"""Moving a task to another moment, with a new coalition from the arcs that cross it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ANYWHERE, BUNDLE, IN_PLACE, ArcProblem
from teamformer.planning.graph.changes import COMES_BY, connect, remember
from teamformer.planning.graph.graph import MAKESPAN, Graph
from teamformer.planning.operators.bundles import draw_group, pick_group
from teamformer.planning.operators.coalition_choice import (
    COMES,
    FELLOWS_FROM,
    LEAVES,
    PICKS,
    choose,
    gather,
    sum_up_picks,
)
from teamformer.planning.operators.draws import cut_beside_near, keeps_order
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState

NEAR_ITS_START = 20  # percent
"""How many tasks are moved near to their start; the others beside a near task or to any moment."""

NEAR = 2
"""How many legs are near to a start."""

BY_CHAIN = 75  # percent
"""How often a coalition is picked by its longest chain, not only by when it comes; for a load it
always is, as the chain counts how fast it goes."""


@kernel
def move_task(problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int) -> bool:
    """Move a task; say if robots were found and no chain through it seems too long."""
    graph, trial, random = search.graph, search.trial, search.random
    choice = search.choice
    node, need = graph.nodes[task], graph.nodes[task].need
    choice.number[FELLOWS_FROM] = cut = NOBODY
    if problem.habits[BUNDLE] > 0 and draw_below(random, 100) < problem.habits[BUNDLE]:
        cut = draw_group(problem, search, task)
    is_picked = cut != NOBODY and pick_group(problem, graph, choice, task)
    if cut == NOBODY:
        cut = _draw_cut(problem, graph, random, task, leg, limit)
    if node.has_links and not keeps_order(problem, graph, task, cut):
        return False
    if not is_picked:
        by_chain = draw_below(random, 100) < BY_CHAIN or bool(node.is_load)
        gather(problem, search, task, cut, trial.number[COMES_BY], by_chain)
        if not choose(problem, choice, random, need, by_chain):
            return False
    sum_up_picks(choice)
    comes = max(choice.number[COMES], node.release)
    if comes + choice.number[LEAVES] > limit + leg:
        return False
    _put(problem, search, task, cut)
    return True


@kernel
def _draw_cut(
    problem: ArcProblem, graph: Graph, random: Array, task: int, leg: int, limit: int
) -> int:
    """Draw a moment: beside a near task, near its own start, now and then any."""
    nodes = graph.nodes
    draw, habits = draw_below(random, 100), problem.habits
    if draw < habits[ANYWHERE]:
        return 2 * draw_below(random, graph.total[MAKESPAN])
    if draw < habits[ANYWHERE] + habits[IN_PLACE]:
        return nodes[task].key - 1
    if draw < habits[ANYWHERE] + habits[IN_PLACE] + NEAR_ITS_START:
        start = nodes[task].end - nodes[task].duration
        spread = NEAR * leg + 1
        return 2 * max(1, start - spread + draw_below(random, 2 * spread))
    return cut_beside_near(problem, graph, random, task, leg, limit)


@kernel
def _put(problem: ArcProblem, search: SearchState, task: int, cut: int) -> None:
    """Take a task out of its arcs, and put it into those that were picked."""
    graph, trial, choice = search.graph, search.trial, search.choice
    seats, node, most = graph.seats, graph.nodes[task], problem.most[0]
    remember(graph, trial, task)
    for seat in range(node.first, node.first + node.taken):
        connect(graph, trial, seats[seat].prev, seats[seat].next)
    node.taken, node.key = choice.number[PICKS], cut
    for index in range(node.taken):
        seat, tail = task * most + index, choice.pick[index].seat
        seats[seat].kind = choice.pick[index].kind
        head = seats[tail].next
        connect(graph, trial, tail, seat)
        connect(graph, trial, seat, head)
