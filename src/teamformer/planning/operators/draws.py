"""Draws of a change: the task that it begins with, and the moment that a task is moved to."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ArcProblem, is_weighed, takes_with
from teamformer.planning.graph.arriving import arrive
from teamformer.planning.graph.changes import CHAINED, COMES_BY, LEAVES_BY, ArcChange
from teamformer.planning.graph.graph import LAST, LATEST, Graph, is_in_steps, leave
from teamformer.planning.graph.worth import is_left_out, late_by
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.constants import TICKS
from teamformer.planning.problem.links import MAX_TARDINESS, TARDINESS
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState

ON_CHAIN = 65  # percent
"""How often a change begins with a task that the makespan hangs on."""

LATE = 20  # percent
"""How often it begins at the latest task, or before it on the way of a robot that does it."""

BACKWARDS = 5
"""How many tasks before the latest one that is at most."""

MOST_DRAWS = 30
"""How many robots are drawn at most to find one that has room for a task."""


@kernel
def draw_task(problem: ArcProblem, search: SearchState) -> int:
    """Draw a task, often one that the makespan hangs on; if plans have a cost, one that is late.

    Of a task that the makespan hangs on it is noted by which of its seats what it hangs on comes
    and leaves.
    """
    graph, trial, random = search.graph, search.trial, search.random
    if is_weighed(problem):
        return _draw_late(problem, search)
    number = trial.number
    if draw_below(random, 100) < ON_CHAIN:
        if number[CHAINED] == NOBODY:
            _find_chain(problem, graph, trial)
        if number[CHAINED] > 0:
            link = trial.chain[draw_below(random, number[CHAINED])]
            number[COMES_BY], number[LEAVES_BY] = link[1], link[2]
            return int(link[0])
    number[COMES_BY] = number[LEAVES_BY] = NOBODY
    return draw_below(random, len(problem.near))


@kernel
def _find_chain(problem: ArcProblem, graph: Graph, trial: ArcChange) -> None:
    """List the tasks on the way back from the home that is reached last."""
    seats, tasks, most = graph.seats, len(problem.near), problem.most[0]
    leaves_by = seats[len(seats) - len(graph.back) + graph.total[LATEST]].prev
    count, task = 0, seats[leaves_by].node
    while task != NOBODY and task < tasks:
        comes_by, before = _waited_for(problem, graph, task, task * most)
        link = trial.chain[count]
        link[0], link[1], link[2] = task, comes_by, leaves_by
        count += 1
        if comes_by == NOBODY:
            leaves_by, task = NOBODY, before
        else:
            leaves_by = seats[comes_by].prev
            task = seats[leaves_by].node
    trial.number[CHAINED] = count


@kernel
def _waited_for(problem: ArcProblem, graph: Graph, task: int, first_seat: int) -> tuple[int, int]:
    """Return the seat whose robot came last, or NOBODY and the task that had to end before.

    Both are NOBODY if the task was released last.
    """
    nodes, start = graph.nodes, graph.nodes[task].end - graph.nodes[task].duration
    if nodes[task].has_links:
        for other in problem.before[task]:
            if other == NOBODY:
                break
            is_next_step = is_in_steps(graph) and nodes[other].end // TICKS + 1 == start // TICKS
            if is_next_step or nodes[other].end == start:
                return NOBODY, int(other)
    if nodes[task].release == start:
        return NOBODY, NOBODY
    latest, there = NOBODY, -1
    for seat in range(first_seat, first_seat + nodes[task].taken):
        tail = graph.seats[seat].prev
        if is_in_steps(graph):
            comes = graph.comes[tail]
        else:
            comes, _, _ = arrive(problem, graph, graph.seats[seat].kind, tail, task)
        if comes > there:
            latest, there = seat, comes
    return latest, NOBODY


@kernel
def _draw_late(problem: ArcProblem, search: SearchState) -> int:
    """Draw a task: now and then the latest one or one before it, else any."""
    graph, ledger, random = search.graph, search.ledger, search.random
    nodes, seats, tasks = graph.nodes, graph.seats, len(problem.near)
    task = draw_below(random, tasks)
    latest, weight = ledger.part[MAX_TARDINESS], problem.links.weight
    is_counted = weight[TARDINESS] > 0 or weight[MAX_TARDINESS] > 0
    if latest == 0 or not is_counted or draw_below(random, 100) >= LATE:
        return task
    for _ in range(tasks):
        if late_by(problem, graph.worth[task], nodes[task].end) == latest:
            break
        task = task + 1 if task + 1 < tasks else 0
    if is_left_out(problem, graph, task):
        return task
    for _ in range(draw_below(random, BACKWARDS + 1)):
        before = seats[seats[nodes[task].first + draw_below(random, nodes[task].taken)].prev].node
        if before >= tasks:
            break
        task = before
    return task


@kernel
def draw_near(problem: ArcProblem, random: Array, task: int) -> int:
    """Draw a task near to another; the task itself if it is the only one."""
    if problem.near.shape[1] == 0:
        return task
    return problem.near[task, draw_below(random, problem.near.shape[1])]


@kernel
def cut_beside_near(
    problem: ArcProblem, graph: Graph, random: Array, task: int, leg: int, limit: int
) -> int:
    """Draw a moment on the way of a robot from or to a near task.

    Robots are drawn until one is of use and has room for the task: no chain through it would be
    longer than the limit, as far as can be told before. The moment is one at which it can start the
    task. If none of those drawn has room, it is any on the way of the last.
    """
    nodes, seats = graph.nodes, graph.seats
    least, past = 0, 1  # of the robot at hand
    for _ in range(MOST_DRAWS):
        tail, head = _draw_arc(problem, graph, random, task)
        kind, place, key = seats[tail].kind, seats[tail].node, nodes[seats[head].node].key
        least = (nodes[place].key - 1) // 2  # -1 for depots
        past = nodes[place].end + leg if key == LAST else (key - 1) // 2
        if problem.useful[nodes[task].need, problem.kinds[kind].type] == 0:
            continue
        pace = problem.kinds[kind].pace
        comes, _, _ = arrive(problem, graph, kind, tail, task)
        takes = takes_with(problem, pace, task)
        latest = limit - takes - leave(problem, graph, kind, task, head)
        if comes <= latest:
            least, past = max(least, min(comes, past - 1)), min(past, latest + 1)
            break
    return 2 * (least + 1 + draw_below(random, max(1, past - least)))


@kernel
def _draw_arc(problem: ArcProblem, graph: Graph, random: Array, task: int) -> tuple[int, int]:
    """Draw an arc from or to a near task, as if the task at hand were nowhere: tail and head."""
    seats, other = graph.seats, draw_near(problem, random, task)
    if is_left_out(problem, graph, other):
        robots = len(graph.back)
        depot = len(seats) - 2 * robots + draw_below(random, robots)
        head = seats[depot].next
        return depot, seats[head].next if seats[head].node == task else head
    seat = graph.nodes[other].first + draw_below(random, graph.nodes[other].taken)
    tail, head = seat, seats[seat].next
    if draw_below(random, 2) == 0:
        tail, head = seats[seat].prev, seat
    if seats[head].node == task:
        head = seats[head].next
    if seats[tail].node == task:
        tail = seats[tail].prev
    return tail, head


@kernel
def keeps_order(problem: ArcProblem, graph: Graph, task: int, cut: int) -> bool:
    """Say whether a cut lies behind all tasks that come before a task, and before those after."""
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if graph.nodes[other].key > cut:
            return False
    for other in problem.after[task]:
        if other == NOBODY:
            break
        if graph.nodes[other].key < cut:
            return False
    return True
