"""A plan as a graph: every task has seats, and arcs lead from seat to seat.

Robots of a kind are alike, so a plan need not say who goes where: each seat of a task is taken by
some robot of a kind, which comes along one arc, from a depot or another task, and leaves along
another, to another task or home. Routes are read off at the end by following the arcs.

Start times are the order of the graph. A task's key is twice its start and one more; depots come
before all keys, homes after. Every arc leads from a lower to a higher key, so there is no circle.

Missions in continuous time and missions in steps differ in when a task starts and when those who
leave it are at their next one: `in_steps` has that for the latter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from teamformer.jit import entry, kernel
from teamformer.planning.arcs.covers import list_covers
from teamformer.planning.arcs.in_steps.meeting import TICKS, find_way, plan_ways, start_in_steps
from teamformer.planning.arcs.near import near_tasks
from teamformer.planning.continuous.problem import NEVER, NOBODY, CoalitionProblem, Ticks, Whole
from teamformer.planning.continuous.schedule import LATENESS, SPREAD, CoalitionPlan
from teamformer.planning.prices import SHARES, Prices
from teamformer.rules.constants import FAR

if TYPE_CHECKING:
    from teamformer.rules.arrays import Array

Records = np.recarray[Any, np.dtype[np.void]]

KIND = np.dtype([("pace", np.int32), ("type", np.int32), ("lost", np.int64)])
NODE = np.dtype(
    [
        ("end", np.int64),  # when the task ends; 0 for depots
        ("key", np.int64),
        ("tail", np.int64),  # the longest chain of work and ways from its start to the end of all
        ("duration", np.int64),
        ("release", np.int64),
        ("first", np.int32),  # of its seats
        ("taken", np.int32),  # how many of its seats are
        ("need", np.int32),  # which of the different needs
        ("is_waiting", np.int32),  # whether it is on the agenda: 0, or what is to be worked out
        ("has_links", np.int32),  # whether it comes before or after other tasks
        ("due", np.int64),
        ("price", np.int64),  # of each tick until its end
        ("late_price", np.int64),  # of each tick that it is late
    ],
    align=True,
)
SEAT = np.dtype([("prev", np.int32), ("next", np.int32), ("node", np.int32), ("kind", np.int32)])
WAY = np.dtype([("to", np.int64), ("key", np.int64), ("pace", np.int64), ("comes", np.int64)])

FIRST, LAST = -1, NEVER
"""The keys of depots and homes."""

FEWEST_NEAR, MOST_NEAR, NEAR_SHARE = 14, 28, 7
"""How many tasks are near to each: every seventh within these limits."""

MAKESPAN, COST, BACK_SUM, LATE, LATEST, END_SUM = range(6)
"""What is known of a graph as a whole; LATEST is the home that is reached last."""

SWAP, REPLACE, RIDE, ANYWHERE, IN_PLACE, BUNDLE, SMOOTH, SLACK, STRETCH = range(9)
"""Habits of a search: how many percent of the changes are swaps, replacements, riders; of the moves
how many are to any moment, in place, or try a bundle; how many percent the mean end of tasks weighs
in steps; by how many ticks chains may be longer than allowed."""

CONTINUOUS = (40, 0, 0, 5, 0, 0, 0, 0, 0)
"""The habits in continuous time."""


class ArcProblem(NamedTuple):
    """What does not change: the places, the kinds of robots, who covers what."""

    ways: Ticks  # (paces, places, tasks)
    ways_to: Ticks  # (paces, tasks, places) the same, so that all ways to a task lie together
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
    habits: Whole  # (9,)
    passed: Whole  # (ways + 1,) of in steps: where the tasks of each way begin in `passes`
    passes: Whole  # tasks that take time and lie on a way, from the place on
    together: Whole  # (paces, paces) the pace of those who go together
    weights: Ticks  # (4,) in steps: of makespan and ends, the divisor, and if there are prices


class Graph(NamedTuple):
    """A plan with its times. Seats are those of the tasks, then depots, then homes."""

    nodes: Records  # (places + 1,) NODE: tasks, depots by place, and one for all homes
    seats: Records  # (tasks * most + 2 * robots,) SEAT
    back: Ticks  # (robots,) when each home is reached
    total: Ticks  # (6,)
    comes: Ticks  # (seats,) in steps: when who leaves a seat is at the next; empty in other time
    order: Whole  # (tasks,) in steps: the tasks by their keys, when all was timed
    ways: Records  # (seats of a node,) WAY, room for the ways that lead from a node
    there: Ticks  # (seats of a node,) room for the steps in which groups are there


def near_of(tasks: int) -> int:
    """Return how many tasks are near to each of so many."""
    return min(tasks - 1, max(FEWEST_NEAR, min(MOST_NEAR, tasks // NEAR_SHARE)))


class StepRules(NamedTuple):
    """What a mission in steps has beside its coalition problem; robots of a team are in a row."""

    ready: Ticks  # (places - tasks,) when the robots at each depot are free
    lost: Ticks  # (robots,) the step in which each is lost, if that is known; alike in a kind
    together: Whole  # (paces, paces) the pace of those who go together
    prices: Prices  # if more than the makespan counts
    near: int  # how many tasks are near to each
    riders: int  # how many robots more than it needs come to a task at most
    habits: tuple[int, ...]
    passed: Whole  # (ways + 1,) as in ArcProblem
    passes: Whole


def pose_arcs(problem: CoalitionProblem, near: int, steps: StepRules | None = None) -> ArcProblem:
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
    kinds.lost = NEVER if steps is None else steps.lost[first]
    needs, _ = _different_needs(problem)
    number = np.bincount(kind_type.ravel()[problem.kind], minlength=len(counts)).astype(np.int32)
    useful, covers, listed = list_covers(counts, number, needs)
    return ArcProblem(
        ways=problem.ways,
        ways_to=np.ascontiguousarray(problem.ways.transpose(0, 2, 1)),
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
        most=np.array([most_seats(problem, steps)]),
        habits=np.array(CONTINUOUS if steps is None else steps.habits, np.int32),
        passed=np.zeros(1, np.int32) if steps is None else steps.passed,
        passes=np.zeros(0, np.int32) if steps is None else steps.passes,
        together=np.zeros((0, 0), np.int32) if steps is None else steps.together,
        weights=_weights(len(problem.needs), steps),
    )


def _weights(tasks: int, steps: StepRules | None) -> Ticks:
    """Return the weights of makespan and ends in what a plan in steps costs, and the divisor.

    Without prices the ends of tasks count a little, so that plans of one makespan differ.
    """
    if steps is None:
        return np.array([1, 0, 1, 0])
    if len(steps.prices.due) > 0:
        return np.array([steps.prices.whole[0], 1, SHARES * tasks, 1])
    return np.array([100 * tasks, steps.habits[SMOOTH], 100 * tasks, 0])


def _mixed(problem: CoalitionProblem) -> Whole:
    """Return the first robots of all kinds, then the second ones, and so on."""
    columns = problem.like.T.ravel()
    return columns[columns != NOBODY]


def _different_needs(problem: CoalitionProblem) -> tuple[Whole, npt.NDArray[np.intp]]:
    """Return the different needs, and which of them each task has."""
    asked = problem.needs.max(axis=0, initial=0) > 0
    needs, number = np.unique(problem.needs[:, asked], axis=0, return_inverse=True)
    return np.ascontiguousarray(needs, np.int32), number.ravel()


def most_seats(problem: CoalitionProblem, steps: StepRules | None = None) -> int:
    """Return how many robots come to a task at most: none to spare, and riders in steps."""
    riders = 0 if steps is None else steps.riders
    return int(min(len(problem.counts), problem.needs.sum(axis=1).max(initial=1) + riders))


def empty_graph(problem: CoalitionProblem, steps: StepRules | None = None) -> Graph:
    """Return a graph without arcs.

    In continuous time what takes no time takes a tick, so that all that follows starts later.
    """
    tasks, places, robots = len(problem.needs), problem.ways.shape[1], len(problem.counts)
    nodes = np.zeros(places + 1, NODE).view(np.recarray)
    nodes.key[tasks:places] = FIRST
    nodes.key[places:] = LAST
    nodes.due[:] = NEVER
    nodes.duration[:tasks] = np.maximum(problem.duration, 1 if steps is None else 0)
    nodes.release[:tasks], nodes.due[:tasks] = problem.release, problem.due
    nodes.price[:tasks] = nodes.late_price[:tasks] = 1
    if steps is not None and len(steps.prices.due) > 0:
        nodes.due[:tasks] = np.minimum(steps.prices.due, FAR) * TICKS
        nodes.price[:tasks], nodes.late_price[:tasks] = steps.prices.ends, steps.prices.late
    nodes.need[:tasks] = _different_needs(problem)[1]
    linked = (problem.before[:, 0] != NOBODY) | (problem.after[:, 0] != NOBODY)
    nodes.has_links[:tasks] = linked
    most = most_seats(problem, steps)
    nodes.first[:tasks] = np.arange(tasks) * most
    if steps is not None:
        nodes.end[tasks:places] = steps.ready
        nodes.taken[tasks:places] = np.bincount(problem.origin - tasks)
        nodes.first[tasks:places] = tasks * most + np.searchsorted(
            problem.origin, np.arange(tasks, places)
        )
    seats = np.zeros(tasks * most + 2 * robots, SEAT).view(np.recarray)
    seats.node[: tasks * most] = np.repeat(np.arange(tasks), most)
    seats.node[tasks * most : tasks * most + robots] = problem.origin
    seats.node[tasks * most + robots :] = places
    seats.kind[tasks * most :] = np.tile(problem.kind, 2)
    widest = max(most, int(nodes.taken.max(initial=0))) + 1
    return Graph(
        nodes,
        seats,
        back=np.zeros(robots, np.int64),
        total=np.zeros(6, np.int64),
        comes=np.zeros(0 if steps is None else len(seats), np.int64),
        order=np.arange(tasks, dtype=np.int32),
        ways=np.zeros(widest, WAY).view(np.recarray),
        there=np.zeros(widest, np.int64),
    )


@kernel
def is_in_steps(graph: Graph) -> bool:
    """Say whether a graph is of a mission in steps."""
    return len(graph.comes) > 0


@kernel
def start_of(problem: ArcProblem, graph: Graph, task: int, first_seat: int) -> int:
    """Return when a task can start, by when those are free that come to it."""
    if is_in_steps(graph):
        return start_in_steps(problem, graph, task, first_seat)
    node = graph.nodes[task]
    there, comes_apart = 0, False
    first_site = problem.site[graph.seats[graph.seats[first_seat].prev].node]
    for seat in range(first_seat, first_seat + node.taken):
        place = graph.seats[graph.seats[seat].prev].node
        pace = problem.kinds[graph.seats[seat].kind].pace
        there = max(there, graph.nodes[place].end + problem.ways_to[pace, task, place])
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
def cost_of(
    problem: ArcProblem, graph: Graph, makespan: int, back_sum: int, end_sum: int, late: int
) -> int:
    """Return what a plan costs, in ticks: late robots or, in steps, late tasks add to it."""
    if is_in_steps(graph):
        weights = problem.weights
        return (weights[0] * makespan + weights[1] * end_sum + late) // weights[2]
    return makespan + back_sum // (SPREAD * len(graph.back)) + LATENESS * late


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
    for task in order:
        start = start_of(problem, graph, task, nodes[task].first)
        nodes[task].end, nodes[task].key = start + nodes[task].duration, 2 * start + 1
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
            way = find_way(graph, graph.seats[graph.seats[seat].next].node, count)
            graph.comes[seat] = graph.ways[way].comes


@kernel
def sum_up(problem: ArcProblem, graph: Graph) -> None:
    """Work out the makespan and the cost of a graph whose times are known."""
    total, back, late, end_sum = graph.total, graph.back, 0, 0
    latest, back_sum = 0, 0
    for robot in range(len(back)):
        back_sum += back[robot]
        if back[robot] > back[latest]:
            latest = robot
    for task in range(len(problem.near)):
        node = graph.nodes[task]
        late += node.late_price * max(0, node.end - node.due)
        end_sum += node.price * node.end
    total[LATEST], total[MAKESPAN] = latest, back[latest]
    total[BACK_SUM], total[END_SUM], total[LATE] = back_sum, end_sum, late
    total[COST] = cost_of(problem, graph, back[latest], back_sum, end_sum, late)


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
