"""VROOM: fast local search for vehicle routing, by its bindings pyvroom."""

from __future__ import annotations

from datetime import timedelta

import numpy as np

from teamformer.base.extras import require
from teamformer.bench.peers.lone_robots import Routes, able_robots, lower_limits
from teamformer.bench.peers.peer_plan import PeerPlan
from teamformer.planning.problem.coalition_problem import CoalitionProblem

EXPLORATION = 5
"""How thoroughly it searches: the most that it offers."""

THREADS = 1


def plan_by_vroom(problem: CoalitionProblem, seconds: float) -> PeerPlan | None:
    """Return the best plan that VROOM finds; raises if tasks need several robots."""
    require("peers", "vroom")
    import vroom

    can_do = able_robots(problem, "vroom")
    kinds, first = np.unique(problem.kind, return_index=True)
    tasks, places = len(problem.needs), problem.ways.shape[1]
    matrices = {}
    for kind, robot in zip(kinds, first, strict=True):
        matrix = np.zeros((places, places), np.int64)
        matrix[:, :tasks] = problem.ways[problem.pace[robot]]
        matrix[:, tasks:] = problem.home[kind][:, None]
        np.fill_diagonal(matrix, 0)
        matrices[int(kind)] = np.minimum(matrix, 2**31).astype(np.uint32)

    def attempt(limit: int, time_limit: float) -> Routes | None:
        posed = vroom.Input()
        for kind, matrix in matrices.items():
            posed.set_durations_matrix(str(kind), matrix)
        for robot, origin in enumerate(problem.origin):
            kind, at = int(problem.kind[robot]), int(origin)
            skills = set(np.flatnonzero(can_do[robot]).tolist())
            window = vroom.TimeWindow(0, min(limit, 2**32 - 2))
            posed.add_vehicle(
                vroom.Vehicle(robot, at, at, str(kind), skills=skills, time_window=window)
            )
        for task in range(tasks):
            service = int(problem.duration[task])
            posed.add_job(vroom.Job(task, task, default_service=service, skills={task}))
        found = posed.solve(EXPLORATION, THREADS, timedelta(seconds=time_limit)).to_dict()
        if found["unassigned"]:
            return None
        routes: Routes = [[] for _ in problem.origin]
        for route in found["routes"]:
            steps = (step for step in route["steps"] if step["type"] == "job")
            routes[route["vehicle"]] = [step["id"] for step in steps]
        return routes

    return lower_limits(problem, can_do, seconds, attempt)
