"""Two robots exchange all that they do from a place on, of one kind or, if plans cost, of two."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.array_types import Array
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ArcProblem, is_weighed
from teamformer.planning.graph.changes import COMES_BY, KIND, LEAVES_BY, record
from teamformer.planning.graph.graph import Graph, leave
from teamformer.planning.graph.ledger import lead, way_out
from teamformer.planning.graph.worth import is_left_out
from teamformer.planning.operators.coalition_choice import THIS_ONE
from teamformer.planning.operators.draws import draw_near
from teamformer.planning.operators.group_moves import has_links_apart
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.links import TRAVEL
from teamformer.world.rules.chance import draw_below

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState


@kernel
def exchange_rests(
    problem: ArcProblem, search: SearchState, task: int, leg: int, limit: int
) -> bool:
    """Lead an arc from a task to one near it, or from there; say if the robots can all that.

    The rest of the one robot's way is then the other's. Robots of different speeds do not exchange.
    Where the makespan counts robots are of one kind, and no chain is too long then.
    """
    graph, trial, ledger = search.graph, search.trial, search.ledger
    nodes, seats = graph.nodes, graph.seats
    other = draw_near(problem, search.random, task)
    if nodes[other].key == nodes[task].key:
        return False
    mine, theirs = _draw_seats(problem, search, task, other)
    if theirs == NOBODY:
        return False
    is_before = nodes[task].key < nodes[other].key
    tail, head = (mine, theirs) if is_before else (theirs, mine)
    end, begin = seats[tail].next, seats[head].prev
    if end == head or nodes[seats[begin].node].key >= nodes[seats[end].node].key:
        return False
    if _chain(problem, graph, tail, head) > limit or _chain(problem, graph, begin, end) > limit:
        return False
    one, two, home_of_one, home_of_two = seats[tail].kind, seats[begin].kind, end, end
    if one != two:
        if problem.kinds[one].pace != problem.kinds[two].pace:
            return False
        if not _can_do(problem, graph, head, one, two) or not _can_do(
            problem, graph, end, two, one
        ):
            return False
        last_of_one, last_of_two = _last(problem, graph, tail), _last(problem, graph, head)
        home_of_one, home_of_two = seats[last_of_one].next, seats[last_of_two].next
    lead(problem, graph, trial, ledger, tail, head)
    lead(problem, graph, trial, ledger, begin, end)
    if one != two:
        _change_kinds(problem, search, head, one)
        _change_kinds(problem, search, end, two)
        last_of_one, last_of_two = _last(problem, graph, tail), _last(problem, graph, begin)
        lead(problem, graph, trial, ledger, last_of_one, home_of_one)
        lead(problem, graph, trial, ledger, last_of_two, home_of_two)
    if problem.links.members.shape[1] <= 2:  # nothing is linked
        return True
    is_apart = has_links_apart(problem, graph, search.candidates, tail)
    return is_apart and has_links_apart(problem, graph, search.candidates, begin)


@kernel
def _draw_seats(problem: ArcProblem, search: SearchState, task: int, other: int) -> tuple[int, int]:
    """Draw a seat of each of two tasks; the second is NOBODY if none there is of use."""
    graph, trial, random = search.graph, search.trial, search.random
    nodes, most = graph.nodes, problem.most[0]
    if is_weighed(problem):
        if is_left_out(problem, graph, other):
            return NOBODY, NOBODY
        mine = nodes[task].first + draw_below(random, nodes[task].taken)
        return mine, nodes[other].first + draw_below(random, nodes[other].taken)
    mine = trial.number[LEAVES_BY if nodes[task].key < nodes[other].key else COMES_BY]
    if mine == NOBODY or draw_below(random, 100) >= THIS_ONE:
        mine = task * most + draw_below(random, nodes[task].taken)
    return mine, _draw_alike(graph, random, other, most, graph.seats[mine].kind)


@kernel
def _chain(problem: ArcProblem, graph: Graph, tail: int, head: int) -> int:
    """Return the longest chain along an arc that is not there yet."""
    place, kind = graph.seats[tail].node, graph.seats[tail].kind
    return graph.nodes[place].end + leave(problem, graph, kind, place, head)


@kernel
def _draw_alike(graph: Graph, random: Array, task: int, most: int, kind: int) -> int:
    """Draw a seat of a task that has a kind; NOBODY if there is none."""
    drawn, count = NOBODY, 0
    for seat in range(task * most, task * most + graph.nodes[task].taken):
        if graph.seats[seat].kind == kind:
            count += 1
            if count == 1 or draw_below(random, count) == 0:
                drawn = seat
    return drawn


@kernel
def _can_do(problem: ArcProblem, graph: Graph, seat: int, kind: int, instead: int) -> bool:
    """Say whether a robot of a kind can do all from a seat on, instead of one of another kind."""
    tasks = len(problem.near)
    mine, theirs = problem.kinds[kind].type, problem.kinds[instead].type
    if mine == theirs:
        return True
    while graph.seats[seat].node < tasks:
        node = graph.nodes[graph.seats[seat].node]
        for cap in range(problem.needs.shape[1]):
            has = problem.counts[mine, cap] - problem.counts[theirs, cap]
            lacking = problem.needs[node.need, cap]
            if lacking > 0 and has < 0:
                for other in range(node.first, node.first + node.taken):
                    has += problem.counts[problem.kinds[graph.seats[other].kind].type, cap]
                if has < lacking:
                    return False
        seat = graph.seats[seat].next
    return True


@kernel
def _last(problem: ArcProblem, graph: Graph, seat: int) -> int:
    """Return the last seat of a robot's way before it goes home."""
    places = problem.ways.shape[1]
    while graph.seats[graph.seats[seat].next].node < places:
        seat = graph.seats[seat].next
    return seat


@kernel
def _change_kinds(problem: ArcProblem, search: SearchState, seat: int, kind: int) -> None:
    """Let all seats from one on be taken by a robot of another kind, but for the home."""
    graph, trial, ledger = search.graph, search.trial, search.ledger
    tasks = len(problem.near)
    while graph.seats[seat].node < tasks:
        ledger.then[TRAVEL] -= way_out(problem, graph, seat)
        record(trial, KIND, seat, graph.seats[seat].kind)
        graph.seats[seat].kind = kind
        ledger.then[TRAVEL] += way_out(problem, graph, seat)
        seat = graph.seats[seat].next
