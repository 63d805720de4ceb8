"""When robots are where arcs lead them in continuous time, and what they have left then.

The one rule of a way in a graph: whatever a key does to ways is done here, for starts, homes and
all who only ask who could come.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import is_permit
from teamformer.planning.graph.charging import is_charged, leave_charged
from teamformer.planning.graph.pauses import walked_by
from teamformer.planning.problem.charged_ways import in_ticks
from teamformer.planning.problem.rotas import worked

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph


@kernel
def arrive(
    problem: ArcProblem, graph: Graph, kind: int, tail: int, task: int
) -> tuple[int, int, int]:
    """Return when a robot of a kind that leaves a seat is at a task, and what it has left then.

    Last by how much its way is longer as it charges. All is 0 where nobody has a battery.
    """
    place, pace = graph.seats[tail].node, problem.kinds[kind].pace
    way = problem.ways_to[pace, task, place]
    if is_charged(problem):
        wanted = problem.batteries.spends[kind, task] + problem.batteries.nearest[pace, task]
        return leave_charged(problem, graph, kind, tail, task, way, wanted)
    return walked_by(problem, kind, graph.nodes[place].end, way), 0, 0


@kernel
def arrive_home(problem: ArcProblem, graph: Graph, home: int) -> tuple[int, int, int]:
    """Return the same of the way home, by the seat of a home."""
    tail, kind = graph.seats[home].prev, graph.seats[home].kind
    place = graph.seats[tail].node
    way = problem.home[kind, place]
    if is_charged(problem):
        return leave_charged(problem, graph, kind, tail, len(problem.near), way, 0)
    return walked_by(problem, kind, graph.nodes[place].end, way), 0, 0


@kernel
def left_after(problem: ArcProblem, graph: Graph, seat: int, start: int) -> tuple[int, int]:
    """Return what who takes a seat of a task has left when it ends, and by how much it goes round.

    It is less than 0 if the robot has too little. When the task starts has been worked out before.
    """
    kind, task = graph.seats[seat].kind, graph.seats[seat].node
    if is_permit(problem, kind):
        return problem.batteries.lasts[kind], 0
    comes, left, detour = graph.came[seat, 0], graph.came[seat, 1], graph.came[seat, 2]
    waits = worked(problem.rotas, kind, comes, start)
    waiting = in_ticks(problem.batteries.waiting[kind] * waits)
    carried = graph.nodes[task].duration - problem.batteries.services[task]
    return left - waiting - problem.batteries.serves[kind, task] - carried, detour
