"""OR-Tools' CP-SAT: a circuit for each robot, a start for each task."""

from __future__ import annotations

import time
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from teamformer.base.import_apart import import_apart
from teamformer.bench.peers.auction import auction
from teamformer.bench.peers.peer_plan import OutOfReachError, PeerPlan, makespan_of, plan_of
from teamformer.planning.problem.coalition_plan import CoalitionPlan, routes_of
from teamformer.planning.problem.coalition_problem import CoalitionProblem
from teamformer.planning.problem.schedule import MAKESPAN, schedule_of
from teamformer.planning.relaxation.cp_sat import make_solver

if TYPE_CHECKING:
    from ortools.sat.python import cp_model

MOST_ARCS = 400_000
"""Robots times pairs of tasks from which on the model is not built: it takes gigabytes."""


def solve_by_cp_sat(problem: CoalitionProblem, seconds: float) -> PeerPlan | None:
    """Return what one thread of CP-SAT makes of the plan of one fair auction, and its bound.

    The plan is the auction's where CP-SAT finds none that is better; `seconds` include the time to
    pose the model. None where the auction finds none.
    """
    arcs = len(problem.counts) * len(problem.needs) ** 2
    if arcs > MOST_ARCS:
        raise OutOfReachError(f"cp-sat is asked no missions with {arcs:,} arcs")
    begun = time.perf_counter()
    first = auction(problem, 0.0)
    return None if first is None else solve_from(problem, first.plan, begun + seconds)


def solve_from(problem: CoalitionProblem, plan: CoalitionPlan, deadline: float) -> PeerPlan:
    """Return the best of a plan and those that CP-SAT finds from it, with its bound.

    `deadline` is what `time.perf_counter` shows then.
    """
    circuits = _Circuits(problem, makespan_of(problem, plan))
    circuits.hint(plan)
    from ortools.sat.python import cp_model

    solver = make_solver(seed=0)
    solver.parameters.linearization_level = 2  # the bound comes from a linear relaxation
    solver.parameters.max_time_in_seconds = max(deadline - time.perf_counter(), 0.01)
    status = solver.solve(circuits.model)
    least = 0 if status == cp_model.INFEASIBLE else max(0, round(solver.best_objective_bound))
    plans = [plan]
    if status in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        plans.insert(0, circuits.plan_of(solver))
    return PeerPlan(min(plans, key=partial(makespan_of, problem)), least)


class _Circuits:
    """The model: which robot goes from where to where, and when tasks start."""

    def __init__(self, problem: CoalitionProblem, horizon: int) -> None:
        """Pose the model of plans that end by the horizon."""
        import_apart("ortools.sat.python.cp_model")
        from ortools.sat.python import cp_model

        self.problem, self.model = problem, cp_model.CpModel()
        tasks, robots = len(problem.needs), len(problem.counts)
        self.start = [
            self.model.new_int_var(int(problem.release[task]), horizon, f"start {task}")
            for task in range(tasks)
        ]
        self.end = [self._end(task, horizon) for task in range(tasks)]
        self.makespan = self.model.new_int_var(0, horizon, "makespan")
        self.does = [
            [self.model.new_bool_var(f"{robot} does {task}") for task in range(tasks)]
            for robot in range(robots)
        ]
        self.goes: list[dict[tuple[int, int], cp_model.IntVar]] = []  # by robot, from node to node
        for robot in range(robots):
            self._route(robot)
        self._cover()
        self.model.minimize(self.makespan)

    def _end(self, task: int, horizon: int) -> cp_model.LinearExprT:
        """Return when a task ends; for a load that is up to who carries it."""
        if not self.problem.slower[:, task].any():
            return self.start[task] + int(self.problem.duration[task])
        return self.model.new_int_var(0, horizon, f"end {task}")

    def _route(self, robot: int) -> None:
        """Let a robot go from its start through its tasks and home; node 0 is start and home."""
        problem, model = self.problem, self.model
        tasks, pace, kind = len(self.start), problem.pace[robot], problem.kind[robot]
        origin = int(problem.origin[robot])
        ready = int(problem.ready[origin - tasks])
        arcs: list[tuple[int, int, cp_model.LiteralT]] = []
        ways: dict[tuple[int, int], cp_model.IntVar] = {}
        busy: list[cp_model.LinearExprT] = []  # ticks of the ways and tasks that the robot takes
        self.goes.append(ways)
        idle = ways[0, 0] = model.new_bool_var("")
        arcs.append((0, 0, idle))
        model.add(self.makespan >= ready + int(problem.home[kind, origin])).only_enforce_if(idle)
        for task in range(tasks):
            does, end = self.does[robot][task], self.end[task]
            takes = int(problem.duration[task] + problem.slower[pace, task])
            if problem.slower[:, task].any():
                model.add(end >= self.start[task] + takes).only_enforce_if(does)
            arcs.append((task + 1, task + 1, ~does))
            first, last = model.new_bool_var(""), model.new_bool_var("")
            ways[0, task + 1], ways[task + 1, 0] = first, last
            arcs += [(0, task + 1, first), (task + 1, 0, last)]
            there = ready + int(problem.ways[pace, origin, task])
            model.add(self.start[task] >= there).only_enforce_if(
                does if self._is_straight(pace, origin, task) else first
            )
            model.add(self.makespan >= end + int(problem.home[kind, task])).only_enforce_if(last)
            busy += [
                int(problem.ways[pace, origin, task]) * first,
                takes * does,
                int(problem.home[kind, task]) * last,
            ]
            for other in range(tasks):
                if other != task:
                    goes = ways[task + 1, other + 1] = model.new_bool_var("")
                    arcs.append((task + 1, other + 1, goes))
                    way = int(problem.ways[pace, task, other])
                    model.add(self.start[other] >= end + way).only_enforce_if(goes)
                    busy.append(way * goes)
        model.add_circuit(arcs)
        model.add(self.makespan >= sum(busy))  # nothing new, but it raises the bound

    def _is_straight(self, pace: int, origin: int, task: int) -> bool:
        """Say whether no detour by another task is shorter."""
        ways = self.problem.ways[pace]
        detours = ways[origin] + self.problem.duration + ways[: len(self.start), task]
        return bool(ways[origin, task] <= detours.min())

    def _cover(self) -> None:
        for task, needs in enumerate(self.problem.needs):
            for cap in np.flatnonzero(needs):
                brought = [
                    int(self.problem.counts[robot, cap]) * does[task]
                    for robot, does in enumerate(self.does)
                ]
                self.model.add(sum(brought) >= int(needs[cap]))

    def hint(self, plan: CoalitionPlan) -> None:
        """Begin at a plan: who does what, when, and by which ways."""
        for task, coalition in enumerate(plan.coalition):
            for robot, does in enumerate(self.does):
                self.model.add_hint(does[task], robot in coalition[: plan.size[task]])
        schedule = schedule_of(self.problem, plan)
        for task, start in enumerate(self.start):
            self.model.add_hint(start, int(schedule.start[task]))
        self.model.add_hint(self.makespan, int(schedule.total[MAKESPAN]))
        for ways, tasks in zip(self.goes, routes_of(plan, len(self.goes)), strict=True):
            taken = set(pairwise((0, *(task + 1 for task in tasks), 0)))
            for way, goes in ways.items():
                self.model.add_hint(goes, way in taken)

    def plan_of(self, solver: cp_model.CpSolver) -> CoalitionPlan:
        """Return what the solver found as a plan; tasks in the order in which they start."""
        starts, ends = ([solver.value(at) for at in times] for times in (self.start, self.end))
        coalitions = [
            [robot for robot, does in enumerate(self.does) if solver.value(does[task])]
            for task in range(len(starts))
        ]
        return plan_of(self.problem, coalitions, np.lexsort((ends, starts)).tolist())
