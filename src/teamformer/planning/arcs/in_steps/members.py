"""Changes of a coalition where it stands: another robot for one of it, and riders.

A rider goes with its fellows though a task can be done without it: then nobody parts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.jit import kernel
from teamformer.planning.arcs.coalition_choice import Choice, gather
from teamformer.planning.arcs.judging import COMES_BY, begin_trial, connect, propagate
from teamformer.planning.arcs.task_moves import MOVED, Moved, remember
from teamformer.planning.continuous.problem import NEVER, NOBODY
from teamformer.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.arcs.graph import ArcProblem, Graph
    from teamformer.planning.arcs.judging import Trial
    from teamformer.rules.arrays import Array


@kernel
def replace_member(
    problem: ArcProblem,
    graph: Graph,
    trial: Trial,
    choice: Choice,
    moved: Moved,
    random: Array,
    task: int,
    limit: int,
) -> bool:
    """Put another robot into a seat of a task; say if no chain is too long then."""
    begin_trial(trial)
    seats, node = graph.seats, graph.nodes[task]
    moved.number[MOVED] = NOBODY
    out = trial.number[COMES_BY]
    if out == NOBODY:
        out = node.first + draw_below(random, node.taken)
    cut = node.key - 1
    gather(problem, graph, choice, random, task, cut, out, True)
    best, at, least = NOBODY, 0, NEVER
    for which in range(len(problem.counts)):
        if not _covers_without(problem, graph, task, out, which):
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
    remember(graph, moved, task)
    node.key = cut
    tail = choice.candidates[best, at].seat
    head = seats[tail].next
    connect(graph, trial, seats[out].prev, seats[out].next)
    seats[out].kind = seats[tail].kind
    connect(graph, trial, tail, out)
    connect(graph, trial, out, head)
    return propagate(problem, graph, trial, limit)


@kernel
def _is_in(graph: Graph, task: int, tail: int) -> bool:
    """Say whether an arc leads to a task."""
    return graph.seats[graph.seats[tail].next].node == task


@kernel
def _covers_without(problem: ArcProblem, graph: Graph, task: int, out: int, which: int) -> bool:
    """Say whether a coalition covers its task without a seat, and with one more of a type."""
    node = graph.nodes[task]
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[node.need, cap]
        if lacking > 0:
            if which != NOBODY:
                lacking -= problem.counts[which, cap]
            for seat in range(node.first, node.first + node.taken):
                if seat != out:
                    kind = graph.seats[seat].kind
                    lacking -= problem.counts[problem.kinds[kind].type, cap]
            if lacking > 0:
                return False
    return True


@kernel
def ride(
    problem: ArcProblem,
    graph: Graph,
    trial: Trial,
    moved: Moved,
    random: Array,
    task: int,
    limit: int,
) -> bool:
    """Have a robot come along, or a spare one leave; say if no chain is too long then."""
    begin_trial(trial)
    moved.number[MOVED] = NOBODY
    node = graph.nodes[task]
    if draw_below(random, 2) == 0:
        seat = node.first + draw_below(random, node.taken)
        if not _covers_without(problem, graph, task, seat, NOBODY):
            return False
        remember(graph, moved, task)
        _leave_out(graph, trial, task, seat)
    else:
        tail = _draw_fellow(problem, graph, random, task)
        if tail == NOBODY:
            return False
        remember(graph, moved, task)
        _come_along(graph, trial, task, tail)
    return propagate(problem, graph, trial, limit)


@kernel
def _leave_out(graph: Graph, trial: Trial, task: int, seat: int) -> None:
    """Take a robot out of a coalition; the last seat takes its place."""
    seats, node = graph.seats, graph.nodes[task]
    last = node.first + node.taken - 1
    connect(graph, trial, seats[seat].prev, seats[seat].next)
    if seat != last:
        connect(graph, trial, seats[last].prev, seat)
        connect(graph, trial, seat, seats[last].next)
        seats[seat].kind = seats[last].kind
    node.taken -= 1


@kernel
def _draw_fellow(problem: ArcProblem, graph: Graph, random: Array, task: int) -> int:
    """Return the seat of one that was with a robot before a task and goes on past it, or NOBODY."""
    seats, nodes, node = graph.seats, graph.nodes, graph.nodes[task]
    if node.taken == problem.most[0]:
        return NOBODY
    before = seats[seats[node.first + draw_below(random, node.taken)].prev].node
    drawn, count = NOBODY, 0
    for tail in range(nodes[before].first, nodes[before].first + nodes[before].taken):
        if nodes[seats[seats[tail].next].node].key > node.key:
            count += 1
            if count == 1 or draw_below(random, count) == 0:
                drawn = tail
    return drawn


@kernel
def _come_along(graph: Graph, trial: Trial, task: int, tail: int) -> None:
    """Lead the robot that leaves a seat by a task, too."""
    seats, node = graph.seats, graph.nodes[task]
    seat, head = node.first + node.taken, seats[tail].next
    node.taken += 1
    seats[seat].kind = seats[tail].kind
    connect(graph, trial, tail, seat)
    connect(graph, trial, seat, head)
