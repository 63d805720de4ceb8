"""OR-Tools' routing solver: a task has a copy for each seat, and its copies start at one moment.

Its own insertions know nothing of copies that start at one moment: a search that begins with them
ends at ten times the makespan. So the first half of the time is spent on auctions, and the search
begins at the best plan of these.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np

from teamformer.bench.peers.auction import auction
from teamformer.bench.peers.peer_plan import OutOfReachError, PeerPlan, makespan_of, plan_of
from teamformer.planning.problem.coalition_plan import CoalitionPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem

MOST_COPIES = 3000
"""More copies than this take longer to pose than anybody waits."""

SPAN = 100
"""What a tick of the makespan counts, beside a tick until one robot is home."""

AUCTIONS = 0.5
"""The share of the time in which the plan is made that the search begins at."""

Copies = list[tuple[int, int]]
"""The seats of all tasks: the task, and the capability that whoever sits there brings."""


def route_copies(problem: CoalitionProblem, seconds: float) -> PeerPlan | None:
    """Return the best plan that guided local search makes of that of auctions; None if none is.

    It is never worse than the plan of the auctions.
    """
    begun = time.perf_counter()
    copies = [
        (task, int(cap))
        for task, needs in enumerate(problem.needs)
        for cap in np.flatnonzero(needs)
        for _ in range(int(needs[cap]))
    ]
    if len(copies) > MOST_COPIES:
        raise OutOfReachError(f"or-routing is asked no missions with {len(copies)} seats")
    first = auction(problem, AUCTIONS * seconds)
    if first is None:
        return None
    found = _search(problem, copies, first.plan, begun + seconds)
    if found is None or makespan_of(problem, found) > makespan_of(problem, first.plan):
        return first
    return PeerPlan(found)


def _search(
    problem: CoalitionProblem, copies: Copies, first: CoalitionPlan, deadline: float
) -> CoalitionPlan | None:
    """Return the best plan that is found until a moment; None if there is no time to search."""
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    robots = len(problem.origin)
    nodes = len(copies) + 2 * robots  # the copies, where robots start, where they end
    starts = list(range(len(copies), len(copies) + robots))
    ends = list(range(len(copies) + robots, nodes))
    manager = pywrapcp.RoutingIndexManager(nodes, robots, starts, ends)
    model = pywrapcp.RoutingModel(manager)
    of_kind: dict[int, int] = {}
    for kind, robot in zip(*np.unique(problem.kind, return_index=True), strict=True):
        matrix = _matrix(problem, copies, int(kind), int(problem.pace[robot]))
        of_kind[int(kind)] = model.RegisterTransitMatrix(matrix.tolist())
    transits = [of_kind[int(kind)] for kind in problem.kind]
    model.SetArcCostEvaluatorOfAllVehicles(model.RegisterTransitCallback(lambda one, other: 0))
    horizon = makespan_of(problem, first)
    model.AddDimensionWithVehicleTransits(transits, horizon, horizon, True, "time")
    clock = model.GetDimensionOrDie("time")
    clock.SetGlobalSpanCostCoefficient(SPAN)
    clock.SetSpanCostCoefficientForAllVehicles(1)
    index_of = [manager.NodeToIndex(node) for node in range(len(copies))]
    _let_start_together(model, clock, copies, index_of)
    _let_fill_seats(model, problem, copies, index_of)
    for robot in range(robots):
        model.AddVariableMinimizedByFinalizer(clock.CumulVar(model.End(robot)))
    settings = pywrapcp.DefaultRoutingSearchParameters()
    searches = routing_enums_pb2.LocalSearchMetaheuristic
    settings.local_search_metaheuristic = searches.GUIDED_LOCAL_SEARCH
    settings.time_limit.FromMilliseconds(1000)  # it warns of none; the true one is set below
    model.CloseModelWithParameters(settings)
    routes = _routes(problem, copies, first)
    start = model.ReadAssignmentFromRoutes(
        [[index_of[copy] for copy in route] for route in routes], True
    )
    left = deadline - time.perf_counter()
    if start is None or left <= 0:
        return None
    settings.time_limit.FromMilliseconds(max(1, round(1000 * left)))
    solution = model.SolveFromAssignmentWithParameters(start, settings)
    if solution is None:
        return None
    coalitions: list[set[int]] = [set() for _ in problem.needs]
    begins, place = np.zeros(len(coalitions), np.int64), np.zeros(len(coalitions), np.int64)
    for robot in range(robots):
        index, number = solution.Value(model.NextVar(model.Start(robot))), 0
        while not model.IsEnd(index):
            task, _ = copies[manager.IndexToNode(index)]
            coalitions[task].add(robot)
            begins[task] = solution.Min(clock.CumulVar(index))
            place[task] = max(place[task], number)
            index, number = solution.Value(model.NextVar(index)), number + 1
    order = np.lexsort((place, begins))
    return plan_of(problem, [sorted(who) for who in coalitions], order.tolist())


def _let_start_together(model: Any, clock: Any, copies: Copies, index_of: Sequence[int]) -> None:
    """Let all copies of a task start at one moment."""
    first: dict[int, Any] = {}
    for (task, _), index in zip(copies, index_of, strict=True):
        moment = clock.CumulVar(index)
        if task in first:
            model.solver().Add(moment == first[task])
        first.setdefault(task, moment)


def _let_fill_seats(
    model: Any, problem: CoalitionProblem, copies: Copies, index_of: Sequence[int]
) -> None:
    """Let a robot fill as many seats of a task as it has of what they ask for, and no more."""
    seats: dict[tuple[int, int], list[Any]] = {}
    for (task, cap), index in zip(copies, index_of, strict=True):
        able = np.flatnonzero(problem.counts[:, cap]).tolist()
        model.VehicleVar(index).SetValues(able)
        seats.setdefault((task, cap), []).append(model.VehicleVar(index))
    solver = model.solver()
    for (_, cap), who in seats.items():
        for robot in np.flatnonzero(problem.counts[:, cap] < len(who)).tolist():
            has = int(problem.counts[robot, cap])
            if has:
                solver.Add(solver.Sum([each == robot for each in who]) <= has)


def _routes(problem: CoalitionProblem, copies: Copies, plan: CoalitionPlan) -> list[list[int]]:
    """Return the copies that each robot is at in a plan, in its order."""
    of_task: dict[int, list[int]] = {}
    for copy, (task, _) in enumerate(copies):
        of_task.setdefault(task, []).append(copy)
    routes: list[list[int]] = [[] for _ in problem.origin]
    for task in plan.order:
        left = {robot: problem.counts[robot].copy() for robot in _coalition(plan, task)}
        for copy in of_task[task]:
            cap = copies[copy][1]
            robot = next(robot for robot, has in left.items() if has[cap])
            left[robot][cap] -= 1
            routes[robot].append(copy)
    return routes


def _coalition(plan: CoalitionPlan, task: int) -> list[int]:
    return [int(robot) for robot in plan.coalition[task, : plan.size[task]]]


def _matrix(
    problem: CoalitionProblem, copies: Copies, kind: int, pace: int
) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Return what robots of a kind take from node to node, the service at the first included.

    Between two copies of a task it is nothing: a robot that fills both seats is there once.
    """
    robots = len(problem.origin)
    tasks = np.array([task for task, _ in copies])
    count = len(tasks)
    ways, home, duration = problem.ways[pace], problem.home[kind], problem.duration
    matrix = np.zeros((count + 2 * robots,) * 2, np.int64)
    between = duration[tasks][:, None] + ways[tasks][:, tasks]
    between[tasks[:, None] == tasks[None, :]] = 0
    matrix[:count, :count] = between
    matrix[:count, count + robots :] = (duration[tasks] + home[tasks])[:, None]
    matrix[count : count + robots, :count] = ways[problem.origin][:, tasks]
    matrix[count : count + robots, count + robots :] = home[problem.origin][:, None]
    return matrix
