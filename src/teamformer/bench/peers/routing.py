"""OR-Tools' routing solver: a task has a copy for each seat, and its copies start at one moment."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from teamformer.bench.peers.peer_plan import OutOfReachError, PeerPlan, plan_of
from teamformer.planning.continuous.problem import CoalitionProblem

MOST_COPIES = 3000
"""More copies than this take longer to pose than anybody waits."""

SPAN = 100
"""What a tick of the makespan counts, beside a tick that a robot is on its way."""


def route_copies(problem: CoalitionProblem, seconds: float) -> PeerPlan | None:
    """Return the best plan found by insertion and guided local search; None if none was."""
    from ortools.constraint_solver import pywrapcp, routing_enums_pb2

    begun = time.perf_counter()
    copies = [
        (task, int(cap))
        for task, needs in enumerate(problem.needs)
        for cap in np.flatnonzero(needs)
        for _ in range(int(needs[cap]))
    ]
    if len(copies) > MOST_COPIES:
        raise OutOfReachError(f"or-routing is asked no missions with {len(copies)} seats")
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
    for robot, transit in enumerate(transits):
        model.SetArcCostEvaluatorOfVehicle(transit, robot)
    horizon = int(problem.duration.sum() + (len(problem.needs) + 2) * problem.ways.max())
    model.AddDimensionWithVehicleTransits(transits, horizon, horizon, True, "time")
    clock = model.GetDimensionOrDie("time")
    clock.SetGlobalSpanCostCoefficient(SPAN)
    first: dict[int, Any] = {}
    for node, (task, cap) in enumerate(copies):
        index = manager.NodeToIndex(node)
        able = np.flatnonzero(problem.counts[:, cap]).tolist()
        model.VehicleVar(index).SetValues(able)
        moment = clock.CumulVar(index)
        if task in first:
            model.solver().Add(moment == first[task])
        first.setdefault(task, moment)
    settings = pywrapcp.DefaultRoutingSearchParameters()
    strategies, searches = (
        routing_enums_pb2.FirstSolutionStrategy,
        routing_enums_pb2.LocalSearchMetaheuristic,
    )
    settings.first_solution_strategy = strategies.PARALLEL_CHEAPEST_INSERTION
    settings.local_search_metaheuristic = searches.GUIDED_LOCAL_SEARCH
    left = max(0.1, seconds - (time.perf_counter() - begun))
    settings.time_limit.FromMilliseconds(round(1000 * left))
    solution = model.SolveWithParameters(settings)
    if solution is None:
        return None
    coalitions: list[set[int]] = [set() for _ in problem.needs]
    start, place = np.zeros(len(coalitions), np.int64), np.zeros(len(coalitions), np.int64)
    for robot in range(robots):
        index, number = solution.Value(model.NextVar(model.Start(robot))), 0
        while not model.IsEnd(index):
            task, _ = copies[manager.IndexToNode(index)]
            coalitions[task].add(robot)
            start[task] = solution.Min(clock.CumulVar(index))
            place[task] = max(place[task], number)
            index, number = solution.Value(model.NextVar(index)), number + 1
    order = np.lexsort((place, start))
    return PeerPlan(plan_of(problem, [sorted(who) for who in coalitions], order.tolist()))


def _matrix(
    problem: CoalitionProblem, copies: list[tuple[int, int]], kind: int, pace: int
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
