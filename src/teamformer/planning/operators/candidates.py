"""Who could come to a task at a moment, and what each of them would cost."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Floats, Ints
from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import ArcProblem, Records, takes_with
from teamformer.planning.graph.arriving import arrive
from teamformer.planning.graph.graph import Graph
from teamformer.planning.operators.coalition_choice import (
    PICKS,
    drop_spare,
    is_lacking,
    take,
    want,
)
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.links import HOME, MAKESPAN, MAX_TARDINESS, TARDINESS, TRAVEL
from teamformer.world.rules.chance import SLACKS, STEPS, draw_below
from teamformer.world.rules.coverage import helps

if TYPE_CHECKING:
    from teamformer.planning.operators.state import SearchState

BLINK = 12
"""Every so many arcs one is overlooked, so that the search does not always see the same."""

ELSEWHERE = 50  # percent
"""How often a task that is taken out must not go back to where it was."""

DEPOTS = 24
"""How many robots are looked at that might begin with the task."""

MOST_CANDIDATES = 256

CANDIDATE = np.dtype([("seat", np.int64), ("kind", np.int64), ("cost", np.float64)])

FOUND, STAMP = range(2)


class CandidateRoom(NamedTuple):
    """Room to choose a coalition in by what each of its robots costs."""

    number: Ints  # (2,) arcs found, and what arcs that were seen are marked with
    found: Records  # CANDIDATE
    seen: Ints  # (seats,)
    was: Ints  # (seats of a group,) the seats that came before a task
    met: Ints  # (groups,)
    slacks: Ints  # how much more an arc is taken to cost, in 1024ths of the heat
    heat: Floats  # (1,)


def empty_candidates(problem: ArcProblem, seats: int) -> CandidateRoom:
    """Return room for a graph with so many seats."""
    most = int(problem.most[0])
    return CandidateRoom(
        number=np.zeros(2, np.int64),
        found=np.zeros(MOST_CANDIDATES, CANDIDATE).view(np.recarray),
        seen=np.zeros(seats, np.int64),
        was=np.zeros(most * problem.links.members.shape[1], np.int64),
        met=np.zeros(len(problem.links.members), np.int64),
        slacks=SLACKS,
        heat=np.zeros(1),
    )


@kernel
def gather(problem: ArcProblem, search: SearchState, task: int, cut: int, was: int) -> None:
    """Gather arcs that cross a cut: at near tasks, at depots, and `was` of those where it was."""
    graph, room, random = search.graph, search.candidates, search.random
    nodes, seats = graph.nodes, graph.seats
    room.number[FOUND] = 0
    room.number[STAMP] += 1
    is_elsewhere = draw_below(random, 100) < ELSEWHERE
    for index in range(was):
        if is_elsewhere:
            room.seen[room.was[index]] = room.number[STAMP]
        _consider(problem, search, task, cut, room.was[index])
    for other in problem.near[task]:
        node = nodes[other]
        is_before = node.key < cut
        for seat in range(node.first, node.first + node.taken):
            tail = seat if is_before else seats[seat].prev
            _consider(problem, search, task, cut, tail)
    robots = len(graph.back)
    robot = draw_below(random, robots)
    for _ in range(min(robots, DEPOTS)):
        robot = robot + 1 if robot + 1 < robots else 0
        tail = len(seats) - 2 * robots + problem.mixed[robot]
        _consider(problem, search, task, cut, tail)


@kernel
def _consider(problem: ArcProblem, search: SearchState, task: int, cut: int, tail: int) -> None:
    """Note an arc and about what it would cost to lead it by the task, if it is of use."""
    graph, room, random = search.graph, search.candidates, search.random
    nodes, seats, number = graph.nodes, graph.seats, room.number
    if room.seen[tail] == number[STAMP]:
        return
    room.seen[tail] = number[STAMP]
    head, kind, place = seats[tail].next, seats[tail].kind, seats[tail].node
    if place < len(problem.near) and tail >= nodes[place].first + nodes[place].taken:
        return  # the task is out, and so is the seat where another of its group was
    to = seats[head].node
    if not nodes[place].key < cut < nodes[to].key or number[FOUND] == MOST_CANDIDATES:
        return
    if problem.useful[nodes[task].need, problem.kinds[kind].type] == 0:
        return
    if draw_below(random, BLINK) == 0:
        return
    found = room.found[number[FOUND]]
    found.seat, found.kind = tail, kind
    noise = room.heat[0] * room.slacks[draw_below(random, len(room.slacks))] / STEPS
    found.cost = _cost_of(problem, graph, task, tail, to) + noise
    number[FOUND] += 1


@kernel
def _cost_of(problem: ArcProblem, graph: Graph, task: int, tail: int, to: int) -> float:
    """Return about what it costs that a robot on its way from a seat to a place does a task.

    That is its detour, how late the task would be and, after it, the next one.
    """
    place, kind = graph.seats[tail].node, graph.seats[tail].kind
    node, weight, pace = graph.nodes[task], problem.links.weight, problem.kinds[kind].pace
    way = problem.ways_to[pace, task, place]
    comes, _, _ = arrive(problem, graph, kind, tail, task)
    end = max(comes, node.release) + takes_with(problem, pace, task)
    late, push = max(0, end - graph.worth[task].due), 0
    if to >= problem.ways.shape[1]:
        detour = way + problem.home[kind, task] - problem.home[kind, place]
    else:
        after = graph.nodes[to]
        on = problem.ways[pace, task, to]
        detour = way + on - problem.ways[pace, place, to]
        push = max(0, end + on - (after.end - after.duration))
        due = graph.worth[to].due
        late += max(0, after.end + push - due) - max(0, after.end - due)
    waits = (weight[MAKESPAN] + weight[HOME]) * (end + push)
    return weight[TRAVEL] * detour + (weight[TARDINESS] + weight[MAX_TARDINESS]) * late + waits


@kernel
def choose(problem: ArcProblem, search: SearchState, need: int) -> bool:
    """Pick arcs until a need is covered, the cheapest that helps each time; say if it is."""
    room, choice = search.candidates, search.choice
    want(problem, choice, need)
    while is_lacking(choice):
        best, least = NOBODY, np.inf
        for index in range(room.number[FOUND]):
            found = room.found[index]
            which = problem.kinds[found.kind].type
            if found.cost < least and helps(problem.counts[which], choice.lacking):
                best, least = index, found.cost
        if best == NOBODY or choice.number[PICKS] == problem.most[0] + 1:
            return False
        found, pick = room.found[best], choice.pick[choice.number[PICKS]]
        pick.seat, pick.kind = found.seat, found.kind
        take(problem, choice, problem.kinds[found.kind].type)
        found.cost = np.inf  # it is picked
    drop_spare(problem, choice)
    return bool(choice.number[PICKS] <= problem.most[0])
