"""What it is worth that a task ends at a time: its price, how late it is, and if it is missed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import may_miss
from teamformer.planning.problem.misses import LEFT_OUT

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph

WORTH = np.dtype(
    [
        ("due", np.int64),
        ("price", np.int64),  # in steps: of each tick until its end
        ("late_price", np.int64),  # in steps: of each tick that it is late
        ("until", np.int64),  # it is missed if it ends later
        ("miss", np.int64),  # what plans are judged by for that, and what leads a search
        ("leads", np.int64),
        ("is_optional", np.int64),
    ]
)


@kernel
def is_left_out(problem: ArcProblem, graph: Graph, task: int) -> bool:
    """Say whether nobody comes to a task: a plan leaves it out."""
    return may_miss(problem) and graph.nodes[task].taken == 0


@kernel
def is_missed(problem: ArcProblem, worth: Any, end: int) -> bool:
    """Say whether a task is missed that ends then, by its row of WORTH."""
    return may_miss(problem) and end > worth.until


@kernel
def counted_end(problem: ArcProblem, worth: Any, end: int) -> int:
    """Return what counts of the end of a task where ends are added up."""
    return worth.until if is_missed(problem, worth, end) else end


@kernel
def counted_makespan(problem: ArcProblem, graph: Graph, makespan: int, leads: int) -> int:
    """Return when all is over: if something is missed, at the end of the mission at the earliest.

    `leads` is what it takes missed tasks to cost.
    """
    if may_miss(problem) and leads > 0:
        return max(makespan, graph.worth[0].until)
    return makespan


@kernel
def priced(problem: ArcProblem, worth: Any, end: int) -> int:
    """Return what it costs that a task ends then, unless it is missed."""
    if is_missed(problem, worth, end):
        return 0
    return worth.price * end + worth.late_price * max(0, end - worth.due)


@kernel
def missed(problem: ArcProblem, worth: Any, end: int) -> int:
    """Return what plans are judged by for it that a task ends then, if that is too late."""
    return worth.miss if is_missed(problem, worth, end) else 0


@kernel
def missed_leads(problem: ArcProblem, worth: Any, end: int) -> int:
    """Return the same of what leads a search: the more, the later it is, unless it is left out."""
    if not is_missed(problem, worth, end):
        return 0
    return worth.leads if end >= LEFT_OUT else worth.leads + end - worth.until


@kernel
def late_by(problem: ArcProblem, worth: Any, end: int) -> int:
    """Return by how much a task is late that ends then, unless it is missed."""
    return 0 if is_missed(problem, worth, end) else max(0, end - worth.due)
