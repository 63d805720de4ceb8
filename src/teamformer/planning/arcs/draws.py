"""Where a change begins: a task that the makespan hangs on, or any."""

from __future__ import annotations

from teamformer.jit import kernel
from teamformer.planning.arcs.graph import LATEST, ArcProblem, Graph, seats_a_task
from teamformer.planning.coalitions.problem import NOBODY
from teamformer.planning.relaxation.insertion import draw_below
from teamformer.rules.arrays import Array


@kernel
def draw_task(problem: ArcProblem, graph: Graph, random: Array) -> int:
    """Draw a task, every other time one that the makespan hangs on."""
    if draw_below(random, 2) == 0:
        task = draw_critical(problem, graph, random)
        if task != NOBODY:
            return task
    return draw_below(random, len(problem.near))


@kernel
def draw_critical(problem: ArcProblem, graph: Graph, random: Array) -> int:
    """Draw a task on the way back from the home that is reached last; NOBODY if there is none."""
    seats, tasks, most = graph.seats, len(problem.near), seats_a_task(problem, graph)
    task = seats[seats[len(seats) - len(graph.back) + graph.total[LATEST]].prev].node
    drawn, count = NOBODY, 0
    while task != NOBODY and task < tasks:
        count += 1
        if draw_below(random, count) == 0:
            drawn = task
        task = _waited_for(problem, graph, task, task * most)
    return drawn


@kernel
def _waited_for(problem: ArcProblem, graph: Graph, task: int, first_seat: int) -> int:
    """Return the task or depot that a task could not start without; NOBODY if it was released."""
    nodes, start = graph.nodes, graph.nodes[task].end - graph.nodes[task].duration
    if nodes[task].has_links:
        for other in problem.before[task]:
            if other == NOBODY:
                break
            if nodes[other].end == start:
                return other
    if nodes[task].release == start:
        return NOBODY
    latest, there = NOBODY, -1
    for seat in range(first_seat, first_seat + nodes[task].taken):
        place = graph.seats[graph.seats[seat].prev].node
        pace = problem.kinds[graph.seats[seat].kind].pace
        comes = nodes[place].end + problem.ways[pace, place, task]
        if comes > there:
            latest, there = place, comes
    return latest
