"""Charging in a graph of arcs: each seat holds what its robot has left when it leaves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import may_have_extras
from teamformer.planning.problem.charged_ways import go_charged

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph


@kernel
def is_charged(problem: ArcProblem) -> bool:
    """Say whether anybody has a battery."""
    return may_have_extras(problem) and len(problem.batteries.lasts) > 0


@kernel
def leave_charged(
    problem: ArcProblem, graph: Graph, kind: int, tail: int, goal: int, way: int, wanted: int
) -> tuple[int, int, int]:
    """Return when a robot that leaves a seat is at a goal, what it has left, and how far it goes
    round, as `go_charged` has it."""
    place, pace = graph.seats[tail].node, problem.kinds[kind].pace
    free, left = graph.nodes[place].end, graph.left[tail]
    return go_charged(
        problem.batteries, problem.rotas, kind, pace, place, free, left, goal, way, wanted
    )
