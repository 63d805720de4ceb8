"""A plan as a graph: every task has seats, and arcs lead from seat to seat.

Robots of a kind are alike, so a plan need not say who goes where: each seat of a task is taken by
some robot of a kind, which comes along one arc, from a depot or another task, and leaves along
another, to another task or home. Routes are read off at the end by following the arcs.

Start times are the order of the graph. A task's key is twice its start and one more; depots come
before all keys, homes after. Every arc leads from a lower to a higher key, so there is no circle.

Missions in continuous time and missions in steps differ in when a task starts and when those who
leave it are at their next one: `approximate_steps` has that for the latter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from teamformer.base.array_types import Int32s, Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.graph.approximate_steps import comes_from, plan_ways, start_in_steps
from teamformer.planning.graph.arc_problem import (
    ArcProblem,
    Records,
    StepRules,
    different_needs,
    is_permit,
    least_durations,
    may_miss,
    most_seats,
    takes_with,
)
from teamformer.planning.graph.arriving import arrive, arrive_home, left_after
from teamformer.planning.graph.charging import is_charged
from teamformer.planning.graph.pauses import fitted
from teamformer.planning.graph.worth import (
    WORTH,
    counted_end,
    is_left_out,
    missed,
    missed_leads,
    priced,
)
from teamformer.planning.problem.batteries import are_charged
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.constants import SPREAD, TICKS
from teamformer.planning.problem.misses import LEFT_OUT, can_miss
from teamformer.world.rules.constants import FAR

if TYPE_CHECKING:
    from teamformer.base.array_types import Array

NODE = np.dtype(
    [
        ("end", np.int64),  # when the task ends; of depots when robots can leave them
        ("key", np.int64),
        ("tail", np.int64),  # the longest chain of work and ways from its start to the end of all
        ("duration", np.int64),  # with the coalition that it has
        ("release", np.int64),
        ("first", np.int32),  # of its seats
        ("taken", np.int32),  # how many of its seats are
        ("need", np.int32),  # which of the different needs
        ("is_waiting", np.int32),  # whether it is on the agenda: 0, or what is to be worked out
        ("has_links", np.int32),  # whether it comes before or after other tasks
        ("is_load", np.int32),  # whether it takes longer with some robots than with others
    ],
    align=True,
)
"""64 bytes; what is asked less often is in `WORTH`."""

SEAT = np.dtype([("prev", np.int32), ("next", np.int32), ("node", np.int32), ("kind", np.int32)])

WAY = np.dtype([("to", np.int64), ("key", np.int64), ("pace", np.int64), ("comes", np.int64)])

FIRST, LAST = -1, NEVER
"""The keys of depots and homes."""

MAKESPAN, COST, BACK_SUM, PRICE, LATEST, END_SUM, AIM, MISSED, LEADS = range(9)
"""What is known of a graph as a whole; LATEST is the home that is reached last, PRICE what it costs
when tasks end, MISSED and LEADS what it costs that they end too late, in AIM and in COST. Plans are
judged by AIM; COST also has what leads a search."""


class Graph(NamedTuple):
    """A plan with its times. Seats are those of the tasks, then depots, then homes."""

    nodes: Records  # (places + 1,) NODE: tasks, depots by place, and one for all homes
    seats: Records  # (tasks * most + 2 * robots,) SEAT
    back: Ints  # (robots,) when each home is reached
    total: Ints  # (9,)
    comes: Ints  # (seats,) in steps: when who leaves a seat is at the next; empty in other time
    order: Int32s  # (tasks,) in steps: the tasks by their keys, when all was timed
    ways: Records  # (seats of a node,) WAY, room for the ways that lead from a node
    there: Ints  # (seats of a node,) room for the steps in which groups are there
    worth: Records  # (tasks,) WORTH
    left: Ints  # (seats,) what who leaves a seat has in its battery; empty if nobody has one
    detour: Ints  # (seats,) by how much the way to a seat is longer as its robot charges; the same
    came: Ints  # (seats, 3) when its robot is there, what it has left then, by how much it goes
    # round: as found when the start of its task was last worked out; the same
    together: Int32s  # (seats of a node,) room for the kinds of those whose shifts are looked at


def empty_graph(problem: CoalitionProblem, steps: StepRules | None = None) -> Graph:
    """Return a graph without arcs."""
    tasks, places, robots = len(problem.needs), problem.ways.shape[1], len(problem.counts)
    nodes = np.zeros(places + 1, NODE).view(np.recarray)
    nodes.key[tasks:places] = FIRST
    nodes.end[tasks:places] = problem.ready
    nodes.key[places:] = LAST
    worth = np.zeros(tasks, WORTH).view(np.recarray)
    worth.until[:] = NEVER
    if can_miss(problem.misses):
        worth.until[:] = problem.misses.until
        worth.miss[:], worth.leads[:] = problem.misses.judged, problem.misses.leads
        worth.is_optional[:] = problem.misses.optional
    nodes.duration[:tasks] = least_durations(problem, steps)
    nodes.is_load[:tasks] = problem.slower.any(axis=0)
    nodes.release[:tasks], worth.due[:] = problem.release, problem.due
    if steps is not None and len(steps.prices.due) > 0:
        worth.due[:] = np.minimum(steps.prices.due, FAR) * TICKS
        worth.price[:], worth.late_price[:] = steps.prices.ends, steps.prices.late
    nodes.need[:tasks] = different_needs(problem)[1]
    linked = (problem.before[:, 0] != NOBODY) | (problem.after[:, 0] != NOBODY)
    nodes.has_links[:tasks] = linked
    most = most_seats(problem)
    nodes.first[:tasks] = np.arange(tasks) * most
    nodes.end[tasks:places] = problem.ready
    if steps is not None:
        nodes.taken[tasks:places] = np.bincount(problem.origin - tasks)
        nodes.first[tasks:places] = tasks * most + np.searchsorted(
            problem.origin, np.arange(tasks, places)
        )
    seats = np.zeros(tasks * most + 2 * robots, SEAT).view(np.recarray)
    seats.node[: tasks * most] = np.repeat(np.arange(tasks), most)
    seats.node[tasks * most : tasks * most + robots] = problem.origin
    seats.node[tasks * most + robots :] = places
    seats.kind[tasks * most :] = np.tile(problem.kind, 2)
    charged = len(seats) if are_charged(problem.batteries) else 0
    widest = max(most, int(nodes.taken.max(initial=0))) + 1
    return Graph(
        nodes,
        seats,
        back=np.zeros(robots, np.int64),
        total=np.zeros(9, np.int64),
        comes=np.zeros(0 if steps is None else len(seats), np.int64),
        order=np.arange(tasks, dtype=np.int32),
        ways=np.zeros(widest, WAY).view(np.recarray),
        there=np.zeros(widest, np.int64),
        worth=worth,
        left=np.zeros(charged, np.int64),
        detour=np.zeros(charged, np.int64),
        came=np.zeros((charged, 3), np.int64),
        together=np.zeros(widest, np.int32),
    )


@kernel
def is_in_steps(graph: Graph) -> bool:
    """Say whether a graph is of a mission in steps."""
    return len(graph.comes) > 0


@kernel
def start_of(problem: ArcProblem, graph: Graph, task: int, first_seat: int) -> int:
    """Return when a task can start, by when those are free that come to it."""
    node = graph.nodes[task]
    if is_left_out(problem, graph, task):
        return LEFT_OUT
    if is_in_steps(graph):
        return start_in_steps(problem, graph, task, first_seat)
    there, room, comes_apart, first_site = 0, 0, False, NOBODY
    for seat in range(first_seat, first_seat + node.taken):
        tail, kind = graph.seats[seat].prev, graph.seats[seat].kind
        place = graph.seats[tail].node
        if is_permit(problem, kind):
            room = max(room, graph.nodes[place].end)
            continue
        comes, left, detour = arrive(problem, graph, kind, tail, task)
        if is_charged(problem):
            graph.came[seat, 0], graph.came[seat, 1], graph.came[seat, 2] = comes, left, detour
        there = max(there, comes)
        first_site = problem.site[place] if first_site == NOBODY else first_site
        comes_apart |= problem.site[place] != first_site
    if comes_apart and problem.forming[0] > 0:
        there = fitted(problem, graph, task, first_seat, there, problem.forming[0])
        there += problem.forming[0]
    start = max(node.release, there, room)
    if node.has_links:
        for other in problem.before[task]:
            if other == NOBODY:
                break
            start = max(start, graph.nodes[other].end)
    return fitted(problem, graph, task, first_seat, start, node.duration)


@kernel
def takes(problem: ArcProblem, graph: Graph, task: int) -> int:
    """Return how long a load takes with its coalition: it goes as fast as the slowest."""
    node = graph.nodes[task]
    if is_left_out(problem, graph, task):
        return node.duration
    pace, longest = problem.kinds[graph.seats[node.first].kind].pace, 0
    for seat in range(node.first, node.first + node.taken):
        own = problem.kinds[graph.seats[seat].kind].pace
        pace = problem.together[pace, own] if is_in_steps(graph) else own
        longest = max(longest, takes_with(problem, pace, task))
    return longest


@kernel
def leave(problem: ArcProblem, graph: Graph, kind: int, place: int, seat: int) -> int:
    """Return the longest chain of a robot of a kind that leaves a place for a seat, or home."""
    node = graph.seats[seat].node
    if node >= problem.ways.shape[1]:
        return problem.home[kind, place]
    return problem.ways[problem.kinds[kind].pace, place, node] + graph.nodes[node].tail


@kernel
def tail_of(problem: ArcProblem, graph: Graph, task: int, first_seat: int) -> int:
    """Return the longest chain from the start of a task to the end of all.

    Forming on the way is not counted: who else comes from where may change. Nobody waits for a task
    that is left out, so it has none.
    """
    if is_left_out(problem, graph, task):
        return 0
    node, longest = graph.nodes[task], 0
    for seat in range(first_seat, first_seat + node.taken):
        record = graph.seats[seat]
        longest = max(longest, leave(problem, graph, record.kind, task, record.next))
    if node.has_links:
        for other in problem.after[task]:
            if other == NOBODY:
                break
            longest = max(longest, graph.nodes[other].tail)
    return node.duration + longest


@kernel
def back_of(problem: ArcProblem, graph: Graph, robot: int) -> int:
    """Return when a home is reached."""
    back, _, _ = arrive_home(problem, graph, len(graph.seats) - len(graph.back) + robot)
    return back


@kernel
def weigh_totals(problem: ArcProblem, graph: Graph, total: Ints) -> None:
    """Write what a plan is judged by, and what a search goes by, from all else that is known.

    Plans of one aim cost less if all is over early. In steps it does not count for the aim which
    task of a step has its turn first.
    """
    makespan, leads, weights = total[MAKESPAN], total[LEADS], problem.weights
    total[AIM] = weights[0] * makespan + total[PRICE] + total[MISSED]
    if is_in_steps(graph):
        total[AIM] -= weights[0] * (makespan % TICKS)
        cost = weights[0] * makespan + weights[1] * total[END_SUM] + total[PRICE]
        total[COST] = cost // weights[2] + leads
        return
    counted = counted_makespan(problem, graph, makespan, leads)
    total[COST] = counted + total[BACK_SUM] // (SPREAD * len(graph.back)) + leads


@kernel
def last_home(graph: Graph) -> int:
    """Return the home that is reached last, the first of equals."""
    latest = 0
    for robot in range(len(graph.back)):
        if graph.back[robot] > graph.back[latest]:
            latest = robot
    return latest


@kernel
def counted_makespan(problem: ArcProblem, graph: Graph, makespan: int, leads: int) -> int:
    """Return when all is over: if something is missed, at the end of the mission at the earliest.

    `leads` is what it takes missed tasks to cost. In steps, where the makespan may have a price, it
    stays as it is.
    """
    if may_miss(problem) and leads > 0 and not is_in_steps(graph):
        return max(makespan, graph.worth[0].until)
    return makespan


@entry
def lay(problem: ArcProblem, graph: Graph, plan: CoalitionPlan, at: Array) -> None:
    """Lay a plan out as a graph, with all times; `at` is room for the last seat of each robot."""
    nodes, seats, tasks, robots = graph.nodes, graph.seats, len(problem.near), len(graph.back)
    most = problem.most[0]
    for robot in range(robots):
        at[robot] = tasks * most + robot
    for position in range(tasks):
        task = plan.order[position]
        nodes[task].taken, nodes[task].key = plan.size[task], 2 * position + 1
        for index in range(plan.size[task]):
            robot, seat = plan.coalition[task, index], task * most + index
            seats[seat].kind = problem.kind[robot]
            seats[seat].prev, seats[at[robot]].next = at[robot], seat
            at[robot] = seat
    for robot in range(robots):
        home = tasks * most + robots + robot
        seats[home].prev, seats[at[robot]].next = at[robot], home
    time_anew(problem, graph)
    if len(problem.passes) > 0:
        time_anew(problem, graph)  # now that it is known what is still to be done when


@kernel
def time_anew(problem: ArcProblem, graph: Graph) -> None:
    """Work out all times of a graph, and the order of its tasks, from the order that it has."""
    nodes, order, tasks = graph.nodes, graph.order, len(problem.near)
    for index in range(tasks):
        task, gap = order[index], index
        while gap > 0 and nodes[order[gap - 1]].key > nodes[task].key:
            order[gap] = order[gap - 1]
            gap -= 1
        order[gap] = task
    for depot in range(tasks, problem.ways.shape[1]):
        _send(problem, graph, depot)
    for seat in range(len(graph.detour)):
        graph.detour[seat] = 0
    for robot in range(len(problem.batteries.left)):
        graph.left[tasks * problem.most[0] + robot] = problem.batteries.left[robot]
    for task in order:
        if nodes[task].is_load:
            nodes[task].duration = takes(problem, graph, task)
        start = start_of(problem, graph, task, nodes[task].first)
        nodes[task].end, nodes[task].key = start + nodes[task].duration, 2 * start + 1
        if is_charged(problem):
            for seat in range(nodes[task].first, nodes[task].first + nodes[task].taken):
                graph.left[seat], graph.detour[seat] = left_after(problem, graph, seat, start)
        _send(problem, graph, task)
    for robot in range(len(graph.back)):
        graph.back[robot] = back_of(problem, graph, robot)
    for index in range(tasks - 1, -1, -1):
        nodes[order[index]].tail = tail_of(problem, graph, order[index], nodes[order[index]].first)
    sum_up(problem, graph)


@kernel
def _send(problem: ArcProblem, graph: Graph, node: int) -> None:
    """Note, in steps, when those who leave a node are at their next ones."""
    if is_in_steps(graph):
        count, record = plan_ways(problem, graph, node), graph.nodes[node]
        for seat in range(record.first, record.first + record.taken):
            graph.comes[seat] = comes_from(problem, graph, seat, count)


@kernel
def sum_up(problem: ArcProblem, graph: Graph) -> None:
    """Work out the makespan and the cost of a graph whose times are known."""
    total = graph.total
    for part in range(len(total)):
        total[part] = 0
    for robot in range(len(graph.back)):
        total[BACK_SUM] += graph.back[robot]
    for task in range(len(problem.near)):
        worth, end = graph.worth[task], graph.nodes[task].end
        total[END_SUM] += counted_end(problem, worth, end)
        total[PRICE] += priced(problem, worth, end)
        total[MISSED] += missed(problem, worth, end)
        total[LEADS] += missed_leads(problem, worth, end)
    total[LATEST] = last_home(graph)
    total[MAKESPAN] = graph.back[total[LATEST]]
    weigh_totals(problem, graph, total)


def plan_of(problem: CoalitionProblem, arcs: ArcProblem, graph: Graph) -> CoalitionPlan:
    """Return the plan that a graph is."""
    plan = empty_plan(problem)
    read_off(arcs, graph, plan)
    plan.order[:] = np.argsort(graph.nodes.key[: len(plan.order)], kind="stable")
    return plan


@entry
def read_off(problem: ArcProblem, graph: Graph, plan: CoalitionPlan) -> None:
    """Follow the arcs, and write down who does what; the order of tasks is left to the caller."""
    seats, tasks = graph.seats, len(problem.near)
    most = problem.most[0]
    for task in range(tasks):
        plan.size[task] = 0
    for robot in range(len(graph.back)):
        seat = seats[tasks * most + robot].next
        while seat < tasks * most:
            task = seats[seat].node
            plan.coalition[task, plan.size[task]] = robot
            plan.size[task] += 1
            seat = seats[seat].next
