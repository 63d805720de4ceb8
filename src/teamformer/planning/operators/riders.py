"""Robots that come along where a task can be done without them, and such that do not any more.

In steps nobody parts then, and in continuous time nobody has to form; or the way by the task is the
quicker one, or costs less.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import is_weighed
from teamformer.planning.graph.changes import KEY, LOGGED, connect, follow, remember
from teamformer.planning.graph.graph import is_in_steps
from teamformer.planning.graph.ledger import travel_of
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.operators.draws import draw_near
from teamformer.planning.operators.group_moves import are_apart
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.links import TRAVEL
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.base.array_types import Array
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.changes import ArcChange
    from teamformer.planning.graph.graph import Graph
    from teamformer.planning.operators.state import SearchState

MOST_MOVED = 8
"""How many tasks one change moves at most."""

SKIPS, JOINS = 20, 20  # percent
"""How many changes of riders skip tasks and, in steps, join at one task; the others follow a
guide."""


@kernel
def ride(problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int) -> bool:
    """Have a robot come along with others, or skip what can be done without it.

    Say if anything is changed, and no robot does two tasks then that are linked.
    """
    graph, trial, ledger, random = search.graph, search.trial, search.ledger, search.random
    what = draw_below(random, 100)
    if what < SKIPS:
        _skip(problem, search, task)
    elif not is_in_steps(graph):
        _ride_along(problem, search, task)
    elif what < SKIPS + JOINS:
        tail = _draw_fellow(problem, graph, random, task)
        if tail != NOBODY:
            remember(graph, trial, task)
            _come_along(graph, trial, task, tail)
    else:
        _follow_a_guide(problem, search, task)
    if is_weighed(problem):
        ledger.then[TRAVEL] = travel_of(problem, graph)
        for place in range(trial.number[LOGGED]):
            if trial.log[place].what != KEY:
                continue
            members = problem.links.members[problem.links.group[trial.log[place].index]]
            if members[1] != NOBODY and not are_apart(problem, graph, members):
                return False
    return bool(trial.number[LOGGED] > 0)


@kernel
def _skip(problem: ArcProblem, search: SearchState, task: int) -> None:
    """Have a robot skip tasks, from one on, while they can be done without it."""
    graph, trial, random = search.graph, search.trial, search.random
    seats, nodes = graph.seats, graph.nodes
    seat = nodes[task].first + draw_below(random, nodes[task].taken)
    for _ in range(1 + draw_below(random, MOST_MOVED)):
        node = seats[seat].node
        if node == len(nodes) - 1 or not covers_with(problem, graph, node, node, seat, NOBODY):
            break
        following = seats[seat].next
        remember(graph, trial, node)
        leave_out(graph, trial, node, seat)
        seat = following


@kernel
def covers_with(
    problem: ArcProblem, graph: Graph, task: int, other: int, out: int, which: int
) -> bool:
    """Say whether the coalition of another task covers a task.

    It does so without the robot of seat `out`, and with one of type `which`, if these are anybody.
    """
    need, node = graph.nodes[task].need, graph.nodes[other]
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[need, cap]
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
def leave_out(graph: Graph, trial: ArcChange, task: int, seat: int) -> None:
    """Take a robot out of a coalition; the last seat takes its place."""
    seats, node = graph.seats, graph.nodes[task]
    last = node.first + node.taken - 1
    connect(graph, trial, seats[seat].prev, seats[seat].next)
    if seat != last:
        connect(graph, trial, seats[last].prev, seat)
        connect(graph, trial, seat, seats[last].next)
        seats[seat].kind = seats[last].kind
    node.taken -= 1
    follow(graph, trial, node.first)


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
def _come_along(graph: Graph, trial: ArcChange, task: int, tail: int) -> None:
    """Lead the robot that leaves a seat by a task, too."""
    seats, node = graph.seats, graph.nodes[task]
    seat, head = node.first + node.taken, seats[tail].next
    node.taken += 1
    seats[seat].kind = seats[tail].kind
    connect(graph, trial, tail, seat)
    connect(graph, trial, seat, head)


@kernel
def _follow_a_guide(problem: ArcProblem, search: SearchState, task: int) -> None:
    """Have a robot go with another one of a task until they meet again."""
    graph, random = search.graph, search.random
    seats, nodes = graph.seats, graph.nodes
    tail = nodes[task].first + draw_below(random, nodes[task].taken)
    guide = nodes[task].first + draw_below(random, nodes[task].taken)
    if guide != tail:
        count = 1 + draw_below(random, MOST_MOVED)
        _go_with(problem, search, tail, seats[guide].next, count)


@kernel
def _ride_along(problem: ArcProblem, search: SearchState, task: int) -> None:
    """Have a robot that is on its way when a task starts do it, too, and go on from there.

    Every other time it stays with one of the task's robots for a while.
    """
    graph, random = search.graph, search.random
    nodes, seats, robots = graph.nodes, graph.seats, len(graph.back)
    tail = len(seats) - 2 * robots + draw_below(random, robots)
    other = draw_near(problem, random, task)
    if draw_below(random, 2) == 0 and not is_left_out(problem, graph, other):
        tail = nodes[other].first + draw_below(random, nodes[other].taken)
        if nodes[other].key >= nodes[task].key:
            tail = seats[tail].prev
    if nodes[seats[tail].node].key < nodes[task].key:
        guide = nodes[task].first + draw_below(random, nodes[task].taken)
        count = 1 + draw_below(random, 2) * draw_below(random, MOST_MOVED)
        _go_with(problem, search, tail, guide, count)


@kernel
def _go_with(problem: ArcProblem, search: SearchState, tail: int, guide: int, count: int) -> None:
    """Have the robot that leaves a seat do what another one does from a seat on, so many tasks.

    It is less where they would meet, or where no seat is left.
    """
    graph, trial = search.graph, search.trial
    seats, nodes = graph.seats, graph.nodes
    head, kind = seats[tail].next, seats[tail].kind
    for _ in range(count):
        node = nodes[seats[guide].node]
        if node.key >= nodes[seats[head].node].key or node.taken == problem.most[0]:
            break
        remember(graph, trial, seats[guide].node)
        seat = node.first + node.taken
        node.taken += 1
        seats[seat].kind = kind
        connect(graph, trial, tail, seat)
        tail, guide = seat, seats[guide].next
    if trial.number[LOGGED] > 0:
        connect(graph, trial, tail, head)
