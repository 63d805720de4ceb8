"""Missions in steps, about: when a task starts, and when those who leave it are at their next one.

A search has millions of changes to time, so that it goes by this. The plans that it finds are timed
exactly, by `planning.step_times`, and what is passed on the way is given to who passes it.

Robots that come from one task are a group: they arrive together, at the pace of the slowest. Groups
that meet pair off, one forming a step. A group whose robots part pays a forming for each further
way, the way of the earlier task first; who goes nowhere any more stays behind.

What takes no time still has to come before what follows, so a time is a step and the place in it:
`TICKS` of these make a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from teamformer.base.kernels.jit import kernel
from teamformer.planning.graph.arc_problem import is_permit
from teamformer.planning.graph.pauses import fitted, is_in_shifts, left_by, united
from teamformer.planning.problem.coalition_problem import NOBODY
from teamformer.planning.problem.constants import TICKS
from teamformer.world.rules.constants import FAR
from teamformer.world.rules.pairing import pair_off

if TYPE_CHECKING:
    from teamformer.planning.graph.arc_problem import ArcProblem
    from teamformer.planning.graph.graph import Graph


@kernel
def start_in_steps(problem: ArcProblem, graph: Graph, task: int, first_seat: int) -> int:
    """Return when a task can start, in ticks, by when the groups are there that come to it.

    If one of the robots is lost before it ends, that is in a step that is FAR: after all that comes
    before it in any case, so that there is no circle.
    """
    nodes, seats, there = graph.nodes, graph.seats, graph.there
    taken, count, room = nodes[task].taken, 0, 0
    for seat in range(first_seat, first_seat + taken):
        tail = seats[seat].prev
        if is_permit(problem, seats[seat].kind):
            room = max(room, graph.comes[tail])
            continue
        is_new, before = True, seat - 1
        while is_new and before >= first_seat:
            is_new = seats[seats[before].prev].node != seats[tail].node
            is_new = is_new or is_permit(problem, seats[before].kind)
            before -= 1
        if is_new:
            place = count
            while place > 0 and there[place - 1] > graph.comes[tail]:
                there[place] = there[place - 1]
                place -= 1
            there[place] = graph.comes[tail]
            count += 1
    if is_in_shifts(problem):
        step = united(problem, graph, first_seat, taken, count)
        step = max(_opens(problem, graph, task), step, room)
        step = fitted(problem, graph, task, first_seat, step * TICKS, nodes[task].duration) // TICKS
    else:
        step = max(_opens(problem, graph, task), pair_off(there, count), room)
    for seat in range(first_seat, first_seat + taken):
        if step + nodes[task].duration // TICKS >= problem.kinds[seats[seat].kind].lost:
            step = max(step, FAR)
    turn = 0
    for seat in range(first_seat, first_seat + taken):
        node = seats[seats[seat].prev].node
        is_task = node < len(problem.near)
        if is_task and (nodes[node].end - nodes[node].duration) // TICKS == step:
            turn = max(turn, nodes[node].end % TICKS + 1)
    return step * TICKS + turn


@kernel
def plan_ways(problem: ArcProblem, graph: Graph, node: int) -> int:
    """Work out when groups that leave a node are at their next ones; return how many ways it has.

    `graph.ways` has them, and one for those who stay, if anybody does.
    """
    ways, record, count = graph.ways, graph.nodes[node], 0
    for seat in range(record.first, record.first + record.taken):
        if is_permit(problem, graph.seats[seat].kind):
            continue
        to = graph.seats[graph.seats[seat].next].node
        pace = problem.kinds[graph.seats[seat].kind].pace
        way = find_way(graph, to, count)
        if way == count:
            ways[way].to, ways[way].key, ways[way].pace = to, graph.nodes[to].key, pace
            count += 1
        ways[way].pace = problem.together[ways[way].pace, pace]
    free = record.end // TICKS
    for way in range(count):
        turn = 1
        for other in range(count):
            is_first = ways[other].key < ways[way].key
            is_first |= ways[other].key == ways[way].key and ways[other].to < ways[way].to
            turn += is_first
        leaves = free + min(turn, count - 1) * problem.forming[0]
        ways[way].comes = _walked(problem, graph, node, way, leaves)
    return count


@kernel
def comes_from(problem: ArcProblem, graph: Graph, seat: int, count: int) -> int:
    """Return when who leaves a seat is at its next one, by its node's ways; permits at once."""
    if is_permit(problem, graph.seats[seat].kind):
        return graph.nodes[graph.seats[seat].node].end // TICKS
    return graph.ways[find_way(graph, graph.seats[graph.seats[seat].next].node, count)].comes


@kernel
def _walked(problem: ArcProblem, graph: Graph, node: int, way: int, leaves: int) -> int:
    """Return when a group is there, with what it serves on its way; nobody walks home."""
    to, pace, delay = graph.ways[way].to, graph.ways[way].pace, 0
    if to >= problem.ways.shape[1]:
        return leaves
    if len(problem.passes) > 0:
        nodes, index = graph.nodes, node * len(problem.near) + to
        for place in range(problem.passed[index], problem.passed[index + 1]):
            other = problem.passes[place]
            there = delay + problem.ways[pace, node, other] // TICKS
            there = left_by(problem, graph, node, to, leaves, there)
            start = (nodes[other].end - nodes[other].duration) // TICKS
            is_open = _opens(problem, graph, other) <= there + 1
            if is_open and there < start and _can_do(problem, graph, node, to, nodes[other].need):
                delay += nodes[other].duration // TICKS
    there = delay + problem.ways[pace, node, to] // TICKS
    return left_by(problem, graph, node, to, leaves, there)


@kernel
def _opens(problem: ArcProblem, graph: Graph, task: int) -> int:
    """Return the first step in which a task may start."""
    opens = graph.nodes[task].release // TICKS
    if graph.nodes[task].has_links:
        for other in problem.before[task]:
            if other == NOBODY:
                break
            opens = max(opens, graph.nodes[other].end // TICKS + 1)
    return opens


@kernel
def find_way(graph: Graph, to: int, count: int) -> int:
    """Return which of the first ways leads to a node; `count` if none does."""
    way = 0
    while way < count and graph.ways[way].to != to:
        way += 1
    return way


@kernel
def _can_do(problem: ArcProblem, graph: Graph, node: int, to: int, need: int) -> bool:
    """Say whether the robots that go from a node to another cover a need."""
    first, taken = graph.nodes[node].first, graph.nodes[node].taken
    for cap in range(problem.needs.shape[1]):
        lacking = problem.needs[need, cap]
        if lacking > 0:
            for seat in range(first, first + taken):
                if graph.seats[graph.seats[seat].next].node == to:
                    kind = graph.seats[seat].kind
                    lacking -= problem.counts[problem.kinds[kind].type, cap]
            if lacking > 0:
                return False
    return True
