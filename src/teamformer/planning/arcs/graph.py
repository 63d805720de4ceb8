"""A plan as a graph: every task has seats, and arcs lead from seat to seat.

Robots of a kind are alike, so a plan need not say who goes where: each seat of a task is taken by
some robot of a kind, which comes along one arc, from a depot or another task, and leaves along
another, to another task or home. Routes are read off at the end by following the arcs.

Start times are the order of the graph. A task's key is twice its start and one more; depots come
before all keys, homes after. Every arc leads from a lower to a higher key, so there is no circle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.jit import entry, kernel
from teamformer.planning.arcs.covers import list_covers
from teamformer.planning.arcs.near import near_tasks
from teamformer.planning.coalitions.problem import NEVER, NOBODY, CoalitionProblem, Ticks, Whole
from teamformer.planning.coalitions.search.schedule import LATENESS, SPREAD, CoalitionPlan

if TYPE_CHECKING:
    from teamformer.rules.arrays import Array

Records = np.recarray[Any, np.dtype[np.void]]

KIND = np.dtype([("pace", np.int32), ("type", np.int32)])
NODE = np.dtype(
    [
        ("end", np.int64),  # when the task ends; 0 for depots
        ("key", np.int64),
        ("tail", np.int64),  # the longest chain of work and ways from its start to the end of all
        ("duration", np.int64),
        ("release", np.int64),
        ("due", np.int64),
        ("taken", np.int32),  # how many of its seats are
        ("need", np.int32),  # which of the different needs
        ("is_waiting", np.int32),  # whether it is on the agenda
        ("has_links", np.int32),  # whether it comes before or after other tasks
    ]
)
SEAT = np.dtype([("prev", np.int32), ("next", np.int32), ("node", np.int32), ("kind", np.int32)])

FIRST, LAST = -1, NEVER
"""The keys of depots and homes."""

FEWEST_NEAR, MOST_NEAR, NEAR_SHARE = 14, 40, 7
"""How many tasks are near to each: every seventh within these limits."""

MAKESPAN, COST, BACK_SUM, LATE, LATEST = range(5)
"""What is known of a graph as a whole; LATEST is the home that is reached last."""


class ArcProblem(NamedTuple):
    """What does not change: the places, the kinds of robots, who covers what."""

    ways: Ticks  # (paces, places, tasks)
    home: Ticks  # (kinds, places)
    site: Whole  # (places,) the same number for places that lie at the same position
    kinds: Records  # (kinds,) KIND
    origin: Whole  # (robots,) the place where each starts
    kind: Whole  # (robots,)
    mixed: Whole  # (robots,) all robots, those of a kind far from each other
    counts: Whole  # (types, caps) what robots of each type bring
    needs: Whole  # (needs, caps) the different needs
    useful: Whole  # (needs, types) how many of a type a coalition has at most
    covers: Whole  # (needs, covers, width, 2) types and how many of each, then NOBODY
    listed: Whole  # (needs,) how many covers are listed; 0 if there are too many
    near: Whole  # (tasks, near) the tasks nearest to each
    before: Whole  # (tasks, most) the tasks that must have ended before each, then NOBODY
    after: Whole  # (tasks, most) the tasks that each must have ended before, then NOBODY
    forming: Ticks  # (1,)
    most: Ticks  # (1,) seats of each task


class Graph(NamedTuple):
    """A plan with its times. Seats are those of the tasks, then depots, then homes."""

    nodes: Records  # (places + 1,) NODE: tasks, depots by place, and one for all homes
    seats: Records  # (tasks * most + 2 * robots,) SEAT
    back: Ticks  # (robots,) when each home is reached
    total: Ticks  # (5,)


def near_of(tasks: int) -> int:
    """Return how many tasks are near to each of so many."""
    return min(tasks - 1, max(FEWEST_NEAR, min(MOST_NEAR, tasks // NEAR_SHARE)))


def pose_arcs(problem: CoalitionProblem, near: int) -> ArcProblem:
    """Return a coalition problem as one of arcs; `near` tasks are near to each.

    Robots are of a type if they bring the same; of a kind if they are as fast and go home to the
    same place, too.
    """
    asked = problem.needs.max(axis=0, initial=0) > 0
    _, first = np.unique(problem.kind, return_index=True)
    brings = problem.counts[first][:, asked]  # (kinds, caps)
    counts, kind_type = np.unique(brings, axis=0, return_inverse=True)
    kinds = np.zeros(len(first), KIND).view(np.recarray)
    kinds.pace, kinds.type = problem.pace[first], kind_type.ravel()
    needs, _ = _different_needs(problem)
    number = np.bincount(kind_type.ravel()[problem.kind], minlength=len(counts)).astype(np.int32)
    useful, covers, listed = list_covers(counts, number, needs)
    return ArcProblem(
        ways=problem.ways,
        home=problem.home,
        site=problem.site,
        kinds=kinds,
        origin=problem.origin,
        kind=problem.kind,
        mixed=_mixed(problem),
        counts=np.ascontiguousarray(counts, np.int32),
        needs=needs,
        useful=useful,
        covers=covers,
        listed=listed,
        near=near_tasks(problem.ways[0], near),
        before=problem.before,
        after=problem.after,
        forming=problem.forming,
        most=np.array([most_seats(problem)]),
    )


def _mixed(problem: CoalitionProblem) -> Whole:
    """Return the first robots of all kinds, then the second ones, and so on."""
    columns = problem.like.T.ravel()
    return columns[columns != NOBODY]


def _different_needs(problem: CoalitionProblem) -> tuple[Whole, npt.NDArray[np.intp]]:
    """Return the different needs, and which of them each task has."""
    asked = problem.needs.max(axis=0, initial=0) > 0
    needs, number = np.unique(problem.needs[:, asked], axis=0, return_inverse=True)
    return np.ascontiguousarray(needs, np.int32), number.ravel()


def most_seats(problem: CoalitionProblem) -> int:
    """Return how many robots a coalition has at most, if none of them is to spare."""
    return int(min(len(problem.counts), problem.needs.sum(axis=1).max(initial=1)))


def empty_graph(problem: CoalitionProblem) -> Graph:
    """Return a graph without arcs.

    What takes no time takes a tick here, so that all that follows upon something starts later.
    """
    tasks, places, robots = len(problem.needs), problem.ways.shape[1], len(problem.counts)
    nodes = np.zeros(places + 1, NODE).view(np.recarray)
    nodes.key[tasks:places] = FIRST
    nodes.key[places:] = LAST
    nodes.due[:] = NEVER
    nodes.duration[:tasks] = np.maximum(problem.duration, 1)
    nodes.release[:tasks], nodes.due[:tasks] = problem.release, problem.due
    nodes.need[:tasks] = _different_needs(problem)[1]
    linked = (problem.before[:, 0] != NOBODY) | (problem.after[:, 0] != NOBODY)
    nodes.has_links[:tasks] = linked
    most = most_seats(problem)
    seats = np.zeros(tasks * most + 2 * robots, SEAT).view(np.recarray)
    seats.node[: tasks * most] = np.repeat(np.arange(tasks), most)
    seats.node[tasks * most : tasks * most + robots] = problem.origin
    seats.node[tasks * most + robots :] = places
    seats.kind[tasks * most :] = np.tile(problem.kind, 2)
    return Graph(nodes, seats, np.zeros(robots, np.int64), np.zeros(5, np.int64))


@kernel
def start_of(problem: ArcProblem, graph: Graph, task: int, first_seat: int) -> int:
    """Return when a task can start, by when those are free that come to it."""
    node = graph.nodes[task]
    there, comes_apart = 0, False
    first_site = problem.site[graph.seats[graph.seats[first_seat].prev].node]
    for seat in range(first_seat, first_seat + node.taken):
        place = graph.seats[graph.seats[seat].prev].node
        pace = problem.kinds[graph.seats[seat].kind].pace
        there = max(there, graph.nodes[place].end + problem.ways[pace, place, task])
        comes_apart |= problem.site[place] != first_site
    start = max(node.release, there + problem.forming[0] * comes_apart)
    if node.has_links:
        for other in problem.before[task]:
            if other == NOBODY:
                break
            start = max(start, graph.nodes[other].end)
    return start


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

    Forming on the way is not counted: who else comes from where may change.
    """
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
    home = len(graph.seats) - len(graph.back) + robot
    last = graph.seats[graph.seats[home].prev].node
    return graph.nodes[last].end + problem.home[graph.seats[home].kind, last]


@kernel
def cost_of(makespan: int, back_sum: int, late: int, robots: int) -> int:
    """Return what a plan costs, in ticks."""
    return makespan + back_sum // (SPREAD * robots) + LATENESS * late


@entry
def lay(problem: ArcProblem, graph: Graph, plan: CoalitionPlan, at: Array) -> None:
    """Lay a plan out as a graph, with all times; `at` is room for the last seat of each robot."""
    nodes, seats, tasks, robots = graph.nodes, graph.seats, len(problem.near), len(graph.back)
    most = problem.most[0]
    for robot in range(robots):
        at[robot] = tasks * most + robot
    for position in range(tasks):
        task = plan.order[position]
        nodes[task].taken = plan.size[task]
        for index in range(plan.size[task]):
            robot, seat = plan.coalition[task, index], task * most + index
            seats[seat].kind = problem.kind[robot]
            seats[seat].prev, seats[at[robot]].next = at[robot], seat
            at[robot] = seat
        start = start_of(problem, graph, task, task * most)
        nodes[task].end, nodes[task].key = start + nodes[task].duration, 2 * start + 1
    for robot in range(robots):
        home = tasks * most + robots + robot
        seats[home].prev, seats[at[robot]].next = at[robot], home
        graph.back[robot] = back_of(problem, graph, robot)
    for position in range(tasks - 1, -1, -1):
        task = plan.order[position]
        nodes[task].tail = tail_of(problem, graph, task, task * most)
    sum_up(graph)


@kernel
def sum_up(graph: Graph) -> None:
    """Work out the makespan and the cost of a graph whose times are known."""
    total, back, late = graph.total, graph.back, 0
    latest, back_sum = 0, 0
    for robot in range(len(back)):
        back_sum += back[robot]
        if back[robot] > back[latest]:
            latest = robot
    for node in range(len(graph.nodes)):
        late += max(0, graph.nodes[node].end - graph.nodes[node].due)
    total[LATEST], total[MAKESPAN], total[BACK_SUM], total[LATE] = (
        latest,
        back[latest],
        back_sum,
        late,
    )
    total[COST] = cost_of(back[latest], back_sum, late, len(back))


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
