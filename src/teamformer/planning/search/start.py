"""A first plan: again and again the task that can start first, by the coalition that waits least.

Before, covers are chosen so that the work of all types is balanced: what the types that have most
to do wait costs extra. Plans are made for several such prices, and the best is taken.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from teamformer.base.array_types import Int32s, Ints
from teamformer.base.kernels.jit import entry, kernel
from teamformer.planning.dispatch.first_plan import draw_plan
from teamformer.planning.graph.arc_problem import ArcProblem, Records, takes_with
from teamformer.planning.graph.graph import Graph
from teamformer.planning.problem.coalition_plan import CoalitionPlan, empty_plan
from teamformer.planning.problem.coalition_problem import NEVER, NOBODY, CoalitionProblem
from teamformer.planning.problem.rotas import fits_all, walked

PRICES = (0, 100, 200, 350, 500, 800)
"""What a tick that a robot waits costs if its type has most to do, in thousandths of a tick."""

MANY_TASKS, FEW_PRICES = 300, 2
"""With more tasks than this so few prices are tried: a dispatch takes long then."""

BALANCINGS = 10
"""How often each task's cover is chosen anew."""

MEAN_LOAD = 1000
"""What the load of a type is if all are loaded alike."""

WAITER = np.dtype([("comes", np.int64), ("slower", np.int64), ("robot", np.int64)])


class Dispatch(NamedTuple):
    """Where robots are, who comes to each open task first, and how scarce types are."""

    place: Int32s  # (robots,)
    free: Ints  # (robots,)
    of_type: Int32s  # (types, robots) the robots of each type, then NOBODY
    first: Records  # (tasks, types, most) WAITER, those that would come first
    is_open: Int32s  # (tasks,)
    ends: Ints  # (tasks,)
    value: Ints  # (tasks,) what its best cover costs
    cover: Int32s  # (tasks,) which that is
    load: Ints  # (types,)


def empty_dispatch(problem: CoalitionProblem, arcs: ArcProblem) -> Dispatch:
    """Return room for a dispatch."""
    tasks, robots, types = len(problem.needs), len(problem.counts), len(arcs.counts)
    which = arcs.kinds.type[problem.kind]
    of_type = np.full((types, np.bincount(which).max() + 1), NOBODY, np.int32)
    for kind in range(types):
        alike = np.flatnonzero(which == kind)
        of_type[kind, : len(alike)] = alike
    most = int(arcs.useful.max(initial=1))
    return Dispatch(
        place=np.zeros(robots, np.int32),
        free=np.zeros(robots, np.int64),
        of_type=of_type,
        first=np.zeros((tasks, types, most), WAITER).view(np.recarray),
        is_open=np.zeros(tasks, np.int32),
        ends=np.zeros(tasks, np.int64),
        value=np.zeros(tasks, np.int64),
        cover=np.zeros(tasks, np.int32),
        load=np.zeros(types, np.int64),
    )


@entry
def balance(problem: ArcProblem, graph: Graph, room: Dispatch, rounds: int) -> None:
    """Choose covers so that the loads of types are as even as can be; leave them in `room.load`."""
    tasks, total, way = len(problem.near), 0, 0
    if tasks > 1:
        for task in range(tasks):
            way += problem.ways[0, task, problem.near[task, problem.near.shape[1] // 2]]
        way //= tasks
    for task in range(tasks):
        total += graph.nodes[task].duration + way
    scale = max(1, total // tasks)
    for task in range(tasks):
        room.cover[task] = 0
        work = (graph.nodes[task].duration + way) * MEAN_LOAD // scale
        _load(problem, graph, room, task, work)
    for _ in range(rounds):
        for task in range(tasks):
            work = (graph.nodes[task].duration + way) * MEAN_LOAD // scale
            _load(problem, graph, room, task, -work)
            best, least = 0, 0
            for cover in range(problem.listed[graph.nodes[task].need]):
                value = _strain(problem, graph, room, task, cover, work)
                if cover == 0 or value < least:
                    best, least = cover, value
            room.cover[task] = best
            _load(problem, graph, room, task, work)
    for which in range(len(room.load)):
        room.load[which] //= max(1, _number(room, which))


@kernel
def _number(room: Dispatch, which: int) -> int:
    number = 0
    while room.of_type[which, number] != NOBODY:
        number += 1
    return number


@kernel
def _load(problem: ArcProblem, graph: Graph, room: Dispatch, task: int, work: int) -> None:
    """Load the types of a task's cover with its work."""
    need, cover = graph.nodes[task].need, room.cover[task]
    for part in range(problem.covers.shape[2]):
        which = problem.covers[need, cover, part, 0]
        if which == NOBODY:
            break
        room.load[which] += work * problem.covers[need, cover, part, 1]


@kernel
def _strain(
    problem: ArcProblem, graph: Graph, room: Dispatch, task: int, cover: int, work: int
) -> int:
    """Return by how much a cover adds to the fourth powers of loads."""
    need, strain = graph.nodes[task].need, 0
    for part in range(problem.covers.shape[2]):
        which = problem.covers[need, cover, part, 0]
        if which == NOBODY:
            break
        number = _number(room, which)
        before = room.load[which] // number
        after = (room.load[which] + work * problem.covers[need, cover, part, 1]) // number
        before, after = min(before, 30000), min(after, 30000)
        strain += after * after * after * after - before * before * before * before
    return strain


@entry
def dispatch(
    problem: ArcProblem, graph: Graph, room: Dispatch, price: int, plan: CoalitionPlan
) -> int:
    """Write a plan; return when all are home."""
    tasks, robots = len(problem.near), len(room.place)
    highest = 1
    for which in range(len(room.load)):
        highest = max(highest, room.load[which])
    for robot in range(robots):
        room.place[robot] = problem.origin[robot]
        room.free[robot] = graph.nodes[problem.origin[robot]].end
    for task in range(tasks):
        room.is_open[task] = 1
        for which in range(len(room.load)):
            _look(problem, graph, room, task, which)
        _evaluate(problem, graph, room, task, price, highest)
    for position in range(tasks):
        best = NOBODY
        for task in range(tasks):
            is_better = best == NOBODY or room.value[task] < room.value[best]
            if room.is_open[task] and is_better and _is_ready(problem, room, task):
                best = task
        _do(problem, graph, room, best, position, plan)
        _look_again(problem, graph, room, best, price, highest, plan)
    makespan = 0
    for robot in range(robots):
        home = problem.home[problem.kind[robot], room.place[robot]]
        back = walked(problem.rotas, problem.kind[robot], room.free[robot], home)
        makespan = max(makespan, back)
    return makespan


@kernel
def _is_ready(problem: ArcProblem, room: Dispatch, task: int) -> bool:
    """Say whether all that comes before a task is done."""
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if room.is_open[other]:
            return False
    return True


@kernel
def _look(problem: ArcProblem, graph: Graph, room: Dispatch, task: int, which: int) -> None:
    """Work out which robots of a type would come to a task first, or have its load there."""
    keeps, found, first = problem.useful[graph.nodes[task].need, which], 0, room.first[task, which]
    if keeps == 0:
        return
    for robot in room.of_type[which]:
        if robot == NOBODY:
            break
        pace = problem.kinds[problem.kind[robot]].pace
        comes = _comes(problem, room, robot, task)
        slower = takes_with(problem, pace, task) - graph.nodes[task].duration
        if found == keeps and _score(first[found - 1]) <= comes + slower:
            continue
        if found < keeps:
            found += 1
        index = found - 1
        while index > 0 and _score(first[index - 1]) > comes + slower:
            first[index].comes, first[index].robot = first[index - 1].comes, first[index - 1].robot
            first[index].slower = first[index - 1].slower
            index -= 1
        first[index].comes, first[index].slower, first[index].robot = comes, slower, robot


@kernel
def _comes(problem: ArcProblem, room: Dispatch, robot: int, task: int) -> int:
    """Return when a robot would come to a task."""
    kind = problem.kind[robot]
    way = problem.ways_to[problem.kinds[kind].pace, task, room.place[robot]]
    return walked(problem.rotas, kind, room.free[robot], way)


@kernel
def _score(waiter: Records) -> int:
    """Return when a robot comes, and what a load takes longer with it."""
    return waiter.comes + waiter.slower


@kernel
def _evaluate(
    problem: ArcProblem, graph: Graph, room: Dispatch, task: int, price: int, highest: int
) -> None:
    """Find a task's best cover."""
    first, covers = room.first[task], problem.covers[graph.nodes[task].need]
    room.value[task] = NEVER
    released = graph.nodes[task].release
    for other in problem.before[task]:
        if other == NOBODY:
            break
        if not room.is_open[other]:
            released = max(released, room.ends[other])
    for cover in range(problem.listed[graph.nodes[task].need]):
        start, slower = released, 0
        for part in range(problem.covers.shape[2]):
            which, count = covers[cover, part, 0], covers[cover, part, 1]
            if which == NOBODY:
                break
            for index in range(count):
                start = max(start, first[which, index].comes)
                slower = max(slower, first[which, index].slower)
            if start + slower >= room.value[task]:
                break
        if start + slower >= room.value[task]:
            continue
        value = start + slower
        for part in range(problem.covers.shape[2]):
            which, count = covers[cover, part, 0], covers[cover, part, 1]
            if which == NOBODY:
                break
            for index in range(count):
                waits = (start - first[which, index].comes) * price // 1000
                value += waits * room.load[which] // highest
        if value < room.value[task]:
            room.value[task], room.cover[task] = value, cover


@kernel
def _do(
    problem: ArcProblem,
    graph: Graph,
    room: Dispatch,
    task: int,
    position: int,
    plan: CoalitionPlan,
) -> None:
    """Have a task done next by its best cover."""
    need, cover, first = graph.nodes[task].need, room.cover[task], room.first[task]
    size, start, there, comes_apart = 0, graph.nodes[task].release, 0, False
    slower = 0
    for other in problem.before[task]:
        if other == NOBODY:
            break
        start = max(start, room.ends[other])
    for part in range(problem.covers.shape[2]):
        which = problem.covers[need, cover, part, 0]
        if which == NOBODY:
            break
        for index in range(problem.covers[need, cover, part, 1]):
            robot = first[which, index].robot
            plan.coalition[task, size] = robot
            first_place = room.place[plan.coalition[task, 0]]
            comes_apart |= problem.site[room.place[robot]] != problem.site[first_place]
            there = max(there, first[which, index].comes)
            slower = max(slower, first[which, index].slower)
            size += 1
    takes = graph.nodes[task].duration + slower
    start = max(start, there + problem.forming[0] * comes_apart)
    start = fits_all(problem.rotas, problem.kind, plan.coalition[task], size, start, takes)
    end = start + takes
    for seat in range(size):
        robot = plan.coalition[task, seat]
        room.place[robot], room.free[robot] = task, end
    plan.order[position], plan.size[task] = task, size
    room.ends[task], room.is_open[task] = end, 0


@kernel
def _look_again(
    problem: ArcProblem,
    graph: Graph,
    room: Dispatch,
    done: int,
    price: int,
    highest: int,
    plan: CoalitionPlan,
) -> None:
    """Look anew at open tasks to which robots that did one would have come first, or would now."""
    for task in range(len(room.is_open)):
        if not room.is_open[task]:
            continue
        is_changed = bool(graph.nodes[done].has_links)
        for seat in range(plan.size[done]):
            robot = plan.coalition[done, seat]
            if _is_first(problem, graph, room, task, robot):
                _look(problem, graph, room, task, problem.kinds[problem.kind[robot]].type)
                is_changed = True
        if is_changed:
            _evaluate(problem, graph, room, task, price, highest)


@kernel
def _is_first(problem: ArcProblem, graph: Graph, room: Dispatch, task: int, robot: int) -> bool:
    """Say whether a robot is, or should be, among those of its type that come to a task first."""
    which = problem.kinds[problem.kind[robot]].type
    keeps = problem.useful[graph.nodes[task].need, which]
    first = room.first[task, which]
    for index in range(keeps):
        if first[index].robot == robot:
            return True
    pace = problem.kinds[problem.kind[robot]].pace
    comes = _comes(problem, room, robot, task)
    slower = takes_with(problem, pace, task) - graph.nodes[task].duration
    return keeps > 0 and comes + slower < _score(first[keeps - 1])


def first_plan(problem: CoalitionProblem, arcs: ArcProblem, graph: Graph) -> CoalitionPlan:
    """Return the best plan of a dispatch at several prices.

    Where covers are not listed, tasks are planned in a random order, each by who is there first.
    """
    if not arcs.listed.all():
        drawn = draw_plan(problem, 0)
        assert drawn is not None, "the caller has seen that every task has an able coalition"
        return drawn
    tasks = len(problem.needs)
    graph.nodes.duration[:tasks] = arcs.ways_to[:, :, -1].min(axis=0)  # of the fastest coalitions
    room, plan, best = empty_dispatch(problem, arcs), empty_plan(problem), empty_plan(problem)
    balance(arcs, graph, room, BALANCINGS)
    least = NEVER
    for price in PRICES if tasks <= MANY_TASKS else PRICES[:FEW_PRICES]:
        makespan = dispatch(arcs, graph, room, price, plan)
        if makespan < least:
            plan, best, least = best, plan, makespan
    return best
