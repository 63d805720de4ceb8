"""Shifts in a graph of arcs: robots pause on their way, and a task fits into a shift of each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.mission.parts.shifts import MOST_TRIED
from teamformer.planning.graph.arc_problem import may_have_extras
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.problem.rotas import (
    fits,
    have_shifts,
    pair_off_together,
    walk_together,
    walked,
)

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph


@kernel
def is_in_shifts(problem: ArcProblem) -> bool:
    """Say whether anybody works in shifts only."""
    return may_have_extras(problem) and have_shifts(problem.rotas)


@kernel
def walked_by(problem: ArcProblem, kind: int, begin: int, way: int) -> int:
    """Return when a robot of a kind has walked so long that sets out at `begin`."""
    if is_in_shifts(problem):
        return walked(problem.rotas, kind, begin, way)
    return begin + way


@kernel
def fitted(
    problem: ArcProblem, graph: Graph, task: int, first_seat: int, earliest: int, takes: int
) -> int:
    """Return the first moment from which something fits into a shift of each robot of a task."""
    if not is_in_shifts(problem):
        return earliest
    start = earliest
    for _ in range(MOST_TRIED):
        before = start
        for seat in range(first_seat, first_seat + graph.nodes[task].taken):
            start = fits(problem.rotas, graph.seats[seat].kind, start, takes)
        if start == before:
            return start
    return max(earliest, problem.rotas.late[0])


@kernel
def united(problem: ArcProblem, graph: Graph, first_seat: int, taken: int, count: int) -> int:
    """Return, in steps, when groups are one team that are there in the first steps of `there`."""
    for seat in range(taken):
        graph.together[seat] = graph.seats[first_seat + seat].kind
    return pair_off_together(problem.rotas, graph.together, taken, graph.there, count, TICKS)


@kernel
def left_by(problem: ArcProblem, graph: Graph, node: int, to: int, leaves: int, steps: int) -> int:
    """Return, in steps, when a group has walked so many that leaves a node for another."""
    if not is_in_shifts(problem):
        return leaves + steps
    first, count = graph.nodes[node].first, 0
    for seat in range(first, first + graph.nodes[node].taken):
        if graph.seats[graph.seats[seat].next].node == to:
            graph.together[count] = graph.seats[seat].kind
            count += 1
    begin, spent = leaves * TICKS, steps * TICKS
    return walk_together(problem.rotas, graph.together, count, begin, spent, TICKS) // TICKS
