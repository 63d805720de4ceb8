"""PyVRP: hybrid genetic search for vehicle routing (Wouda and others 2024)."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from teamformer.base.extras import require
from teamformer.bench.peers.lone_robots import Routes, able_robots, horizon_of, lower_limits
from teamformer.bench.peers.peer_plan import PeerPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem


def plan_by_pyvrp(problem: CoalitionProblem, seconds: float) -> PeerPlan | None:
    """Return the best plan that PyVRP finds; raises if tasks need several robots."""
    require("peers", "pyvrp")
    import pyvrp
    from pyvrp.exceptions import PenaltyBoundWarning
    from pyvrp.stop import MaxRuntime

    can_do = able_robots(problem, "pyvrp")
    kinds, first = np.unique(problem.kind, return_index=True)
    origins, horizon = np.unique(problem.origin), horizon_of(problem)
    tasks = len(problem.needs)
    model = pyvrp.Model()
    depots = {int(place): model.add_depot(model.add_location(0, 0)) for place in origins}
    for task in range(tasks):
        model.add_client(model.add_location(0, 0), service_duration=int(problem.duration[task]))
    profiles = {int(kind): model.add_profile() for kind in kinds}
    groups = sorted({(int(k), int(o)) for k, o in zip(problem.kind, problem.origin, strict=True)})
    members = [np.flatnonzero((problem.kind == k) & (problem.origin == o)) for k, o in groups]
    for (kind, origin), robots in zip(groups, members, strict=True):
        depot = depots[origin]
        model.add_vehicle_type(len(robots), [], depot, depot, profile=profiles[kind])
    matrices: list[Any] = []  # (places, places) each
    for kind, robot in zip(kinds, first, strict=True):
        matrix = np.zeros((len(origins) + tasks,) * 2, np.int64)
        ways = problem.ways[problem.pace[robot]]
        matrix[: len(origins), len(origins) :] = ways[origins]
        matrix[len(origins) :, len(origins) :] = ways[:tasks]
        matrix[len(origins) :, : len(origins)] = problem.home[kind, :tasks][:, None]
        matrix[:, len(origins) :][:, ~can_do[robot]] = 4 * horizon  # within no limit
        np.fill_diagonal(matrix, 0)
        matrices.append(matrix)
    data = model.data().replace(distance_matrices=matrices, duration_matrices=matrices)

    def attempt(limit: int, time_limit: float) -> Routes | None:
        types = [each.replace(shift_duration=limit) for each in data.vehicle_types()]
        posed = data.replace(vehicle_types=types)
        with warnings.catch_warnings():  # a limit may be too low for any routes
            warnings.simplefilter("ignore", PenaltyBoundWarning)
            found = pyvrp.solve(
                posed, MaxRuntime(time_limit), seed=0, display=False, collect_stats=False
            )
        if not found.is_feasible():
            return None
        routes: Routes = [[] for _ in problem.origin]
        free = [list(robots) for robots in members]
        for route in found.best.routes():
            robot = free[route.vehicle_type()].pop(0)
            routes[robot] = _tasks_of(route)
        return routes

    return lower_limits(problem, can_do, seconds, attempt)


def _tasks_of(route: object) -> list[int]:
    return [activity.idx for activity in route if activity.is_client()]  # type: ignore[attr-defined]
