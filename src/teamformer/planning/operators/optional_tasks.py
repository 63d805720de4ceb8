"""Optional tasks: one is left out, or left out for another one. Putting one in is moving it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ArcProblem, is_weighed
from teamformer.planning.graph.changes import COMES_BY, LEAVES_BY, connect, remember, wait
from teamformer.planning.graph.graph import Graph
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.operators.draws import draw_near
from teamformer.planning.operators.group_moves import move_group, take_out
from teamformer.planning.operators.task_moves import move_task
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState

NEAR_DRAWS = 8
"""How many near tasks are looked at for one that is left out."""


@kernel
def drop_task(problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int) -> bool:
    """Leave an optional task out, with all that are linked with it; say if none comes after."""
    if not is_weighed(problem):
        return _drop_one(problem, search, task)
    for member in problem.links.members[problem.links.group[task]]:
        if member == NOBODY:
            break
        if not _drop_one(problem, search, member):
            return False
    return True


@kernel
def exchange_tasks(
    problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int
) -> bool:
    """Leave an optional task out, and put in another one that was; say if there is one."""
    graph, trial, random = search.graph, search.trial, search.random
    other = _draw_left_out(problem, graph, random, task)
    if other == NOBODY:
        return False
    if not drop_task(problem, search, task, leg, limit):
        return False
    trial.number[COMES_BY] = trial.number[LEAVES_BY] = NOBODY
    if is_weighed(problem):
        return move_group(problem, search, other, leg, limit)
    return move_task(problem, search, other, leg, limit)


@kernel
def _drop_one(problem: ArcProblem, search: SearchState, task: int) -> bool:
    """Take a task out of its arcs; say if no task of the plan comes after it."""
    graph, trial = search.graph, search.trial
    node, seats = graph.nodes[task], graph.seats
    if node.has_links:
        for other in problem.after[task]:
            if other == NOBODY:
                break
            if graph.nodes[other].taken > 0:
                return False
    if is_weighed(problem):
        take_out(problem, search, task, 0)
    else:
        remember(graph, trial, task)
        for seat in range(node.first, node.first + node.taken):
            connect(graph, trial, seats[seat].prev, seats[seat].next)
        node.taken = 0
    if not node.is_waiting:
        wait(graph, trial, task, node.key)
    return True


@kernel
def _draw_left_out(problem: ArcProblem, graph: Graph, random: Array, task: int) -> int:
    """Draw a task that is left out, a near one if there is one; NOBODY if there is none."""
    for _ in range(NEAR_DRAWS):
        other = draw_near(problem, random, task)
        if is_left_out(problem, graph, other):
            return other
    tasks = len(problem.near)
    other = draw_below(random, tasks)
    for _ in range(tasks):
        if is_left_out(problem, graph, other):
            return other
        other = other + 1 if other + 1 < tasks else 0
    return NOBODY
