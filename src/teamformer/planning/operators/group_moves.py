"""Moving a task, or all tasks that are linked with it, to another moment and other robots."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ArcProblem, is_permit, may_miss, takes_with
from teamformer.planning.graph.changes import connect, remember
from teamformer.planning.graph.graph import LAST, Graph
from teamformer.planning.graph.ledger import lead, way_out
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.operators.candidates import STAMP, CandidateRoom, choose, gather
from teamformer.planning.operators.coalition_choice import PICKS
from teamformer.planning.operators.draws import cut_beside_near, keeps_order
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY
from teamformer.planning.problem.links import FREE, TRAVEL
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState

ALONE = 40  # percent
"""How often a task that is linked is moved alone, to where its gaps let it start."""

IN_WINDOW, IN_PLACE = 40, 20  # percent
"""How often a task is moved to any moment of its window, or about where it is; else beside a near
one."""


@kernel
def move_group(problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int) -> bool:
    """Move a task or its group; say if robots were found."""
    graph, random = search.graph, search.random
    nodes, members = graph.nodes, problem.links.members[problem.links.group[task]]
    if members[1] == NOBODY:
        cut = _draw_cut(problem, graph, random, task, leg)
        was = take_out(problem, search, task, 0)
        return _put_in(problem, search, task, cut, was)
    if not is_left_out(problem, graph, task) and draw_below(random, 100) < ALONE:
        other = _draw_other(members, random, task)
        start = nodes[other].end - nodes[other].duration
        cut = _cut_beside(problem, graph, random, other, task, start)
        was = take_out(problem, search, task, 0)
        if not _put_in(problem, search, task, cut, was):
            return False
        return are_apart(problem, graph, members)
    cut = _draw_cut(problem, graph, random, task, leg)
    was = 0
    for other in members:
        if other == NOBODY:
            break
        was = take_out(problem, search, other, was)
    if not _put_in(problem, search, task, cut, was):
        return False
    for other in members:
        if other == NOBODY:
            break
        if other != task:
            beside = _cut_beside(problem, graph, random, task, other, cut // 2)
            if not _put_in(problem, search, other, beside, was):
                return False
    return are_apart(problem, graph, members)


@kernel
def _draw_other(members: Array, random: Array, task: int) -> int:
    """Draw another task of a group."""
    drawn, count = task, 0
    for other in members:
        if other == NOBODY:
            break
        if other != task:
            count += 1
            if draw_below(random, count) == 0:
                drawn = other
    return drawn


@kernel
def _cut_beside(
    problem: ArcProblem, graph: Graph, random: Array, task: int, other: int, start: int
) -> int:
    """Draw a moment at which another task of a group can start if this one starts at `start`."""
    nodes = graph.nodes
    least, most = problem.links.gap[task, other], problem.links.gap[other, task]
    apart = (nodes[other].end - nodes[other].duration) - (nodes[task].end - nodes[task].duration)
    low = least if least > FREE else apart
    high = -most if most > FREE else max(low, apart)
    return 2 * max(0, start + low + draw_below(random, max(1, high - low + 1)))


@kernel
def _draw_cut(problem: ArcProblem, graph: Graph, random: Array, task: int, leg: int) -> int:
    """Draw a moment: in the task's window, near its own start, or beside a near task."""
    nodes = graph.nodes
    node, draw = nodes[task], draw_below(random, 100)
    start, due = node.end - node.duration, graph.worth[task].due
    if may_miss(problem):
        start, due = min(start, graph.worth[task].until), min(due, graph.worth[task].until)
    if draw < IN_WINDOW:
        latest = due - takes_with(problem, 0, task) if due < NEVER else start + 4 * leg
        return 2 * (node.release + draw_below(random, max(1, latest - node.release)))
    if draw < IN_WINDOW + IN_PLACE:
        return 2 * max(0, start - leg + draw_below(random, 2 * leg + 1))
    return cut_beside_near(problem, graph, random, task, leg, NEVER)


@kernel
def take_out(problem: ArcProblem, search: SearchState, task: int, was: int) -> int:
    """Take a task out of its arcs; note where it was behind `was` others, and count them."""
    graph, trial, ledger, room = search.graph, search.trial, search.ledger, search.candidates
    node, seats = graph.nodes[task], graph.seats
    remember(graph, trial, task)
    for seat in range(node.first, node.first + node.taken):
        tail, head = seats[seat].prev, seats[seat].next
        ledger.then[TRAVEL] -= way_out(problem, graph, seat)
        lead(problem, graph, trial, ledger, tail, head)
        room.was[was] = tail
        was += 1
    node.taken = 0  # nobody is to come from there
    return was


@kernel
def _put_in(problem: ArcProblem, search: SearchState, task: int, cut: int, was: int) -> bool:
    """Put a task into the best arcs that cross a cut; say if there are any."""
    graph, trial, ledger = search.graph, search.trial, search.ledger
    node, seats = graph.nodes[task], graph.seats
    if node.has_links and not keeps_order(problem, graph, task, cut):
        return False
    gather(problem, search, task, cut, was)
    if not choose(problem, search, node.need):
        return False
    node.taken, node.key = search.choice.number[PICKS], cut
    for place in range(node.taken):
        picked = search.choice.pick[place]
        seat, tail = node.first + place, picked.seat
        seats[seat].kind = picked.kind
        head = seats[tail].next
        lead(problem, graph, trial, ledger, tail, seat)
        connect(graph, trial, seat, head)
        ledger.then[TRAVEL] += way_out(problem, graph, seat)
    return True


@kernel
def are_apart(problem: ArcProblem, graph: Graph, members: Array) -> bool:
    """Say whether no robot does two tasks of a group that are linked directly."""
    nodes, seats, latest = graph.nodes, graph.seats, 0
    for task in members:
        if task == NOBODY:
            break
        latest = max(latest, nodes[task].key)
    for task in members:
        if task == NOBODY:
            break
        for first in range(nodes[task].first, nodes[task].first + nodes[task].taken):
            if is_permit(problem, seats[first].kind):
                continue
            other = seats[seats[first].next].node
            seat = seats[first].next
            while other < len(problem.links.group) and nodes[other].key <= latest:
                if problem.links.gap[task, other] > FREE:
                    return False
                seat = seats[seat].next
                other = seats[seat].node
    return True


@kernel
def has_links_apart(problem: ArcProblem, graph: Graph, room: CandidateRoom, seat: int) -> bool:
    """Say whether the robot that leaves a seat does no two tasks on all its way that are linked."""
    nodes, seats, tasks = graph.nodes, graph.seats, len(problem.links.group)
    if is_permit(problem, seats[seat].kind):
        return True
    while seats[seat].node < tasks:
        seat = seats[seat].prev
    room.number[STAMP] += 1
    seat = seats[seat].next
    while nodes[seats[seat].node].key < LAST:
        group = problem.links.group[seats[seat].node]
        if room.met[group] == room.number[STAMP] and _is_linked_before(problem, graph, seat):
            return False
        room.met[group] = room.number[STAMP]
        seat = seats[seat].next
    return True


@kernel
def _is_linked_before(problem: ArcProblem, graph: Graph, seat: int) -> bool:
    """Say whether a robot has done a task before that is linked with the one of a seat."""
    seats, task = graph.seats, graph.seats[seat].node
    seat = seats[seat].prev
    while seats[seat].node < len(problem.links.group):
        if problem.links.gap[task, seats[seat].node] > FREE:
            return True
        seat = seats[seat].prev
    return False
